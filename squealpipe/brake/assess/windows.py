"""Windows of runs of many designs at once, and the statistics of each."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from squealpipe.brake.a1.ensemble import (
    LARGEST_CONTACT_FORCE,
    LARGEST_REACH,
    Ensemble,
    run_ensemble,
)
from squealpipe.brake.assess.fading import dies_out
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.laws.tables import is_table
from squealpipe.parameters import TABLE
from squealpipe.schema import Outcome
from squealpipe.vibration.settling import Settling, late_growth, tapered
from squealpipe.vibration.windows import Windows, joined


def run_windows(
    designs: Sequence[Design],
    starts: np.ndarray,
    lengths: np.ndarray,
    rules: Settling,
    *,
    tol: float,
) -> Windows:
    """Run each design from its start for its length of time.

    Args:
        starts: (runs, 4), m and m/s.
        lengths: (runs,), s.
        rules: which say what has to be seen of a window.
    """
    parts = []
    for rows in _alike(designs):
        alike = [designs[row] for row in rows]
        run = _ensemble(alike, starts[rows], lengths[rows], rules, tol)
        parts.append((rows, _statistics(run, alike, lengths[rows], rules)))
    return joined(parts)


def _alike(designs: Sequence[Design]) -> list[np.ndarray]:
    """Rows that one ensemble can hold: those with the same laws."""
    groups: dict[Any, list[int]] = {}
    for row, design in enumerate(designs):
        params = design.params
        # a table of contact is rescaled by the preload
        preload = params.preload if is_table(params.contact_law) else None
        key = (params.friction_law, params.contact_law, preload)
        groups.setdefault(key, []).append(row)
    return [np.array(rows) for rows in groups.values()]


def _ensemble(
    designs: Sequence[Design],
    starts: np.ndarray,
    lengths: np.ndarray,
    rules: Settling,
    tol: float,
) -> Ensemble:
    params = [design.params for design in designs]
    # every number that enters A1 may differ from run to run; laws and the belt's sense may not
    names = tuple(
        name
        for name, row in TABLE.items()
        if row.enters_a1 and row.allowed != "law" and name != "mu_static"
    )
    numbers: dict[str, Any] = {
        name: np.array([getattr(each, name) for each in params]) for name in names
    }
    numbers["mu_static"] = np.array([each.static_mu for each in params])
    for name in ("friction_law", "contact_law"):
        numbers[name] = getattr(params[0], name)
    return run_ensemble(
        numbers,
        np.array([design.alpha1 for design in designs]),
        np.array([design.alpha2 for design in designs]),
        t_end=lengths,
        times=lengths[:, None] * np.linspace(0.0, 1.0, rules.samples + 1)[1:],
        initial_state=starts,
        tol=tol,
        tracked=(LARGEST_CONTACT_FORCE, LARGEST_REACH),
        sums=rules.follows_perturbation,
        tangent=rules.follows_perturbation,
        workers=1,
    )


def _statistics(
    run: Ensemble, designs: Sequence[Design], lengths: np.ndarray, rules: Settling
) -> Windows:
    # a run that ends early has no states from there on
    known = np.isfinite(run.samples[..., 2:])
    square = np.where(known, run.samples[..., 2:], 0.0) ** 2
    mean = square.sum(axis=1) / np.maximum(known.sum(axis=1), 1)
    separated, stuck = run.separated_time / lengths, run.stick_time / lengths
    growth = late = np.full(lengths.size, np.nan)
    finished = run.outcome == Outcome.converged
    if rules.follows_perturbation:
        mean[finished] = tapered(np.moveaxis(square[finished], 1, 0))
        separated, stuck = (
            np.where(finished, _tapered_share(spent, lengths), share)
            for spent, share in (
                (run.sample_separated_time, separated),
                (run.sample_stick_time, stuck),
            )
        )
        growth, late = run.log_growth, late_growth(run.sample_log_growth.T)
    switched = run.separations + run.sticks + run.reversals + run.contacts > 0
    slides = finished & ~switched & (not rules.follows_perturbation)
    fades = np.zeros(lengths.size, bool)
    for row in np.flatnonzero(slides).tolist():
        sliding = Sliding.of(designs[row])
        if sliding is not None:
            fades[row] = dies_out(sliding, run.samples[row], float(lengths[row]))
    return Windows(
        final=run.final_state,
        regimes=np.zeros((lengths.size, 1), int),
        velocities=np.sqrt(mean),
        largest_velocity=np.sqrt(square.sum(axis=-1).max(axis=1)),
        separated=separated[:, None],
        stuck=stuck[:, None],
        separations=run.separations[:, None],
        forces=run.peak_contact_force[:, None],
        switched=switched,
        finished=finished,
        length=lengths,
        growth=growth,
        late_growth=late,
        fades=fades,
    )


def _tapered_share(spent: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Tapered share of the time by what has added up at the samples (runs, samples), s."""
    steps = np.diff(spent, axis=1, prepend=0.0) / (lengths[:, None] / spent.shape[1])
    return tapered(steps.T)
