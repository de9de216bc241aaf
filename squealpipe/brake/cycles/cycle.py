"""One periodic motion of model A1, from a settled run or a guess."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Annotated, Any

import numpy as np
import xarray as xr

from squealpipe.brake.a1.ensemble import NEAR_PIVOT
from squealpipe.brake.a1.jobs import STATE
from squealpipe.brake.a1.motion_system import brake_of, parameters_of_run, regimes_of
from squealpipe.brake.assess.sliding import Design
from squealpipe.brake.schema.cycles import a1_limit_cycle_schema
from squealpipe.codes import Event, Regime
from squealpipe.laws.springs import fixed_ends, geometry
from squealpipe.parameters import NUMBERS_OF_A1, Parameters
from squealpipe.schema import Outcome, blank, build
from squealpipe.schema.origin import recorded
from squealpipe.systems.cycles.described import columns
from squealpipe.systems.cycles.event_map import FREE
from squealpipe.systems.cycles.find import find_cycle
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.integrate import MOST_STEPS
from squealpipe.systems.taylor.layout import outcomes
from squealpipe.validation import Angle, Natural, Positive, State, one_of

IN_SYSTEM = {of: name for name, of in NUMBERS_OF_A1.items()} | {
    angle: angle for angle in ("alpha1", "alpha2")
}
"""Parameter or angle → its name in the system."""


@recorded(method="Newton on the legs between located events")
def limit_cycle(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    model: Annotated[str, one_of(["A1"])] = "A1",  # noqa: ARG001 (in the record)
    guess: State | None = None,
    t_settle: Positive | None = None,
    max_steps: Natural = MOST_STEPS,
) -> xr.Dataset:
    """A periodic motion of A1 with every event located, its stability included.

    Newton's method on the legs between events, with exact derivatives. Without damping cycles come
    in families: the member nearest to the guess is returned with the outcome ``family_member``.
    A :class:`squealpipe.System`, one of your own too, has a method of this name: its keywords are
    ``start``, ``guess``, ``periods``, ``t_settle``, ``max_steps`` and the system's parameters.

    Args:
        alpha1, alpha2: angles, rad.
        guess: state (x, y, ẋ, ẏ) in m and m/s near the cycle, which may be unstable. Without it,
            the state that a run from rest has reached at ``t_settle``.
        t_settle: s; default 2000 √(m/min(k1, k2)).
        max_steps: steps of the integrator in a run, after which the outcome is ``step_limit``.

    Returns:
        Dataset with period (s), extrema (m), fractions in contact and stick, Floquet multipliers
        (the trivial one first), events, and the motion at 401 instants. NaN with the reason in
        ``outcome`` where no cycle is found.
    """
    design = Design(params, alpha1, alpha2)
    cycle, outcome = cycle_from(design, guess, t_settle, max_steps)
    solution = (
        blank(a1_limit_cycle_schema, multiplier=4)
        if cycle is None
        else _described(cycle)
    )
    angles = {"alpha1": alpha1, "alpha2": alpha2}
    multiplier = {"multiplier": np.arange(1, 5)}
    return build(
        a1_limit_cycle_schema, {**solution, **angles, "outcome": outcome}, multiplier
    )


def cycle_from(
    design: Design,
    guess: Any = None,
    t_settle: float | None = None,
    most_steps: int = MOST_STEPS,
    varied: Sequence[str] = (),
) -> tuple[Cycle | None, Outcome]:
    """Return a cycle near a state, or from a run from rest (without a guess), and its outcome.

    Args:
        varied: parameters in which the cycle will be followed.
    """
    params = design.params
    state = np.zeros(4) if guess is None else np.asarray(guess, float)
    # motions of the softer spring settle last, whichever it is
    slow_time = float((params.mass / min(params.k1, params.k2)) ** 0.5)
    values = parameters_of_run(params, design.alpha1, design.alpha2)
    cycle, outcome = find_cycle(
        brake_of(params, varied=varied),
        values,
        state,
        guess=guess is not None,
        periods=0,
        t_settle=2000.0 * slow_time if t_settle is None else t_settle,
        unit=slow_time,
        most_steps=most_steps,
    )
    if outcome == Outcome.not_finite and is_next_to_pivot(values, state[:2]):
        outcome = Outcome.singular_geometry
    return cycle, Outcome.singular_geometry if outcome >= outcomes.stopped else Outcome(
        outcome
    )


def is_next_to_pivot(values: Mapping[str, float], places: np.ndarray) -> bool:
    """Return whether one of some places (…, 2), m, is next to a pivot, where d = 0.

    Args:
        values: parameters of the system.
    """
    p = SimpleNamespace(**values)
    x1, y1, x2, y2 = fixed_ends(p, geometry(p.alpha1, p.alpha2))
    return any(
        bool((np.hypot(*(places - [x, y]).T) < NEAR_PIVOT * length).any())
        for x, y, length in ((x1, y1, p.length1), (x2, y2, p.length2))
    )


def event_kinds(cycle: Cycle) -> list[Event | None]:
    """Return A1's kind of each leg's end; None of a law's knots and of a section."""
    names = cycle.map.flow.system.traced.kinds
    return [
        None if event.switch == FREE else Event.__members__.get(names[event.kind])
        for event in cycle.map.events
    ]


def n_events(cycle: Cycle) -> int:
    """Return the number of A1's events of a cycle."""
    return sum(kind is not None for kind in event_kinds(cycle))


def start_of(cycle: Cycle) -> np.ndarray:
    """Return the state of a cycle at t = 0, m and m/s."""
    return np.asarray(cycle.start()[0] * cycle.map.flow.scale_of(*STATE))


def numbers(cycle: Cycle) -> dict[str, Any]:
    """Return the scalars of a cycle's dataset, and the multipliers."""
    regimes = regimes_of(cycle.map.flow.system)
    during = np.array([regimes[event.before] for event in cycle.map.events])
    share = {
        regime: float(cycle.parts.durations[during == regime].sum()) / cycle.period
        for regime in (Regime.separated, Regime.stick)
    }
    known = columns(cycle, cycle.map.flow.system)
    names = ["period", "x_min", "x_max", "y_min", "y_max"]
    names += ["stable", "multiplier_real", "multiplier_imag"]
    return {
        **{name: known[name] for name in names},
        "contact_fraction": 1.0 - share[Regime.separated],
        "stick_fraction": share[Regime.stick],
        "least_contact_force": max(known["contact_force_min"], 0.0),
        "residual": cycle.closing_error,
    }


def _described(cycle: Cycle) -> dict[str, Any]:
    """Return the variables of a cycle."""
    units, second = cycle.map.flow.scale_of(*STATE), cycle.second
    start, times = start_of(cycle), cycle.instants
    path, path_regimes = cycle.states_at((cycle.phase + times) % cycle.period)
    regimes, kinds = regimes_of(cycle.map.flow.system), event_kinds(cycle)
    ends = (cycle.clocks + cycle.parts.durations - cycle.phase) % cycle.period
    order = [i for i in np.argsort(ends) if kinds[i] is not None]
    states = np.array([cycle.parts.crossings[i].after for i in order]).reshape(-1, 4)
    return {
        **numbers(cycle),
        "event_time": ends[order] * second,
        "event_kind": [kinds[i] for i in order],
        **{f"event_{name}": states[:, i] * units[i] for i, name in enumerate(STATE)},
        **{f"{name}_start": start[i] for i, name in enumerate(STATE)},
        "time": times * second,
        **{f"{name}_path": path[:, i] * units[i] for i, name in enumerate(STATE)},
        "regime_path": [regimes[regime] for regime in path_regimes],
    }
