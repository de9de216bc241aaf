"""Ladder of methods: the answer of each on a structure's squeal, its error and its cost."""

from __future__ import annotations  # help shows Angle, not its checks

import platform
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.benchmark.schema import Reliability, Role
from squealpipe.schema import build
from squealpipe.schema.origin import recorded
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.modes import free_degrees
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.reduction import reduce
from squealpipe.structures.schema.squeal_ladder import (
    NO_MODE,
    PushAnswer,
    squeal_ladder_schema,
)
from squealpipe.structures.schema.squealing import SquealLimits
from squealpipe.structures.squeal.ends import PushEnd
from squealpipe.structures.squeal.methods import (
    Horizon,
    Told,
    complex_modes_told,
    distinct,
    exact_told,
    smoothed_told,
)
from squealpipe.structures.squeal.plant import Plant
from squealpipe.structures.squeal.settling import RunLengths, horizon
from squealpipe.structures.squeal.squealing_modes import nearest
from squealpipe.systems.datasets.outcomes import Outcome
from squealpipe.systems.progress import alone
from squealpipe.validation import Natural, NotNegative, Positive, Tolerance

WIDTHS = (
    (1.0, 0.0),
    (0.3, 0.0),
    (0.1, 0.0),
    (0.01, 0.0),
    (0.3, 0.3),
    (0.1, 0.1),
    (0.03, 0.03),
)
"""Widths of smoothing: of friction over the belt's speed, and of contact over the preload."""


@recorded(
    model="structure with exact contact and friction, or both smoothed",
    method="complex modes; Taylor series with located events; LSODA",
)
def squeal_ladder(
    structure: Any,
    *,
    n_modes: tuple[Natural, ...] = (6, 8, 12, 20, 32),
    n_complex: tuple[Natural, ...] = (6, 8, 12, 20, 40),
    widths: tuple[tuple[Positive, NotNegative], ...] = WIDTHS,
    pushes: Natural = 2,
    t_end: Positive | None = None,
    frequency_max: Positive | None = None,
    tol: Tolerance = 1e-12,
    smoothed_tol: Tolerance = 1e-7,
    repeats: Natural = 3,
) -> xr.Dataset:
    """Ask several methods which unstable modes squeal; judge them by the finest run, with cost.

    A start of 1 % is pushed along each of the fastest unstable modes. Complex modes say that
    each of them rings; runs with exact events, and runs of scipy's LSODA with friction smoothed or
    friction and contact smoothed, say what rings in the end. The finest is the run with exact
    events in most modes, and the smoothed runs have as many. Its own error is told by starts that
    differ a little, and by the run in the next smaller number of modes.

    Args:
        structure: a :class:`squealpipe.Structure` that is not reduced yet, or is small.
        n_modes: of the runs with exact events; those that the structure cannot have are left out.
        n_complex: of complex modes of the reduced structure, beside those of the whole.
        widths: pairs of the sliding speed over which friction is smoothed, over the belt's, and of
            the force over which loss of contact is, over the preload; 0 keeps the corner.
        pushes: unstable modes, the fastest first.
        t_end: time that is run, s; by default the time in which the last of them to grow does so
            from 1e-4, and 200 periods of the unstable mode of lowest frequency. Two windows at its
            end, of a third of it at most, are compared.
        frequency_max: unstable modes up to there count, Hz; needed beyond 1000 degrees of freedom.
        tol: of the Taylor integrator.
        smoothed_tol: of LSODA.
        repeats: of what takes less than 4 s, for the median of its CPU time.

    Returns:
        Dataset ``squeal_ladder``: over ``run`` method, setting, verdict, errors and cost; over
        ``mode`` the pushes, with what each method says becomes of them.

    Raises:
        ValueError: there is no steady sliding; no contact; no number of modes that fits.
    """
    sprung = [each.name for each in structure.contacts if each.tangential_stiffness]
    if sprung:
        raise ValueError(
            f"contact {sprung[0]}: tangential_stiffness: runs with smoothed friction, with which "
            "exact ones are compared, have no tangential springs; leave it out, or see "
            "squealing_modes for what runs with exact events say"
        )
    sizes = _sizes(structure, n_modes)
    plants = [_plant(structure, size, frequency_max) for size in sizes]
    finest = plants[-1]
    places = finest.unstable[:pushes]
    if not places.size:  # nothing grows: a push along the mode that decays slowest
        places = np.array([int(finest.spectrum.values.real.argmax())])
    frequencies = finest.frequencies[places]
    span = _horizon(finest, places, t_end)
    whole = structure.size
    fewest = max(len(structure.contacts), 2)
    with alone() as show:
        told = [
            complex_modes_told(structure, number, frequencies, frequency_max, repeats)
            for number in [*distinct(n_complex, fewest, whole - 1), None]
        ]
        asked = len(told) + len(plants) + len(widths)
        for plant in plants:
            show(len(told) / asked)
            told.append(exact_told(plant, frequencies, span, tol, repeats))
        reference = len(told) - 1
        for pair in widths:
            show(len(told) / asked)
            told.append(smoothed_told(finest, frequencies, span, pair, smoothed_tol))
    return _dataset(finest, places, told, reference, span)


def _sizes(structure: ContactStructure, n_modes: Sequence[int]) -> list[int]:
    fewest, free = max(len(structure.contacts), 2), free_degrees(structure)
    sizes = distinct(n_modes, fewest, min(free, SquealLimits.most_modes))
    if free <= SquealLimits.most_modes:
        sizes = distinct([*sizes, free], 1, free)
    if not sizes:
        raise ValueError(
            f"n_modes = {tuple(n_modes)!r}: from {fewest}, as many as the contacts and two at "
            f"least, to {min(free, SquealLimits.most_modes)} are needed"
        )
    return sizes


def _plant(
    structure: ContactStructure, size: int, frequency_max: float | None
) -> Plant:
    if size == structure.size:
        return Plant(structure)
    limit = None if structure.size <= DENSE else frequency_max
    return Plant(reduce(structure, n_modes=size, frequency_max=limit))


def _horizon(plant: Plant, places: np.ndarray, t_end: float | None) -> Horizon:
    """Return the length of the runs: until the slowest push has grown, and
    twice the first window.
    """
    if t_end is not None:
        horizon(plant, t_end)  # says what is too short
        window = min(
            RunLengths.first_window / plant.slowest, t_end / RunLengths.fewest_periods
        )
        return Horizon(t_end - 2.0 * window, window)
    rates = plant.spectrum.values.real[places]
    growing, first, most = horizon(plant, None)
    if plant.unstable.size:
        growing = min(growing, max(float(np.log(1e4) / rates.min()), first))
    return Horizon(growing, min(first, 0.25 * most))


def _judged(plant: Plant, end: PushEnd, truth: PushEnd) -> PushAnswer:
    """Judge one method's answer to one push against that of the finest run."""
    if truth.outcome != Outcome.converged:
        return PushAnswer.not_known
    if not end.has_mode:
        return PushAnswer.right if truth.quiet else PushAnswer.no_such_mode
    if end.outcome != Outcome.converged:
        return PushAnswer.not_settled
    if end.quiet or truth.quiet:
        if end.quiet == truth.quiet:
            return PushAnswer.right
        return PushAnswer.quiet_instead if end.quiet else PushAnswer.rings_instead
    same = nearest(plant, end.frequency) == nearest(plant, truth.frequency)
    return PushAnswer.right if same else PushAnswer.other_mode


def _verdict(answers: list[PushAnswer]) -> Reliability:
    if PushAnswer.not_known in answers:
        return Reliability.not_applicable
    if all(answer is PushAnswer.right for answer in answers):
        return Reliability.right
    if all(answer in (PushAnswer.right, PushAnswer.not_settled) for answer in answers):
        return Reliability.flagged
    return Reliability.silently_wrong


def _errors(end: PushEnd, truth: PushEnd) -> tuple[float, float, float]:
    """Return the errors of frequency, speed and shares of time without contact; NaN: not said."""
    if end.quiet and truth.quiet:
        return 0.0, 0.0, 0.0
    if not end.has_mode or end.quiet or truth.quiet:
        says = bool(np.isfinite(end.speed))
        share = np.nan
        if says:
            share = float(np.abs(end.separated - truth.separated).max())
        return 1.0, 1.0 if says else np.nan, share
    return (
        abs(end.frequency / truth.frequency - 1.0),
        abs(end.speed / truth.speed - 1.0),
        float(np.abs(end.separated - truth.separated).max()),
    )


def _uncertainties(
    told: list[Told], errors: np.ndarray, verdicts: list[Reliability], reference: int
) -> np.ndarray:
    """Return the finest run's uncertainty: its scatter, or its change from the next smaller
    reduction.
    """
    scatter = np.array([end.scatter for end in told[reference].ends]).max(axis=0)
    before = reference - 1
    if told[before].method != told[reference].method or (
        verdicts[before] is not Reliability.right
    ):
        return np.asarray(scatter)
    return np.asarray(np.fmax(scatter, errors[before]))


def _dataset(
    finest: Plant, places: np.ndarray, told: list[Told], reference: int, span: Horizon
) -> xr.Dataset:
    truth = told[reference].ends
    pairs = [list(zip(each.ends, truth, strict=True)) for each in told]
    answers = [[_judged(finest, *pair) for pair in row] for row in pairs]
    verdicts = [_verdict(row) for row in answers]
    errors = np.array([np.max([_errors(*p) for p in row], axis=0) for row in pairs])
    names = ("frequency", "velocity", "separation")
    uncertainty = _uncertainties(told, errors, verdicts, reference)

    def ends(name: str) -> np.ndarray:
        return np.array([[getattr(end, name) for end in each.ends] for each in told])

    def rings_near(end: PushEnd) -> int:
        if not np.isfinite(end.frequency):
            return NO_MODE
        return int(finest.numbers[nearest(finest, end.frequency)])

    roles = [each.role for each in told]
    roles[reference] = Role.our_setting
    return build(
        squeal_ladder_schema,
        {
            "method": [each.method for each in told],
            "setting": [each.setting for each in told],
            "role": roles,
            "n_modes": [each.n_modes for each in told],
            "friction_width": [each.widths[0] for each in told],
            "contact_width": [each.widths[1] for each in told],
            "answer": answers,
            "verdict": verdicts,
            "rings_near": [[rings_near(end) for end in each.ends] for each in told],
            "frequency": ends("frequency"),
            "velocity_rms": ends("speed"),
            "separated_fraction": ends("separated"),
            "stick_fraction": ends("stuck"),
            "creep": ends("creep"),
            "peak_force": ends("force"),
            **{f"{name}_error": errors[:, i] for i, name in enumerate(names)},
            **{f"{name}_uncertainty": uncertainty[i] for i, name in enumerate(names)},
            "cpu_time": [each.cpu_time for each in told],
            "compile_time": [each.compile_time for each in told],
            "evaluations": [each.evaluations for each in told],
            "t_end": span.end,
            "outcome": ends("outcome"),
        },
        {
            "run": np.arange(len(told)),
            "mode": finest.numbers[places],
            "contact": finest.contacts,
        },
        {"platform": platform.platform()},
    )
