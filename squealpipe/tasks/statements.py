"""The paper's statements as constraints on the parameters, each with a margin.

A margin is positive where the statement holds and dimensionless. Motions are those of A1 from
rest; horizons are the scenes' ``t_end`` in units of √(m/k1).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from squealpipe.laws.springs import Stiffness, geometry, linear_stiffness, stiffness_determinant
from squealpipe.models.a4 import spectrum
from squealpipe.parameters import SCENES, Parameters, Scene
from squealpipe.schema import Outcome
from squealpipe.tasks.ensemble import Ensemble, run_ensemble

SAMPLING = 0.25
"""Spacing of the states from which peaks of y are found, in units of √(m/k1)."""
GROWTH = 1.5
"""F3: the last quarter of the horizon must exceed the first quarter by this factor."""
STEADINESS = 1.5
"""F4: the last quarter must stay below the first quarter times this factor."""
SPREAD = 0.1
"""F2e: how far the lowest contact forces of the first three scenes may differ."""
JUMPS = 3
"""F5b: how many separations count as "again and again"."""


@dataclass(frozen=True)
class Candidates:
    """Parameter sets, one an entry of each array, and the motions computed for them.

    Attributes:
        fields: names of ``Parameters`` → 1-D arrays of one length.
        tol: tolerance of the integrator.
        workers: processes, as in ``run_ensemble``.
    """

    fields: Mapping[str, np.ndarray]
    tol: float
    workers: int | None = None

    @property
    def size(self) -> int:
        """Number of candidates."""
        return len(self.fields["mass"])

    @cached_property
    def time_unit(self) -> np.ndarray:
        """√(m/k1), s."""
        return np.asarray(np.sqrt(self.fields["mass"] / self.fields["k1"]))

    def run(self, scene: Scene, t_end: float, **options: Any) -> Ensemble:
        """A1 at a scene until ``t_end`` √(m/k1)."""
        return run_ensemble(
            self.fields,
            scene.alpha1,
            scene.alpha2,
            t_end=t_end * self.time_unit,
            tol=self.tol,
            workers=self.workers,
            **options,
        )

    def stiffness(self, scene: Scene) -> tuple[Stiffness, Any]:
        """K11, K12, K22 and det K at a scene."""
        p, g = _Fields(self.fields), geometry(scene.alpha1, scene.alpha2)
        return linear_stiffness(p, g), stiffness_determinant(p, g)


class _Fields:
    """Arrays of parameters, read like ``Parameters``."""

    def __init__(self, fields: Mapping[str, np.ndarray]) -> None:
        self.__dict__.update(fields)


@dataclass(frozen=True)
class Verdict:
    """Margins of one statement and how the runs behind them ended, both of shape (size,)."""

    margin: np.ndarray
    outcome: np.ndarray


@dataclass(frozen=True, kw_only=True)
class Statement:
    """One statement as a constraint.

    Attributes:
        name: its id, as in the claims table.
        criterion: what is checked, in words, with thresholds.
        horizon: in units of √(m/k1); NaN where no motion is computed.
        check: the function that measures the margin.
    """

    name: str
    criterion: str
    horizon: float
    check: Callable[[Candidates, Mapping[str, Highest]], Verdict]


@dataclass(frozen=True)
class Highest:
    """Largest y/l_pre of a run at a scene, its lowest contact force over k3 l_pre, and events."""

    y: np.ndarray
    separations: np.ndarray
    outcome: np.ndarray


def highest_y(candidates: Candidates, scene: Scene) -> Highest:
    """Largest y of the motion at a scene.

    Between samples y is the cubic through states and velocities, which misses a peak by less than
    (ω·SAMPLING)⁴/384 of the amplitude, 1e-4.
    """
    steps = np.linspace(0.0, scene.t_end, round(scene.t_end / SAMPLING) + 1)
    run = candidates.run(scene, scene.t_end, times=steps * candidates.time_unit[:, None])
    y, vy = run.samples[..., 1], run.samples[..., 3]
    spacing = candidates.time_unit[:, None] * (steps[1] - steps[0])
    peak = np.maximum(np.nanmax(y, axis=1), _cubic_peaks(y, vy * spacing))
    return Highest(peak / candidates.fields["preload"], run.separations, run.outcome)


def _cubic_peaks(y: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Largest interior maximum of the cubics between samples; slopes are per sample spacing."""
    rising = (slope[:, :-1] > 0) & (slope[:, 1:] < 0)
    rows, columns = np.nonzero(rising)
    y0, y1 = y[rows, columns], y[rows, columns + 1]
    s0, s1 = slope[rows, columns], slope[rows, columns + 1]
    cubic, square = s0 + s1 - 2 * (y1 - y0), 3 * (y1 - y0) - 2 * s0 - s1
    # The maximum solves 3 cubic t² + 2 square t + s0 = 0; this form of the root never cancels.
    t = s0 / (np.sqrt(square * square - 3 * cubic * s0) - square)
    peaks = np.full(y.shape[0], -np.inf)
    np.maximum.at(peaks, rows, y0 + t * (s0 + t * (square + t * cubic)))
    return peaks


def _keeps_contact(name: str) -> Callable[..., Verdict]:
    def check(_: Candidates, highest: Mapping[str, Highest]) -> Verdict:
        return Verdict(1.0 - highest[name].y, highest[name].outcome)

    return check


def _loses_contact(_: Candidates, highest: Mapping[str, Highest]) -> Verdict:
    return Verdict(highest["F2d"].y - 1.0, highest["F2d"].outcome)


def _alike(_: Candidates, highest: Mapping[str, Highest]) -> Verdict:
    runs = [highest[name] for name in ("F2a", "F2b", "F2c")]
    lowest = np.stack([np.maximum(1.0 - run.y, 0.0) for run in runs])
    return Verdict(SPREAD - np.ptp(lowest, axis=0), np.max([run.outcome for run in runs], axis=0))


def _jumps(_: Candidates, highest: Mapping[str, Highest]) -> Verdict:
    run = highest["F5a"]
    return Verdict((run.separations - (JUMPS - 0.5)) / JUMPS, run.outcome)


@dataclass(frozen=True)
class _Amplitudes:
    """Largest |x| in the first quarter, in the last quarter and at all, m, and 2L, m."""

    early: np.ndarray
    late: np.ndarray
    whole: np.ndarray
    reach: np.ndarray
    outcome: np.ndarray


def _amplitudes(candidates: Candidates, scene: Scene) -> _Amplitudes:
    first = candidates.run(scene, 0.25 * scene.t_end)
    rest = candidates.run(
        scene,
        0.75 * scene.t_end,
        initial_state=first.final_state,
        t_late=0.5 * scene.t_end * candidates.time_unit,
    )
    return _Amplitudes(
        first.max_x,
        rest.late_max_x,
        np.maximum(first.max_x, rest.max_x),
        2.0 * np.maximum(candidates.fields["length1"], candidates.fields["length2"]),
        np.maximum(first.outcome, rest.outcome),
    )


def _grows(candidates: Candidates, _: Mapping[str, Highest]) -> Verdict:
    x = _amplitudes(candidates, SCENES["F3"])
    growth, size = np.log(x.late / (GROWTH * x.early)), np.log(x.whole / x.reach)
    return Verdict(np.minimum(growth, size), x.outcome)


def _stays_bounded(candidates: Candidates, _: Mapping[str, Highest]) -> Verdict:
    x = _amplitudes(candidates, SCENES["F4"])
    steadiness, size = np.log(STEADINESS * x.early / x.late), np.log(x.reach / x.whole)
    return Verdict(np.minimum(steadiness, size), x.outcome)


def _linearly_stable(candidates: Candidates, _: Mapping[str, Highest]) -> Verdict:
    stiffness, determinant = candidates.stiffness(SCENES["F3"])
    fields = candidates.fields
    invariants = spectrum(
        stiffness, determinant, k3=fields["k3"], mu=fields["mu"], mass=fields["mass"]
    )
    divergence = invariants.determinant * fields["mass"] ** 2 / (stiffness.k11 * fields["k3"])
    flutter = invariants.discriminant / invariants.half_trace**2
    return _closed(np.minimum(divergence, np.where(flutter < 0, flutter, np.inf)))


def _modes_switched(candidates: Candidates, _: Mapping[str, Highest]) -> Verdict:
    fields = candidates.fields
    before, _ = candidates.stiffness(SCENES["F12"])
    after, _ = candidates.stiffness(SCENES["F13"])
    first = before.k22 + fields["k3"] - before.k11
    second = after.k11 - after.k22 - fields["k3"]
    return _closed(np.minimum(first, second) / fields["k1"])


def _closed(margin: np.ndarray) -> Verdict:
    return Verdict(margin, np.full(np.shape(margin), int(Outcome.converged), np.int8))


def _in_scene(name: str, criterion: str, check: Callable[..., Verdict], scene: str) -> Statement:
    return Statement(name=name, criterion=criterion, horizon=SCENES[scene].t_end, check=check)


STATEMENTS: tuple[Statement, ...] = (
    *(
        _in_scene(name, "y stays below l_pre; margin 1 − y_max/l_pre", _keeps_contact(name), name)
        for name in ("F2a", "F2b", "F2c")
    ),
    _in_scene("F2d", "y exceeds l_pre; margin y_max/l_pre − 1", _loses_contact, "F2d"),
    _in_scene(
        "F2e",
        f"lowest N/(k3 l_pre) of F2a–F2c within {SPREAD}; margin {SPREAD} − spread",
        _alike,
        "F2a",
    ),
    _in_scene(
        "F3",
        f"|x| exceeds 2L, and in the last quarter {GROWTH} times the first; "
        f"margin min(ln(|x|/2L), ln(ratio/{GROWTH}))",
        _grows,
        "F3",
    ),
    _in_scene(
        "F4",
        f"|x| below 2L, and last quarter below {STEADINESS} times the first; "
        f"margin min(ln(2L/|x|), ln({STEADINESS}/ratio))",
        _stays_bounded,
        "F4",
    ),
    _in_scene(
        "F5b",
        f"at least {JUMPS} separations at (π, π); margin (separations − {JUMPS - 0.5})/{JUMPS}",
        _jumps,
        "F5a",
    ),
    Statement(
        name="F6d",
        criterion="A3 stable at (0.4π, 0.6π): μ < cot 0.4π; margin det/(K11 k3) = 1 − μ tan 0.4π",
        horizon=np.nan,
        check=_linearly_stable,
    ),
    Statement(
        name="F13",
        criterion="x mode first at (3π/4, 3π/4) and second at (5π/6, 5π/6); margin of the "
        "stiffnesses K11 and K22 + k3 over k1, 1 − κ at the latter",
        horizon=np.nan,
        check=_modes_switched,
    ),
)
"""What the paper says of its figures, where it constrains the parameters."""


def measure(candidates: Candidates) -> dict[str, Verdict]:
    """Every statement's margin for every candidate."""
    highest = {
        name: highest_y(candidates, SCENES[name]) for name in ("F2a", "F2b", "F2c", "F2d", "F5a")
    }
    return {statement.name: statement.check(candidates, highest) for statement in STATEMENTS}


def candidate_of(params: Parameters, *, tol: float) -> Candidates:
    """One candidate from a study's parameters."""
    fields = {name: np.array([value]) for name, value in params.as_dict().items()}
    return Candidates(fields, tol, workers=1)
