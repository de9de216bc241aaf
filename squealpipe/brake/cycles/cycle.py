"""One periodic motion of model A1, from a settled run or a guess."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import xarray as xr

from squealpipe.brake.a1.jobs import STATE
from squealpipe.brake.cycles.scene import CycleScene
from squealpipe.brake.schema.cycles import A1_LIMIT_CYCLE
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, blank, build
from squealpipe.schema.origin import recorded
from squealpipe.systems.cycles.event_map import FREE
from squealpipe.systems.cycles.find import find_cycle
from squealpipe.systems.cycles.solution import Cycle
from squealpipe.systems.integrate import MOST_STEPS
from squealpipe.systems.taylor.layout import STOPPED
from squealpipe.validation import Angle, Natural, Positive, State, one_of

T_SETTLE = 2000.0
"""Default time, in units of √(m/min(k1, k2)), after which a run counts as settled."""


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
    scene = CycleScene(params, alpha1, alpha2)
    cycle, outcome = cycle_from(scene, guess, t_settle, max_steps)
    found = (
        blank(A1_LIMIT_CYCLE, multiplier=4)
        if cycle is None
        else _described(scene, cycle)
    )
    angles = {"alpha1": alpha1, "alpha2": alpha2}
    multiplier = {"multiplier": np.arange(1, 5)}
    return build(A1_LIMIT_CYCLE, {**found, **angles, "outcome": outcome}, multiplier)


def cycle_from(
    scene: CycleScene,
    guess: Any = None,
    t_settle: float | None = None,
    most_steps: int = MOST_STEPS,
) -> tuple[Cycle | None, Outcome]:
    """A cycle near a state, or from a run from rest (without a guess), and its outcome."""
    state = (
        np.zeros(4) if guess is None else np.asarray(guess, float) / scene.state_units
    )
    settle = T_SETTLE * scene.slow_time
    cycle, outcome = find_cycle(
        scene.system,
        scene.values,
        state,
        guess=guess is not None,
        periods=0,
        t_settle=settle if t_settle is None else t_settle / scene.params.time_unit,
        unit=scene.slow_time,
        most_steps=most_steps,
    )
    if outcome == Outcome.not_finite and scene.is_singular(state[:2]):
        outcome = Outcome.singular_geometry
    return cycle, Outcome.singular_geometry if outcome >= STOPPED else Outcome(outcome)


def _described(scene: CycleScene, cycle: Cycle) -> dict[str, Any]:
    """The variables of a cycle."""
    units, clock = scene.state_units, scene.params.time_unit
    start = cycle.start()[0] * units
    times = cycle.instants
    path, regimes = cycle.states_at((cycle.phase + times) % cycle.period)
    ends = (cycle.clocks + cycle.parts.durations - cycle.phase) % cycle.period
    order = [
        i
        for i in np.argsort(ends)
        if cycle.map.events[i].switch != FREE
        and scene.kinds[cycle.map.events[i].kind] is not None
    ]
    states = (
        np.array([cycle.parts.crossings[i].after for i in order]).reshape(-1, 4) * units
    )
    return {
        **scene.numbers(cycle),
        "event_time": ends[order] * clock,
        "event_kind": [scene.kinds[cycle.map.events[i].kind] for i in order],
        **{f"event_{name}": states[:, i] for i, name in enumerate(STATE)},
        **{f"{name}_start": start[i] for i, name in enumerate(STATE)},
        "time": times * clock,
        **{f"{name}_path": path[:, i] * units[i] for i, name in enumerate(STATE)},
        "regime_path": [scene.regimes[regime] for regime in regimes],
    }
