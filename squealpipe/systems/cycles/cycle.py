"""One periodic motion of a system: found from a settled run or a guess, described, as a dataset."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from squealpipe.methods.taylor.layout import STOPPED
from squealpipe.schema import Outcome, flag_table, in_words
from squealpipe.systems import runs
from squealpipe.systems.cycles.admissible import is_motion
from squealpipe.systems.cycles.event_map import FREE, Cycle, EventMap, Section, scale_of
from squealpipe.systems.cycles.flow import Event, Flow, Vector
from squealpipe.systems.runs import Motion, single_run
from squealpipe.validation import Natural, Positive, Values, checked

if TYPE_CHECKING:
    from squealpipe.systems.definition import System

SETTLE = 200.0
"""Forcing periods, or units of time, after which a run counts as settled."""
MOST_PERIODS = 64
"""Most forcing periods after which a settled motion is looked for again."""
_WINDOWS = (40.0, 160.0, 640.0)
"""Times, in units, within which a return is looked for without forcing."""
_NEAR, _FAR = 0.05, 0.3
"""A return this close, over the motion's extent, ends the search; one this far is none."""
_NEARER = 0.99
"""Distance from a cycle after all those periods, over the one before, of what settles on it."""
_TRIES, _SAMPLES = 4, 2000
MOST_ROUNDS = 32
SETTLE_STEPS = 100_000
"""Steps after which a run that is to settle is given up."""
_BRIEF = 1e-3
"""Share of the period below which a leg may have vanished."""
_AT_REST = 1e-9
SETTLED_ON = 200
"""Outcome of a settled motion of k periods, less k."""


def follow(
    flow: Flow,
    values: Mapping[str, float],
    state: Vector,
    duration: float,
    **options: Any,
) -> Motion:
    """Run a system from a state at t = 0 with all events."""
    system, regime = flow.system, options.pop("regime", None)
    first = None if regime is None else np.array([system.joint.regimes(regime)])
    states = dict(zip(system.states, map(float, state), strict=True))
    with np.errstate(all="ignore"):
        return single_run(
            system,
            {**values, **states},
            duration,
            regime=first,
            tol=1e-13,
            unit_sizes=sizes_at(flow, values, state, regime or 0),
            **options,
        )


def sizes_at(
    flow: Flow, values: Mapping[str, float], state: Vector, regime: int
) -> Vector:
    """Sizes of the states in a motion that may be far smaller than the system's own sizes."""
    sizes, unit = flow.system.sizes, flow.unit(values)
    with np.errstate(all="ignore"):
        rates = flow.field(values, regime, state, 0.0) * unit
        largest = max(float(np.abs(each / sizes).max()) for each in (state, rates))
    return sizes * min(1.0, largest) if 0.0 < largest < np.inf else sizes


def events_of(system: System, motion: Motion, count: int) -> tuple[Event, ...]:
    """The first events of a run, each with its switch."""
    t, joint = system.traced, system.joint
    found: list[Event] = []
    for i in range(count):
        before, after, kind, entered = (
            int(v)
            for v in (*motion.regimes[i : i + 2], motion.kinds[i], motion.entered[i])
        )
        fitting = (
            Event(int(switch), surface, sign, before, after, kind)
            for watched, sign in (
                (joint.falls(before), 1.0),
                (joint.rises(before), -1.0),
            )
            for surface, switch in enumerate(watched)
            if 0 <= switch < len(t.switches)
            and any(
                (to, name) == (entered, kind)
                for to, _, name in t.switches[switch].targets
            )
        )
        found += islice(fitting, 1)
    return tuple(found)


def guess_of(
    flow: Flow,
    values: Mapping[str, float],
    motion: Motion,
    state: Vector,
    period: float,
    *,
    periods: int,
    count: int | None = None,
    scale: Vector,
) -> tuple[EventMap, Vector] | None:
    """Equations and guess from a run that is nearly periodic; None where its regimes are not.

    Args:
        period: after which it nearly repeats, s.
        periods: of the forcing in it; 0 without.
        count: events of one period; all by default.
    """
    count = len(motion.times) if count is None else count
    units = np.array([max(abs(values[name]), 1e-300) for name in flow.followed])
    followed = np.array([values[name] for name in flow.followed])
    if motion.regimes[0] != motion.regimes[count]:
        return None
    equations = EventMap(flow, (), values, scale, period, units, periods)
    if count == 0:
        return eventless(equations, state, int(motion.regimes[0]), period, followed)
    events = events_of(flow.system, motion, count)
    if len(events) < count:
        return None
    times = motion.times[:count]
    durations = np.append(np.diff(times), times[0] + period - times[-1])
    # legs begin after each event: the last ends at the first event
    equations = replace(equations, events=(*events[1:], events[0]))
    return equations, equations.pack(
        motion.states[:count], durations, float(times[0]), followed
    )


def eventless(
    equations: EventMap, state: Vector, regime: int, period: float, followed: Vector
) -> tuple[EventMap, Vector]:
    """Equations and guess of a cycle through a state that stays in one regime."""
    section = None
    if not equations.periods:
        heading = (
            equations.flow.field(equations.values, regime, state, 0.0) / equations.scale
        )
        section = Section(state, heading / np.linalg.norm(heading))
    free = Event(FREE, FREE, 1.0, regime, regime, FREE)
    made = replace(equations, events=(free,), section=section)
    return made, made.pack(state[None], np.array([period]), 0.0, followed)


def solved(equations: EventMap, guess: Vector) -> Cycle | None:
    """The cycle near a guess, if it is a motion of the system."""
    point = equations.solve(guess)
    return None if point is None else as_motion(Cycle.at(equations, point))


def as_motion(cycle: Cycle) -> Cycle | None:
    """A solution if it is a motion of the system, perhaps without a pair of events.

    Next to a touch round-off decides whether a run has a pair there.
    """
    if cycle.period > 0.0 and is_motion(cycle):
        return cycle
    found = (solved(*fewer) for fewer in without_brief_legs(cycle))
    return next((each for each in found if each is not None), None)


def without_brief_legs(cycle: Cycle) -> Iterator[tuple[EventMap, Vector]]:
    """Equations and guess without one of the legs that may have vanished."""
    events = cycle.map.events
    for leg in np.flatnonzero(cycle.parts.durations < _BRIEF * cycle.period).tolist():
        if events[leg - 1].before == events[leg].after and len(events) > 1:
            yield merged(cycle, (leg - 1) % len(events), 2)


def merged(cycle: Cycle, leg: int, count: int) -> tuple[EventMap, Vector]:
    """Equations and guess in which a leg goes on through the next ones, without events between."""
    equations, parts = cycle.map, cycle.parts
    if count >= equations.legs:
        state, _ = cycle.start()
        made, regime = (
            replace(equations, values=parts.values),
            equations.events[leg].before,
        )
        return eventless(made, state, regime, cycle.period, cycle.followed)
    absorbed = [(leg + k) % equations.legs for k in range(1, count + 1)]
    keep = [i for i in range(equations.legs) if i not in absorbed]
    events, durations = list(equations.events), parts.durations.copy()
    events[leg] = events[absorbed[-1]]
    durations[leg] += durations[absorbed].sum()
    fewer = replace(equations, events=tuple(events[i] for i in keep))
    start = parts.start + float(cycle.clocks[keep[0]])
    return fewer, fewer.pack(parts.states[keep], durations[keep], start, cycle.followed)


def find_cycle(
    system: System,
    values: Mapping[str, float],
    state: Vector,
    *,
    guess: bool,
    periods: int = 1,
    t_settle: float | None = None,
    regime: int | None = None,
    unit: float | None = None,
) -> tuple[Cycle | None, int]:
    """A cycle from a start or near a guess, and an outcome: above 200, of that many periods more.

    Args:
        periods: of the forcing, or returns to the section; 0 for any number.
        unit: of time, in which a run settles and returns are looked for; by default the system's.
    """
    flow = Flow(system)
    if system.period is not None and flow.timed:
        return _forced(flow, values, state, guess, periods, t_settle, regime)
    unit = flow.unit(values) if unit is None else unit
    if not guess:
        settle = SETTLE * unit if t_settle is None else t_settle
        run = follow(flow, values, state, settle, most_steps=SETTLE_STEPS)
        if run.outcome:
            return None, run.outcome
        state, regime = run.final, int(run.regimes[-1])
    return _free(flow, values, state, regime, unit, 0 if guess else periods)


def _forced(
    flow: Flow,
    values: Mapping[str, float],
    state: Vector,
    guess: bool,
    periods: int,
    t_settle: float | None,
    regime: int | None,
) -> tuple[Cycle | None, int]:
    forcing = flow.forcing(values)[0]
    if not 0.0 < forcing < np.inf:
        raise ValueError(
            f"{flow.system.name}: the period of its forcing must be greater than 0"
        )
    if guess:
        return _near(flow, values, state, regime, periods)
    rounds = SETTLE if t_settle is None else max(1.0, np.ceil(t_settle / forcing))
    run = follow(flow, values, state, rounds * forcing)
    if run.outcome:
        return None, run.outcome
    state, regime = run.final, int(run.regimes[-1])
    times = forcing * np.arange(1, MOST_PERIODS + 1)
    path = follow(flow, values, state, times[-1], regime=regime, times=times).path
    largest = np.abs(path).max(axis=0) + 1e-300
    size = np.maximum(np.ptp(path, axis=0), 1e-9 * largest)
    distance = np.abs((path - state) / size).max(axis=1)
    rests = bool((np.abs(path - state).max(axis=0) <= 1e-6 * largest).all())
    near = distance < 3.0 * distance.min() + 1e-6
    least = 1 if rests else int(np.flatnonzero(near)[0]) + 1
    if distance[least - 1] > _FAR and not rests:
        return None, Outcome.no_convergence
    if periods % least == 0:
        return _near(flow, values, state, regime, periods)
    # it may still settle to and fro, on the cycle that is asked for
    cycle, outcome = _near(flow, values, path[:least].mean(axis=0), regime, periods)
    if cycle is not None and cycle.is_stable:
        place, _ = cycle.start()
        before, after = (np.abs((at - place) / size).max() for at in (state, path[-1]))
        if after < _NEARER * before:
            return cycle, outcome
    return None, SETTLED_ON + least


def _near(
    flow: Flow,
    values: Mapping[str, float],
    state: Vector,
    regime: int | None,
    periods: int,
) -> tuple[Cycle | None, int]:
    """A cycle of some forcing periods near a state."""
    duration = periods * flow.forcing(values)[0]
    for _ in range(3):
        run = follow(
            flow,
            values,
            state,
            duration,
            regime=regime,
            times=np.linspace(0.0, duration, 200),
        )
        if run.outcome or not np.isfinite(run.path).all():
            return None, run.outcome or Outcome.not_finite
        scale = scale_of(np.concatenate([run.path, run.states]), flow.system.sizes)
        found = guess_of(
            flow, values, run, state, duration, periods=periods, scale=scale
        )
        point = None if found is None else found[0].solve(found[1])
        if found is None or point is None:
            # perhaps other events are those of the cycle: nearer to it once more
            state, regime = run.final, int(run.regimes[-1])
            continue
        cycle = Cycle.at(found[0], point)
        motion = as_motion(cycle)
        if motion is not None:
            return motion, Outcome.converged
        state, regime = cycle.start()
    return None, Outcome.no_convergence


def _free(
    flow: Flow,
    values: Mapping[str, float],
    state: Vector,
    regime: int | None,
    unit: float,
    returns: int,
) -> tuple[Cycle | None, int]:
    """A cycle without forcing near a state; with ``returns`` to its section, if that is not 0."""
    tried: list[float] = []
    for window in _WINDOWS:
        times = np.linspace(0.0, window * unit, _SAMPLES)
        run = follow(flow, values, state, times[-1], regime=regime, times=times)
        if run.outcome or not np.isfinite(run.path).all():
            return None, run.outcome or Outcome.not_finite
        if _rests(
            run.path[len(run.path) // 2 :], sizes_at(flow, values, state, regime or 0)
        ):
            return None, Outcome.equilibrium
        scale = scale_of(np.concatenate([run.path, run.states]), flow.system.sizes)
        for count, period, distance in _returns(flow, values, run, times, state, scale):
            if distance > (_FAR if window == _WINDOWS[-1] else _NEAR):
                break
            if any(abs(period - other) < 1e-3 * period for other in tried):
                continue
            tried.append(period)
            found = guess_of(
                flow, values, run, state, period, periods=0, count=count, scale=scale
            )
            cycle = None if found is None else solved(*found)
            if cycle is None or abs(cycle.period - period) > _FAR * period:
                continue
            if _rests(cycle.extremes[:, : flow.size], 0.0):
                return None, Outcome.equilibrium
            cycle = once_round(cycle)
            number = _least(cycle.events)
            if returns and number > returns:
                return None, SETTLED_ON + number
            return cycle, Outcome.converged
    # only now: a smooth cycle about a stable state of rest may seem to shrink between samples
    shrinks = not len(run.times) and _comes_to_rest(
        flow, values, int(run.regimes[0]), run.path
    )
    return None, Outcome.equilibrium if shrinks else Outcome.no_convergence


def once_round(cycle: Cycle) -> Cycle:
    """The same cycle run through once, where it was found after several rounds."""
    equations, parts = cycle.map, cycle.parts
    times = np.arange(8) / 8.0 * cycle.period
    here, _ = cycle.states_at(times)
    for rounds in range(MOST_ROUNDS, 1, -1):
        after, _ = cycle.states_at((times + cycle.period / rounds) % cycle.period)
        if equations.legs % rounds and cycle.events:
            continue
        if (np.abs(here - after) > 1e-6 * equations.scale).any():
            continue
        legs = max(equations.legs // rounds, 1)
        durations = parts.durations[:legs] / (1 if cycle.events else rounds)
        fewer = replace(equations, events=equations.events[:legs])
        guess = fewer.pack(parts.states[:legs], durations, parts.start, np.empty(0))
        return solved(fewer, guess) or cycle
    return cycle


def _comes_to_rest(
    flow: Flow, values: Mapping[str, float], regime: int, path: Vector
) -> bool:
    """Whether a motion in one regime shrinks towards a stable state of rest."""
    first, second = (
        np.ptp(half, axis=0) for half in np.split(path[: len(path) // 2 * 2], 2)
    )
    place = middle = path[len(path) // 2 :].mean(axis=0)
    scale = np.maximum(np.abs(path).max(axis=0), 1e-300)
    with np.errstate(all="ignore"):
        for _ in range(20):
            slopes = flow.jacobian(values, regime, place)[:, : flow.size]
            rate = flow.field(values, regime, place, 0.0)
            place = place - np.linalg.lstsq(slopes * scale, rate, rcond=None)[0] * scale
    if (
        not np.isfinite(place).all()
        or (np.abs(place - middle) > second + 1e-9 * scale).any()
    ):
        return False
    rates = np.linalg.eigvals(flow.jacobian(values, regime, place)[:, : flow.size])
    decays = rates.real.max() < -1e-9 * np.abs(rates).max()
    return bool(decays and (second <= first + 1e-12 * scale).all())


def _rests(path: Vector, sizes: Any) -> bool:
    """Whether a motion is within round-off."""
    largest = np.maximum(np.abs(path).max(axis=0), sizes)
    return bool((np.ptp(path, axis=0) <= _AT_REST * largest).all())


def _least(events: tuple[Event, ...]) -> int:
    """How often the rarest event of a cycle occurs: its returns to a section."""
    kinds = [(event.switch, event.after) for event in events]
    return min((kinds.count(kind) for kind in kinds), default=1)


def _returns(
    flow: Flow,
    values: Mapping[str, float],
    run: Motion,
    times: Vector,
    state: Vector,
    scale: Vector,
) -> Iterator[tuple[int, float, float]]:
    """(events, period, distance) of near returns, the best and earliest first."""
    found: list[tuple[int, float, float]] = []
    if len(run.times):
        keys = np.column_stack([run.kinds, run.regimes[:-1], run.regimes[1:]])
        for count in (np.flatnonzero((keys[1:] == keys[0]).all(axis=1)) + 1).tolist():
            distance = float(np.abs((run.states[count] - run.states[0]) / scale).max())
            found.append((count, float(run.times[count] - run.times[0]), distance))
    else:
        normal = flow.field(values, int(run.regimes[0]), state, 0.0) / scale
        height = ((run.path - state) / scale) @ normal
        for at in np.flatnonzero((height[:-1] < 0.0) & (height[1:] >= 0.0)):
            share = -height[at] / (height[at + 1] - height[at])
            there = run.path[at] + share * (run.path[at + 1] - run.path[at])
            distance = float(np.abs((there - state) / scale).max())
            found.append((0, float(times[at] + share * times[1]), distance))
    nearest = 3.0 * min((each[2] for each in found), default=0.0) + 1e-4
    found.sort(
        key=lambda each: (each[2] >= nearest, each[1] if each[2] < nearest else each[2])
    )
    yield from found[:_TRIES]


@checked
def limit_cycle(
    system: Any,
    *,
    start: Values | None = None,
    guess: Values | None = None,
    periods: Natural = 1,
    t_settle: Positive | None = None,
    **parameters: Any,
) -> xr.Dataset:
    """A periodic motion with every event located, its stability included.

    Newton's method on the legs between the events; derivatives are exact, through resets and with
    the forcing's phase.

    Args:
        start: from where to settle, states that differ from the system's start.
        guess: a state near the cycle, which may be unstable; at t = 0 of the forcing.
        periods: of the forcing; without it, returns to the section, which is the event that is
            met least often.
        t_settle: s; 200 forcing periods or time scales by default.
        parameters: those that differ from the system's.

    Returns:
        Dataset: ``period``, ``<state>_min``, ``<state>_max`` (of outputs too), ``multiplier_real``
        and ``multiplier_imag`` (the trivial one first without forcing), ``stable``, ``residual``,
        ``outcome``, events with states and regimes entered, and ``periods``. Times count from t = 0
        of the forcing, or from a state far from events. NaN with the reason in ``outcome`` where
        no cycle is found; ``settled_on_k_periods`` where the settled motion has more than asked.

    Raises:
        ValueError: an unknown state or parameter, a value that is not a finite number, or explicit
            time without a period.
    """
    values, state = given(system, guess if guess is not None else start, parameters)
    if start is not None and guess is not None:
        raise ValueError("start, guess: give one of them")
    cycle, outcome = find_cycle(
        system,
        values,
        state,
        guess=guess is not None,
        periods=periods,
        t_settle=t_settle,
    )
    return dataset(system, cycle, outcome, values, periods)


def given(
    system: System, start: Mapping[str, Any] | None, parameters: Mapping[str, Any]
) -> tuple[dict[str, float], Vector]:
    """Parameters and the start of a call, checked."""
    found = {
        n: runs.scalar(n, v)
        for n, v in runs.call_values(system, start, parameters).items()
    }
    if len(system.traced.variables) > system.traced.size and system.period is None:
        raise ValueError(
            f"{system.name} depends on the time but has no period; give `period`"
        )
    return {n: found[n] for n in system.parameters}, np.array(
        [found[n] for n in system.states]
    )


def columns(cycle: Cycle | None, system: System) -> dict[str, Any]:
    """The numbers of one cycle, over no dimension but ``multiplier``."""
    names = (*system.states, *system.outputs)
    n = system.traced.size
    if cycle is None:
        bare = {"period": np.nan, "residual": np.nan, "stable": 0}
        bare |= {f"{name}{end}": np.nan for name in names for end in ("_min", "_max")}
        return bare | dict.fromkeys(
            ("multiplier_real", "multiplier_imag"), np.full(n, np.nan)
        )
    found: dict[str, Any] = {"period": cycle.period, "residual": cycle.residual}
    for name, (low, high) in zip(names, cycle.extremes.T, strict=True):
        found |= {f"{name}_min": low, f"{name}_max": high}
    found["stable"] = int(cycle.is_stable)
    multipliers = cycle.multipliers
    return found | {
        "multiplier_real": multipliers.real,
        "multiplier_imag": multipliers.imag,
    }


def described(name: str, system: System) -> dict[str, str]:
    """long_name and units of a number of a cycle."""
    units = {**system.units, **{n: unit for n, (unit, _) in system.outputs.items()}}
    for end, word in (("_min", "smallest"), ("_max", "largest")):
        if name.endswith(end) and name.removesuffix(end) in units:
            short = name.removesuffix(end)
            return {
                "long_name": f"{word} {short} over the period",
                "units": units[short],
            }
    return {
        "period": {"long_name": "period", "units": "s"},
        "residual": {
            "long_name": "largest equation left over, without units",
            "units": "1",
        },
        "multiplier_real": {
            "long_name": "real part of the Floquet multipliers",
            "units": "1",
        },
        "multiplier_imag": {
            "long_name": "imaginary part of the Floquet multipliers",
            "units": "1",
        },
    }[name]


def outcome_of(system: System, dims: Any, values: Any) -> Any:
    """How a cycle was found, with the system's own stops and motions of more periods."""
    table = flag_table(Outcome) | {
        STOPPED + i: name for i, name in enumerate(system.stops)
    }
    more = np.unique(np.asarray(values)[np.asarray(values) > SETTLED_ON])
    table |= {int(k): f"settled_on_{int(k) - SETTLED_ON}_periods" for k in more}
    dims, values, attributes = runs.flag("how the cycle was found", dims, values, table)
    return dims, values, attributes | {"comment": in_words(table)}


def describe_columns(
    system: System, rows: Sequence[Mapping[str, Any]], dim: str | None = None
) -> dict[str, Any]:
    """Numbers of some cycles as variables, over a dimension if there is one."""
    found: dict[str, Any] = {}
    over = (dim,) if dim else ()
    for name, bare in (rows[0] if rows else columns(None, system)).items():
        stacked = np.array([row[name] for row in rows]).reshape(-1, *np.shape(bare))
        values = stacked if dim else stacked[0]
        if name == "stable":
            table = {0: "no", 1: "yes"}
            found[name] = runs.flag(
                "whether small disturbances decay", over, values, table
            )
        else:
            dims = (*over, "multiplier") if np.ndim(bare) else over
            found[name] = dims, values, described(name, system)
    return found


def dataset(
    system: System,
    cycle: Cycle | None,
    outcome: int,
    values: Mapping[str, float],
    periods: int,
) -> xr.Dataset:
    """A cycle, or the reason why there is none, as a dataset."""
    found = describe_columns(system, [columns(cycle, system)])
    number = outcome - SETTLED_ON if outcome > SETTLED_ON else periods
    label = runs.labels("forcing periods, or returns to the section", "1")
    found["periods"] = ((), number, label)
    times, order = np.empty(0), []
    instants, path, regime = np.empty(0), np.empty((0, len(system.states))), 0
    if cycle is not None:
        ends = (cycle.clocks + cycle.parts.durations - cycle.phase) % cycle.period
        order = [i for i in np.argsort(ends) if cycle.map.events[i].switch != FREE]
        times = ends[order]
        instants = cycle.instants
        path, _ = cycle.states_at((cycle.phase + instants) % cycle.period)
        regime = cycle.start()[1]
    chosen = [cycle.map.events[i] for i in order] if cycle else []
    states = np.array([cycle.parts.crossings[i].after for i in order] if cycle else [])
    states = states.reshape(-1, len(system.states))
    kinds, names = dict(enumerate(system.traced.kinds)), dict(enumerate(system.regimes))
    joint = system.joint
    found["event_time"] = ("event", times, runs.labels("time of the event", "s"))
    found["event_kind"] = runs.flag(
        "kind of the event", "event", [e.kind for e in chosen], kinds
    )
    found["event_regime"] = runs.flag(
        "regime entered",
        "event",
        [joint.entered_by(e.after, e.switch) for e in chosen],
        names,
    )
    for i, name in enumerate(system.states):
        unit = system.units[name]
        found[f"event_{name}"] = (
            "event",
            states[:, i],
            runs.labels(f"{name} after it", unit),
        )
        found[f"{name}_path"] = (
            "sample",
            path[:, i],
            runs.labels(f"{name} along the cycle", unit),
        )
        first = path[0, i] if len(path) else np.nan
        found[f"{name}_start"] = (
            (),
            first,
            runs.labels(f"{name} at t = 0 of the cycle", unit),
        )
    found["start_regime"] = runs.regime_flag(
        system, "regime at t = 0 of the cycle", (), np.array(joint.regimes(regime))
    )
    found["time"] = ("sample", instants, runs.labels("time", "s"))
    found["outcome"] = outcome_of(system, (), outcome)
    return xr.Dataset(
        found,
        runs.components_of(system),
        runs.attributes(system, "limit cycle", values, 1e-14),
    )
