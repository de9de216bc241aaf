"""The answer for one structure: verdict, cause, frequency, level, and what stops it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.schema import Outcome, blank, build
from squealpipe.schema.origin import recorded
from squealpipe.structures.assess.cures import cures_of
from squealpipe.structures.assess.designs import Design, Structures, pushed, start_at
from squealpipe.structures.assess.records import levels
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.quiet_intervals import linear_intervals
from squealpipe.structures.schema.squealing import GIVE_DAMPING
from squealpipe.structures.squeal.plant import Plant
from squealpipe.structures.squeal.refined_levels import refined_levels
from squealpipe.structures.squeal.windows import Running
from squealpipe.systems.processes import available_cores
from squealpipe.systems.progress import (
    partial_answer,
    stage,
    stop_is_asked,
    with_progress,
)
from squealpipe.validation import Natural, Seed, Tolerance, Workers
from squealpipe.vibration import judgement
from squealpipe.vibration.boundaries import Cure, QuietInterval, Search
from squealpipe.vibration.cures import (
    Boundary,
    by_change,
    cure_table,
    of_any_start,
    of_pushes,
)
from squealpipe.vibration.levels import Measurement
from squealpipe.vibration.schema import LINES, assess_schema
from squealpipe.vibration.settled_runs import SettledRun
from squealpipe.vibration.settling import settling_of_numbers


@dataclass(frozen=True)
class LongRuns:
    """Size from which the runs of a structure are long, and what is left out then."""

    work: int = 256
    """Coordinates times contacts from which runs are long: a step takes about as many operations,
    on any machine. Twice as many: a disc brake merged to 12 contacts is searched for an hour."""
    cures: int = 3
    """Cures whose verdict from other starts than a push is found by runs. Twice as many: twice the
    time, 17 s of CPU each of the disc brake with 20 contacts."""
    motions: int = 1
    """Motions of the present design that are tried at each value of these cures. Twice as many: a
    second motion that outlasts the first is seen, at up to twice the cost."""

    @classmethod
    def has(cls, structure: ContactStructure) -> bool:
        """Tell whether the runs of a structure are long, in the coordinates in which it is run."""
        return structure.size * len(structure.contacts) >= cls.work


@dataclass(frozen=True)
class JudgedStructure:
    """Verdict on a structure and its motions, before the search for what stops it.

    Attributes:
        verdict: what the push ends in.
        motions: states of the whole structure in other motions that last.
        facts: variables of the dataset that are known already.
        family: how designs of it are run in the search.
        modifications: as they were named.
    """

    design: Design
    verdict: Verdict
    motions: list[np.ndarray]
    facts: dict[str, Any]
    family: Structures
    modifications: Mapping[str, Any]

    def without_cures(self) -> xr.Dataset:
        """Return the answer so far: verdict, cause, frequency and level."""
        return self._answer({}, {})

    def with_cures(self) -> xr.Dataset:
        """Return the whole answer; the search takes most of its time, and tells each cure."""
        cures, units = cures_of(self.design, self.modifications)
        quiet, is_long = (
            self.verdict is Verdict.quiet,
            LongRuns.has(self.design.structure),
        )
        with stage("eigenvalues over what may stop it"):
            linear = {
                name: _linear_intervals(cures[name], self.design.band)
                for name in with_progress([*cures])
            }
        found = of_pushes(cures, linear, self.family, quiet=quiet)
        partial_answer(partial(_after_a_push, found))
        chosen = [*by_change(found)][: LongRuns.cures if is_long else None]
        with stage("runs of what may stop it"):
            for name in with_progress(chosen):
                if stop_is_asked():
                    break
                found |= of_any_start(
                    {name: found[name]},
                    self.family,
                    self.motions[: LongRuns.motions if is_long else None],
                    quiet=quiet,
                    always=quiet and not self.motions,
                    closely=not is_long,
                )
                partial_answer(partial(_in_short, name, found[name]))
        return self._answer(by_change(found), units)

    def _answer(
        self, found: Mapping[str, Boundary], units: Mapping[str, str]
    ) -> xr.Dataset:
        plant = self.design.plant
        assert plant is not None  # noqa: S101 (without sliding there is no verdict)
        # velocities at a contact are along the belt, and away from it
        directions = ("along", "across")
        return build(
            assess_schema,
            {**self.facts, **cure_table(found, units)},
            {
                "cure": np.array(list(found), str),
                "mode": np.arange(1, len(plant.frequencies) + 1),
                "contact": plant.contacts,
                "direction": list(directions),
            },
        )


def _in_short(name: str, boundary: Boundary) -> str:
    """Return a line that says at which value one cure changes the verdict, if any."""
    safe = boundary.quiet_from_any_start
    nearest = boundary.quiet_from if math.isnan(safe) else safe
    if math.isnan(nearest):
        return f"  {name} (now {boundary.cure.value:.4g}): no change of the verdict"
    return f"  {name} (now {boundary.cure.value:.4g}): changes the verdict at {nearest:.4g}"


def _after_a_push(found: Mapping[str, Boundary]) -> str:
    """Return a line on the smallest changes after which a push dies out, or no longer does."""
    told = [
        f"{name} {boundary.quiet_from:.4g} (now {boundary.cure.value:.4g})"
        for name, boundary in by_change(found).items()
        if not math.isnan(boundary.quiet_from)
    ]
    if not told:
        return "  after a push: no single change alters the verdict"
    return (
        f"  after a push the verdict changes at {', '.join(told)}; other starts follow"
    )


def _linear_intervals(cure: Cure, band: float) -> list[QuietInterval]:
    return linear_intervals(
        lambda value: cure.apply(value).structure, cure.grid.tolist(), cure.value, band
    )


@recorded(
    model="structure with exact contact and friction",
    method="Taylor series with located events",
)
def assess_structure(
    structure: Any,
    *,
    modifications: Mapping[str, Any] | None = None,
    samples: Natural = 16,
    seed: Seed = 0,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Return the answer for a structure; see :func:`squealpipe.assess`."""
    return judge_structure(
        structure,
        modifications=modifications,
        samples=samples,
        seed=seed,
        tol=tol,
        workers=workers,
    ).with_cures()


def judge_structure(
    structure: ContactStructure,
    *,
    modifications: Mapping[str, Any] | None = None,
    samples: int,
    seed: int,
    tol: float,
    workers: int | None = None,
) -> JudgedStructure:
    """Run a push, the sudden start and random starts of a structure until they have settled.

    Raises:
        NoSlidingError: there is no steady sliding.
        ValueError: no contact, too large, or a modification that cannot be read.
    """
    design = Design.of(structure)
    plant = design.plant
    assert plant is not None  # noqa: S101 (Design.of has raised)
    if design.obstacle:
        raise ValueError(f"the structure cannot be run: {design.obstacle}")
    named = dict(modifications or {})
    cures_of(design, named)  # mistakes are told before the runs
    is_long = LongRuns.has(design.structure)
    if is_long and workers is None:
        workers = available_cores()  # of two long runs each has its own
    family = Structures(tol, samples, seed, workers)
    if plant.is_undamped and plant.unstable.size:
        partial_answer(lambda: GIVE_DAMPING)
    push = pushed(design)
    sudden = start_at(design, plant.with_stretches(np.zeros(2 * plant.size)))
    assert push is not None and sudden is not None  # noqa: S101, PT018
    with stage(f"a push and a sudden start in {plant.size} modes"):
        of_push, of_sudden = family.settled(
            [push, sudden], settling_of_numbers, is_told=is_long
        )
    if of_push.lasts and is_long:
        family = replace(family, samples=0)  # the verdict is known without them
    drawn = family.starts(design, 2, [])
    partial_answer(partial(_first_verdicts, of_push, of_sudden, len(drawn)))
    others = family.settled(drawn) if drawn else []
    judged = judgement.judge(
        of_push,
        of_sudden,
        others,
        partial(levels, design, how=Running(tol, seed, workers)),
    )
    facts = {
        **judged.facts,
        **_of_small_motions(design, plant),
        "random_starts": len(others),
        "random_starts_noisy": sum(run.lasts for run in others),
    }
    if not is_long:  # in more modes a run takes eight times as long or more
        facts |= _in_more_modes(design, plant, of_push, Running(tol, seed, workers))
    motions = [design.to_whole(run.last.final) for run in judged.lasting[:2]]
    searched = replace(family, tol=max(tol, Search.tol))
    return JudgedStructure(design, judged.verdict, motions, facts, searched, named)


def _in_more_modes(
    design: Design, plant: Plant, push: SettledRun, how: Running
) -> dict[str, Any]:
    """Return the level of what a push ends in, where it is run on in more modes."""
    reduction, modes = design.reduction, design.structure.modes
    if reduction is None or design.coordinates is None or modes is None:
        return {}
    with stage("the level in more modes"):
        refined = refined_levels(
            plant,
            [push],
            None,
            how,
            reduction=reduction,
            modes=design.coordinates @ modes,
        )
    return {
        "refined_n_modes": refined.n_modes,
        "refined_velocity_rms": float(refined.speeds[0]),
        "refined_verdict": int(refined.verdicts[0]),
    }


def _first_verdicts(push: SettledRun, sudden: SettledRun, drawn: int) -> str:
    """Return a line that tells both verdicts before the random starts, which take longest."""
    return (
        f"  after a push: {push.verdict.words}; from rest under the whole load: "
        f"{sudden.verdict.words}"
    ) + (f"; {drawn} random starts follow" if drawn else "")


def _of_small_motions(design: Design, plant: Plant) -> dict[str, Any]:
    """Return the variables of the dataset that need no run."""
    growth = plant.spectrum.values.real
    return {
        "mechanism": design.mechanism,
        "sliding_growth_rate": float(growth.max()),
        "mode_frequency": plant.frequencies,
        "leading_frequency": float(plant.frequencies[growth.argmax()]),
        "contact_sliding_force": plant.sliding_forces,
        "degrees_of_freedom": design.given.size,
        "is_undamped": plant.is_undamped,
        "n_modes": plant.size,
    }


@recorded(model="small motions of a structure", method="complex eigenvalues")
def small_motions_alone(structure: Any) -> xr.Dataset:
    """Return the answer for a structure that is too large to be run: undetermined, with a cause."""
    design = Design.of(structure)
    plant = design.plant
    assert plant is not None  # noqa: S101 (Design.of has raised)
    instants = Measurement.shown_instants
    sizes = {"sample": instants, "harmonic": Measurement.harmonics, "line": LINES}
    facts = {
        **blank(assess_schema, **sizes),
        **_of_small_motions(design, plant),
        **dict.fromkeys(("verdict", "sudden_verdict"), Verdict.undetermined),
        "path_regime": np.full(instants, -1),
        "random_starts": 0,
        "random_starts_noisy": 0,
        "outcome": Outcome.unresolved,
    }
    family = Structures(Search.tol, 0, 0)
    judged = JudgedStructure(design, Verdict.undetermined, [], facts, family, {})
    return judged.without_cures()
