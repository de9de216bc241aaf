"""Record a structure's settled motion, and measure it."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from squealpipe.codes import Regime
from squealpipe.schema import Outcome
from squealpipe.structures.assess.designs import Design
from squealpipe.structures.motion_system import regime_codes
from squealpipe.structures.squeal.plant import Plant
from squealpipe.structures.squeal.windows import Running, run
from squealpipe.vibration import levels as measured
from squealpipe.vibration.levels import Measurement, Record
from squealpipe.vibration.settled_runs import SettledRun


@np.errstate(over="ignore", invalid="ignore")  # what grows without bound overflows
def levels(
    design: Design, settled: SettledRun, *, how: Running
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return scalars of a settled motion, and its spectrum, path and values by contact.

    Args:
        settled: a run of the design, in the coordinates of its run.
    """
    plant = design.plant
    assert plant is not None  # noqa: S101 (without sliding nothing has settled)
    return measured.levels(
        partial(_record, plant, how=how),
        settled,
        begin=(settled.last.final, settled.last.regimes),
        period=1.0 / plant.slowest,
        loads=plant.pressed,
        sliding_forces=plant.sliding_forces,
    )


def _record(
    plant: Plant, begin: tuple[np.ndarray, np.ndarray], *, how: Running
) -> Record:
    """Run a motion on for 400 periods, or as many as can be held.

    Args:
        begin: state, and regime of each component.
    """
    traced = plant.system.traced
    # of the fastest mode: fewer would miss its peaks
    samples_per_period = 6.0
    fine = max(
        Measurement.fine,
        int(np.ceil(samples_per_period * plant.fastest / plant.slowest)),
    )
    held = len(plant.sliding) + len(plant.system.regimes) + len(traced.kinds)
    most_samples = 2**16
    # doubles, 270 MB
    most_numbers = 2**25
    most = min(most_samples, most_numbers // held)
    count = int(min(Measurement.periods * fine, most))
    step = 1.0 / (plant.slowest * fine)
    times = step * np.arange(1, count + 1)
    state, first = begin
    raw = run(
        plant,
        state[None],
        times,
        how,
        regime=first[None],
        sums=True,
        log_events=Measurement.most_events,
    )
    row = {name: value[0] for name, value in raw.items()}
    owners = np.asarray(traced.component_of)
    kinds = list(traced.kinds)
    samples = row["samples"]
    forces = plant.normal_forces(samples)
    codes = regime_codes(plant.system, plant.contacts, plant.belt)
    now = codes[np.maximum(row["sample_regimes"], 0)]
    logged = int(min(row["n_events"], Measurement.most_events))

    def spent(regime: Regime) -> np.ndarray:
        """Time that has added up in a regime, (samples, contacts)."""
        chosen = codes == regime
        return np.stack(
            [
                row["sample_durations"][:, chosen & (owners == index)].sum(axis=1)
                for index in range(len(plant.contacts))
            ],
            axis=1,
        )

    landing = [kinds.index(f"{name}_contact") for name in plant.contacts]
    return Record(
        times=times,
        states=samples,
        displacements=plant.contact_motions(samples[:, : plant.size]),
        velocities=plant.contact_motions(samples[:, plant.size : 2 * plant.size]),
        forces=np.where(now == Regime.separated, 0.0, forces) / plant.pressed,
        regimes=now,
        open_time=spent(Regime.separated),
        stick_time=spent(Regime.stick),
        landings=row["sample_counts"][:, landing],
        peak_forces=row["extremes"][:, 1],
        impact_speed=_impact_speed(plant, row, landing, logged),
        event_times=row["event_times"][:logged],
        event_kinds=row["event_kinds"][:logged],
        end=(row["final"], row["sample_regimes"][-1]),
        duration=float(row["reached"]),
        finished=row["outcome"] == Outcome.converged,
    )


def _impact_speed(
    plant: Plant, row: dict[str, np.ndarray], landing: list[int], logged: int
) -> float:
    """Return the largest speed towards the belt at a return, m/s; NaN without any."""
    kinds = row["event_kinds"][:logged]
    velocities = row["event_states"][:logged, plant.size : 2 * plant.size]
    speeds = [
        -(velocities[kinds == kind] @ plant.structure.normals[:, index])
        for index, kind in enumerate(landing)
    ]
    every = np.abs(np.concatenate(speeds)) if speeds else np.zeros(0)
    return float(every.max()) if every.size else np.nan
