"""The flow of a hybrid system with its derivative, through located events.

Between events the derivative by the state and by one parameter is that of
:mod:`tests.oracles.step_derivatives`; at an event it is multiplied by the saltation
matrix, which accounts for the shift of the event's time.
"""

from dataclasses import dataclass, field
from itertools import zip_longest
from typing import Any, NamedTuple

import heyoka
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from tests.oracles import taylor_compiler
from tests.oracles.step_derivatives import step_derivatives

Vector = NDArray[np.float64]
TOLERANCE = 1e-16
_NODES = np.linspace(0.0, 1.0, 9)
_NO_SURFACE = 2**32
"""heyoka numbers a stop at surface i as −1 − i, other ends from −2³² down."""


class Switched(NamedTuple):
    """What follows an event.

    Attributes:
        kind: of the event, an integer of the system's.
        regime: the next one.
        state: put onto the surface, and off it by a unit of round-off into the next regime.
        gradient: of the surface by state and parameter, or None where the field is continuous
            across it.
    """

    kind: int
    regime: int
    state: Vector
    gradient: Vector | None


class CompiledFlow(NamedTuple):
    """A system's symbolic equations, compiled.

    Attributes:
        integrator: stops at the surfaces.
        slopes: derivatives of the accelerations by state and parameter.
        gradients: of the surfaces, likewise.
    """

    integrator: Any
    slopes: Any
    gradients: Any


def compile_flow(equations, surfaces, parameters, varied):
    """heyoka's integrator, stopping at the surfaces, and what its derivatives are made of.

    Compact mode costs a factor of two in speed and saves seconds of compilation.

    Args:
        equations: of the state, positions before velocities.
        surfaces: functions that are zero where a regime ends.
        parameters: number of symbolic parameters.
        varied: how many of them, from the first on, may change with the one that is followed:
            with their rates behind them, and an offset of 0 in the last place, they are the
            parameters of the derivatives.
    """
    taylor_compiler.set_up()
    offset = heyoka.par[parameters + varied]
    along = {
        heyoka.par[i]: heyoka.par[i] + heyoka.par[parameters + i] * offset for i in range(varied)
    }
    variables = [variable for variable, _ in equations]

    def derivatives(functions):
        moved = heyoka.subs(list(functions), along)
        by = (*variables, offset)
        return heyoka.cfunc([heyoka.diff(f, v) for f in moved for v in by], vars=variables)

    integrator = heyoka.taylor_adaptive(
        list(equations),
        np.zeros(len(equations)),
        tol=TOLERANCE,
        compact_mode=True,
        t_events=[heyoka.t_event(surface, cooldown=0.0) for surface in surfaces],
    )
    accelerations = [rate for _, rate in equations[len(equations) // 2 :]]
    return CompiledFlow(integrator, derivatives(accelerations), derivatives(surfaces))


@dataclass
class Segment:
    """The motion between two events: times and Taylor coefficients of its steps.

    Attributes:
        regime: of the segment.
        start: its time.
        times: step boundaries from ``start`` on, (steps + 1,).
        coefficients: of the state in each step, (steps, states, order + 1).
    """

    regime: int
    start: float
    times: Vector
    coefficients: Vector


@dataclass
class Passage:
    """Where the flow leads in a given time.

    Attributes:
        state: at the end.
        regime: at the end.
        derivative: of the end state by the initial one, (states, states); NaN without.
        slope: of the end state by the parameter that is followed, (states,); NaN without.
        event_times, event_kinds, event_states: in order.
        regimes: at the start and after each event.
        segments: the motion between events, if kept.
        complete: whether the end was reached within the limit of events.
    """

    state: Vector
    regime: int
    derivative: Vector
    slope: Vector
    event_times: list[float] = field(default_factory=list)
    event_kinds: list[int] = field(default_factory=list)
    event_states: list[Vector] = field(default_factory=list)
    regimes: list[int] = field(default_factory=list)
    segments: list[Segment] = field(default_factory=list)
    complete: bool = True


def flow(
    system, state, duration, *, derivative=True, keep=False, max_events=2000, max_steps=100_000
):
    """Follow a state for some time through all events.

    Args:
        system: as :class:`tests.oracles.a1_flow.A1Flow`.
        state: initial state.
        duration: time to go, positive.
        derivative: compute that of the end state; the motion is kept for it.
        keep: keep the motion between events.
        max_events, max_steps: limits after which the passage is incomplete.
    """
    size = len(state)
    integrator = system.integrator
    regime, state = system.start(np.asarray(state, dtype=np.float64))
    passage = Passage(state, regime, np.full((size, size), np.nan), np.full(size, np.nan))
    passage.regimes.append(regime)
    saltations: list[Vector] = []
    integrator.time = 0.0
    while True:
        integrator.pars[:] = system.parameters(regime)
        integrator.state[:] = state
        integrator.reset_cooldowns()
        outcome, steps = _propagate(
            integrator, regime, duration, max_steps, passage, keep or derivative
        )
        state = integrator.state.copy()
        max_steps -= steps
        surface = -int(outcome.value) - 1
        if surface >= _NO_SURFACE or len(passage.event_times) >= max_events or max_steps <= 0:
            passage.complete = outcome == heyoka.taylor_outcome.time_limit
            break
        before = regime
        switched = system.switch(surface, regime, state)
        if derivative:
            saltations.append(_saltation(system, state, before, switched))
        regime, state = switched.regime, switched.state
        if switched.kind >= 0:
            passage.event_times.append(float(integrator.time))
            passage.event_kinds.append(switched.kind)
            passage.event_states.append(state)
            passage.regimes.append(regime)
    passage.state, passage.regime = state, regime
    if derivative:
        total = _derivative(system, passage.segments, saltations)
        passage.derivative, passage.slope = total[:size, :size], total[:size, size]
    return passage


def _propagate(integrator, regime, duration, max_steps, passage, keep):
    """To the end or the next surface: (heyoka's outcome, steps).

    heyoka's own continuous output is compiled anew each time, which takes ten times longer than
    the motion.
    """
    if not keep:
        outcome, _, _, steps, _, _ = integrator.propagate_until(duration, max_steps=max_steps)
        return outcome, steps
    outcome, size = heyoka.taylor_outcome.time_limit, len(passage.state)
    times = [float(integrator.time)]
    coefficients: list[Vector] = []
    while times[-1] < duration and len(coefficients) < max_steps:
        outcome, _ = integrator.step(duration - times[-1], write_tc=True)
        times.append(float(integrator.time))
        coefficients.append(integrator.tc.copy())
        if outcome != heyoka.taylor_outcome.success:
            break
    order = integrator.tc.shape[1]
    passage.segments.append(
        Segment(regime, times[0], np.array(times), np.array(coefficients).reshape(-1, size, order))
    )
    return outcome, len(coefficients)


def _saltation(system, state, before, switched):
    """I + (f₊ − f₋)(∇hᵀ, ∂h/∂p)/(∇h·f₋), (states + 1, states + 1)."""
    size = len(state)
    matrix = np.eye(size + 1)
    if switched.gradient is not None:
        field_before = system.velocity(before, state)
        jump = system.velocity(switched.regime, switched.state) - field_before
        rate = float(switched.gradient[:size] @ field_before)
        matrix[:size] += np.outer(jump, switched.gradient / rate)
    return matrix


def _derivative(system, segments, saltations):
    """The product of the steps' derivatives and the saltations, (states + 1, states + 1)."""
    lengths = [len(part.coefficients) for part in segments]
    regimes = np.repeat([part.regime for part in segments], lengths)
    factors = step_derivatives(
        lambda states: system.slopes(np.repeat(regimes, states.shape[1] // len(regimes)), states),
        np.concatenate([np.diff(part.times) for part in segments]),
        np.concatenate([part.coefficients for part in segments]),
    )
    total: Vector = np.eye(factors.shape[1])
    first = 0
    for length, saltation in zip_longest(lengths, saltations):
        for factor in factors[first : first + length]:
            total = factor @ total
        if saltation is not None:
            total = saltation @ total
        first += length
    return total


def extrema(segments, component):
    """Values of a component at its extrema between events."""
    found = []
    for segment in segments:
        steps = np.diff(segment.times)
        powers = np.arange(segment.coefficients.shape[2])
        scaled = segment.coefficients * steps[:, None, None] ** powers
        rates = scaled[:, component, 1:] * powers[1:]
        values = rates @ _NODES ** powers[:-1, None]
        for step, left in zip(*np.nonzero(values[:, :-1] * values[:, 1:] < 0.0), strict=True):
            root = _root(rates[step], _NODES[left], _NODES[left + 1])
            found.append(float(np.polynomial.polynomial.polyval(root, scaled[step, component])))
    return found


def _root(polynomial, left, right):
    """The root of a polynomial that changes its sign once between two places."""
    return float(brentq(lambda at: np.polynomial.polynomial.polyval(at, polynomial), left, right))
