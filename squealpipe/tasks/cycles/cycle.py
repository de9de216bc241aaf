"""One periodic motion of model A1, from a settled run or a guess."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
import xarray as xr
from scipy.optimize import root

from squealpipe.codes import Regime
from squealpipe.methods.cycles.cycles import Cycle, common_scale, find_returns, solve_cycle
from squealpipe.methods.cycles.event_flow import Vector, flow, sample_path
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.cycles import LIMIT_CYCLE
from squealpipe.schema.origin import recorded
from squealpipe.solvers.a1.flow import ULP, A1Flow
from squealpipe.validation import Angle, Positive, State, one_of

T_SETTLE = 2000.0
"""Default time, in units of √(m/min(k1, k2)), after which a run counts as settled."""
_WINDOWS = (40.0, 160.0)
"""Times within which a return is looked for, in the same units."""
_NEAR = 0.05
"""A return this close, over the extent of the motion, ends the search for a better one."""
_FAR = 0.3
"""Newton's method has left the motion that it started from, over its period and extent."""
_TRIES = 4
_AT_REST = 1e-9
_MOST_EVENTS = 1_000_000
_MOST_ROUNDS = 100
SAMPLES = 400

SCALARS = (
    "period",
    "x_min",
    "x_max",
    "y_min",
    "y_max",
    "contact_fraction",
    "stick_fraction",
    "least_contact_force",
    "residual",
)


@recorded(method="Newton on the return map, events located")
def limit_cycle(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    model: Annotated[str, one_of(["A1"])] = "A1",  # noqa: ARG001 (in the record)
    guess: State | None = None,
    t_settle: Positive | None = None,
) -> xr.Dataset:
    """A periodic motion of A1 with every event located, its stability included.

    Newton's method on the return map; its derivative comes from the variational equations, with
    the saltation matrix at each event. Without damping cycles come in families: the member nearest
    to the guess is returned with the outcome ``family_member``.

    Args:
        params: physical parameters.
        alpha1, alpha2: angles, rad.
        model: "A1".
        guess: state (x, y, ẋ, ẏ) in m and m/s near the cycle, which may be unstable. Without it,
            the state that a run from rest has reached at ``t_settle``.
        t_settle: s; default 2000 √(m/min(k1, k2)). A run that takes too many steps for it ends with
            ``step_limit``.

    Returns:
        Dataset with period (s), extrema (m), fractions in contact and stick, Floquet multipliers
        (the trivial one first), events, and the motion at 401 instants. NaN with the reason in
        ``outcome`` where no cycle is found.

    Raises:
        ValueError: an argument is not allowed.
    """
    system = A1Flow(params, alpha1, alpha2)
    if guess is None:
        settle = T_SETTLE * slow_time(params) if t_settle is None else t_settle
        state, outcome = settled_state(system, settle)
        if state is None:
            return cycle_dataset(None, outcome, alpha1, alpha2)
    else:
        state = guess
    cycle, outcome = find_cycle(system, state)
    return cycle_dataset(cycle, outcome, alpha1, alpha2)


def slow_time(params: Parameters) -> float:
    """√(m/min(k1, k2)), s: motions of the softer spring settle last, whichever it is."""
    return math.sqrt(params.mass / min(params.k1, params.k2))


def settled_state(system: A1Flow, time: float) -> tuple[Vector | None, Outcome]:
    """The state that a run from rest has reached at some time, s; None with the reason."""
    run = flow(system, np.zeros(4), time, derivative=False, max_events=_MOST_EVENTS)
    if not np.isfinite(run.state).all():
        return None, Outcome.not_finite
    if not run.complete:
        many = len(run.event_times) >= _MOST_EVENTS
        return None, Outcome.event_limit if many else Outcome.step_limit
    return run.state, Outcome.converged


def find_cycle(system: A1Flow, state: Vector) -> tuple[Cycle | None, Outcome]:
    """The cycle near a state, and its outcome."""
    unit = slow_time(system.params)
    trial = flow(system, state, unit, derivative=False, keep=True)
    if not np.isfinite(trial.state).all():
        at_pivot = system.is_singular(trial)
        return None, Outcome.singular_geometry if at_pivot else Outcome.not_finite
    tried: list[float] = []
    for window in _WINDOWS:
        returns = find_returns(system, state, window * unit)
        if returns and returns[0][1] == 0.0:
            return None, Outcome.equilibrium
        last = window == _WINDOWS[-1]
        for time, distance in returns[:_TRIES]:
            if distance > (_FAR if last else _NEAR):
                break
            if any(abs(time - other) < 1e-3 * time for other in tried):
                continue
            tried.append(time)
            cycle = least_cycle(system, state, time)
            if cycle is None:
                continue
            if np.abs(cycle.extent[1] - cycle.extent[0]).max() < _AT_REST * _size(cycle):
                return None, Outcome.equilibrium
            return cycle, Outcome.family_member if cycle.is_family_member else Outcome.converged
    # only now: a smooth cycle about a stable state of rest may seem to shrink from sample to sample
    rests = any(_comes_to_rest(system, state, window * unit) for window in _WINDOWS)
    return None, Outcome.equilibrium if rests else Outcome.no_convergence


def _comes_to_rest(system: A1Flow, state: Vector, window: float) -> bool:
    """Whether a motion shrinks towards a stable state of rest, which none does without damping."""
    passage = flow(system, state, window, derivative=False, keep=True)
    if passage.event_kinds or system.has_families:
        return False
    p, time = system.params, slow_time(system.params)
    scale = p.preload * np.array([1.0, 1.0, 1.0 / time, 1.0 / time])
    path = sample_path(passage.segments, np.linspace(0.0, window, 400)) / scale
    first, second = (np.ptp(half, axis=0).max() for half in np.split(path, 2))

    def state_at(place: Vector) -> Vector:
        return np.asarray(scale * np.array([place[0], place[1], 0.0, 0.0]))

    def pull(place: Vector) -> Vector:
        return np.asarray((system.velocity(passage.regime, state_at(place)) * time / scale)[2:])

    middle = path[200:, :2].mean(axis=0)
    rest = root(pull, middle, tol=1e-13)
    round_off = ULP * (1.0 + max(p.length1, p.length2) / p.preload)
    # the solver may deny success of a place that round-off keeps from being better
    found = np.abs(rest.fun).max() <= 64.0 * round_off + 1e-9 * second
    near = np.abs(rest.x - middle).max() <= 0.5 * second + 1e-9 * _reach(path)
    if not (found and near):
        return False
    growth = np.linalg.eigvals(system.jacobian(passage.regime, state_at(rest.x))).real.max()
    return bool(growth < 0.0 and second < first + 1e-12 * _reach(path) + 64.0 * round_off)


def _reach(path: Vector) -> float:
    return float(np.abs(path).max()) + 1e-300


def _size(cycle: Cycle) -> float:
    return float(np.abs(cycle.state[:2]).max()) + 1e-300


def least_cycle(system: A1Flow, state: Vector, time: float) -> Cycle | None:
    """The cycle from a return, described from outside stick and by its least period."""
    passage = flow(system, state, time, derivative=False, keep=True)
    free = [part for part in passage.segments if not system.holds(part.regime)]
    if not free:
        return None
    longest = max(free, key=lambda part: part.times[-1] - part.times[0])
    middle = 0.5 * float(longest.times[0] + longest.times[-1])
    place = sample_path(passage.segments, np.array([middle]))[0]
    scale = common_scale(sample_path(passage.segments, np.linspace(0.0, time, 200)))
    cycle = solve_cycle(system, place, time, scale)
    if cycle is not None and not (
        abs(cycle.period - time) < _FAR * time
        and np.abs((cycle.state - place) / scale).max() < _FAR
    ):
        return None
    rounds = 1 if cycle is None else _rounds(cycle)
    if cycle is not None and rounds > 1:
        cycle = solve_cycle(system, cycle.state, cycle.period / rounds, scale) or cycle
    return cycle


def _rounds(cycle: Cycle) -> int:
    """How many times a cycle runs through a shorter one: 1 if its period is the least."""
    phases, parts = np.arange(8) / 8, np.arange(2, _MOST_ROUNDS + 1)
    before = sample_path(cycle.segments, cycle.period * phases)
    later = (phases + 1.0 / parts[:, None]) % 1.0
    after = sample_path(cycle.segments, cycle.period * later.ravel()).reshape(len(parts), 8, -1)
    same = (np.abs(after - before) < 1e-6 * cycle.scale).all(axis=(1, 2))
    return int(parts[same].max(initial=1))


def cycle_values(cycle: Cycle) -> dict[str, Any]:
    """The scalars of a dataset, and the multipliers."""
    (x_min, y_min), (x_max, y_max) = cycle.extent
    times = dict.fromkeys(Regime, 0.0)
    for part in cycle.segments:
        times[Regime(part.regime)] += float(part.times[-1] - part.times[0])
    p = cycle.system.params  # type: ignore[attr-defined]
    return {
        "period": cycle.period,
        "x_min": x_min,
        "x_max": x_max,
        "y_min": y_min,
        "y_max": y_max,
        "contact_fraction": 1.0 - times[Regime.separated] / cycle.period,
        "stick_fraction": times[Regime.stick] / cycle.period,
        "least_contact_force": p.k3 * max(p.preload - y_max, 0.0),
        "residual": cycle.closing_error,
        "stable": int(cycle.is_stable and not cycle.is_family_member),
        "multiplier_real": cycle.multipliers.real,
        "multiplier_imag": cycle.multipliers.imag,
    }


def cycle_dataset(
    cycle: Cycle | None, outcome: Outcome, alpha1: float, alpha2: float
) -> xr.Dataset:
    """A limit cycle, or the reason why there is none, as a dataset."""
    names = ("x", "y", "vx", "vy")
    if cycle is None:
        values: dict[str, Any] = dict.fromkeys(SCALARS, math.nan)
        values |= {"stable": 0, "multiplier_real": np.full(4, np.nan)}
        values["multiplier_imag"] = np.full(4, np.nan)
        start, times, path = np.full(4, np.nan), np.empty(0), np.empty((0, 4))
        event_times, kinds, states, regimes = [], [], np.empty((0, 4)), []
        regime_path = np.empty(0, np.int8)
    else:
        values, start, passage = cycle_values(cycle), cycle.state, cycle.passage
        event_times, kinds, regimes = passage.event_times, passage.event_kinds, passage.regimes
        states = np.array(passage.event_states).reshape(-1, 4)
        times = np.linspace(0.0, cycle.period, SAMPLES + 1)
        path = sample_path(cycle.segments, times)
        regime_path = np.array(regimes)[np.searchsorted(event_times, times, side="right")]
    return build(
        LIMIT_CYCLE,
        {
            **values,
            "event_time": event_times,
            "event_kind": kinds,
            **{f"event_{name}": states[:, i] for i, name in enumerate(names)},
            "segment_regime": regimes,
            **{f"{name}_start": start[i] for i, name in enumerate(names)},
            "time": times,
            **{f"{name}_path": path[:, i] for i, name in enumerate(names)},
            "regime_path": regime_path,
            "alpha1": alpha1,
            "alpha2": alpha2,
            "outcome": outcome,
        },
        {"multiplier": np.arange(1, 5)},
    )
