"""Motions that a push along a mode ends in, read off the last windows of its runs."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.schema import Outcome
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.squeal.plant import PUSH_OF_A_MODE, Plant
from squealpipe.structures.squeal.smoothed import Samples
from squealpipe.structures.squeal.windows import Running, StructureWindows, run
from squealpipe.vibration.settling import (
    Agreement,
    WindowLevels,
    agreement,
    settling_of_verdicts,
)
from squealpipe.vibration.spectrum import strongest_line


@dataclass(frozen=True)
class EndSearch:
    """Samples and frequencies by which methods' motions are compared."""

    same_mode: float = 0.1
    """Distance of frequencies within which a mode of another reduction is the same one's."""
    samples_per_fast_period: float = 12.0
    """Samples in a period of the fastest mode."""
    most_samples: int = 2**16
    """Most samples in each window."""


@dataclass(frozen=True, kw_only=True)
class PushEnd:
    """Motion that a push ends in, by one method.

    Attributes:
        frequency: of the strongest line, Hz; NaN where nothing rings.
        speed: rms of all contacts, m/s; NaN where a method does not say.
        separated, stuck, creep, force: of each contact, as in the schema; NaN likewise.
        quiet: whether it has died out.
        has_mode: whether the method has a mode near the one that was asked for.
        scatter: largest differences among starts of relative frequency, relative speed and shares
            without contact; NaN of one start.
    """

    outcome: Outcome
    frequency: float = np.nan
    speed: float = np.nan
    separated: np.ndarray
    stuck: np.ndarray
    creep: np.ndarray
    force: np.ndarray
    quiet: bool = False
    has_mode: bool = True
    scatter: tuple[float, float, float] = (np.nan, np.nan, np.nan)


def nothing(structure: ContactStructure) -> dict[str, Any]:
    """Shares, creep and force of each contact where nothing is said."""
    names = ("separated", "stuck", "creep", "force")
    return {name: np.full(len(structure.contacts), np.nan) for name in names}


def without_mode(structure: ContactStructure) -> PushEnd:
    """Return the answer of a method that has no mode near the one that was asked for."""
    return PushEnd(outcome=Outcome.converged, has_mode=False, **nothing(structure))


def _died_out(plant: Plant, before: float, now: float) -> bool:
    """Compare the velocities of all modes in two windows."""
    # a motion that does not grow, and has half the velocity of the push, has died out
    return now < 0.5 * PUSH_OF_A_MODE * np.sqrt(plant.energy) and now <= before


def _agree(before: WindowLevels, now: WindowLevels) -> bool:
    return agreement(before, now, settling_of_verdicts) is not Agreement.none


def exact_ends(
    plant: Plant,
    before: StructureWindows,
    now: StructureWindows,
    count: int,
    tol: float,
) -> list[PushEnd]:
    """Return the end of each push, over the starts that belong to it; the frequency from a run
    behind.
    """
    step = 1.0 / (EndSearch.samples_per_fast_period * plant.fastest)
    length = int(min(np.ceil(float(now.length[0]) / step), EndSearch.most_samples))
    times = step * np.arange(1, length + 1)
    how = Running(tol, workers=1)
    raw = run(plant, now.final, times, how, regime=now.regimes)
    lines = [
        strongest_line(plant.modal_velocities(each).T, step) for each in raw["samples"]
    ]
    ends = []
    for first in range(0, len(lines), count):
        mine = slice(first, first + count)
        rows, earlier = now.row(mine), before.row(mine)
        finished = rows.finished.all() and earlier.finished.all()
        calm = [
            _died_out(plant, float(a), float(b)) and events == 0
            for a, b, events in zip(earlier.total, rows.total, rows.events, strict=True)
        ]
        steady = all(
            _agree(earlier.row(place).levels(1.0), rows.row(place).levels(1.0))
            for place in range(count)
        )
        speeds = np.sqrt((rows.speed**2).mean(axis=1))
        ringing = np.array(lines[mine])
        scatter = (
            float(np.ptp(ringing) / ringing.mean()),
            float(np.ptp(speeds) / speeds.mean()),
            float(np.ptp(rows.separated, axis=0).max()),
        )
        quiet = all(calm)
        # starts that end apart have not settled to one motion
        together = quiet or (scatter[0] < EndSearch.same_mode and not any(calm))
        outcome = Outcome.no_convergence
        if finished:
            outcome = Outcome.unresolved
            if (quiet or steady) and together:
                outcome = Outcome.converged
        ends.append(
            PushEnd(
                outcome=outcome,
                frequency=np.nan if quiet else float(ringing.mean()),
                speed=0.0 if quiet else float(np.sqrt((speeds**2).mean())),
                separated=rows.separated.mean(axis=0),
                stuck=rows.stuck.mean(axis=0),
                creep=np.where(rows.stuck.any(axis=0), 0.0, np.nan),
                force=rows.forces.max(axis=0) / plant.pressed,
                quiet=quiet,
                scatter=(0.0, 0.0, 0.0) if quiet else scatter,
            )
        )
    return ends


def smoothed_end(
    plant: Plant, samples: Samples, width: float, belt: np.ndarray, step: float
) -> PushEnd:
    """Return the end of one push without events, from the samples of its run.

    Args:
        width: sliding speed below which the contact counts as stuck, m/s.
        belt: speeds of the belt at the contacts, m/s.
        step: between samples, s.
    """
    if not samples.finished:
        return PushEnd(outcome=Outcome.no_convergence, **nothing(plant.structure))
    modal = plant.modal_velocities(samples.states)
    closed = samples.pressing > 0
    slow = closed & (np.abs(samples.sliding) < width)
    half = len(modal) // 2
    before, now = (
        WindowLevels(
            np.sqrt((modal[part] ** 2).mean(axis=0)),
            1.0 - closed[part].mean(axis=0),
            slow[part].mean(axis=0),
            samples.forces[part].max(axis=0),
        )
        for part in (slice(half), slice(half, None))
    )
    late = slice(half, None)
    quiet = _died_out(plant, before.total, now.total)
    speed = plant.contact_speeds(samples.states[late])
    count = slow[late].sum(axis=0)
    crept = (np.abs(samples.sliding[late]) * slow[late]).sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        creep = np.where(count > 0, crept / count / belt, np.nan)
    settled = quiet or _agree(before, now)
    return PushEnd(
        outcome=Outcome.converged if settled else Outcome.unresolved,
        frequency=np.nan if quiet else strongest_line(modal[late].T, step),
        speed=0.0 if quiet else float(np.sqrt((speed**2).mean())),
        separated=now.separated,
        stuck=now.stuck,
        creep=creep,
        force=samples.forces[late].max(axis=0) / plant.pressed,
        quiet=quiet,
    )
