"""Moreau–Jean time stepping with a fixed step: a public method without event location.

Acary and Brogliato (2008), Numerical Methods for Nonsmooth Dynamical Systems, section 10.1: the
forces are taken at the midpoint of the step, and Coulomb friction enters as an impulse within
its bound, found implicitly from the velocity at the end. Stick is exact; the instants of contact
and of the friction's reversal are known to a step only, so errors fall with the step at first
order at best.
"""

from __future__ import annotations

import types
from collections.abc import Callable
from functools import cache
from typing import Any

import numba
import numpy as np


@cache
def jitted(function: Callable[..., Any]) -> Any:
    """Compile a plain function together with the plain functions of the package that it calls.

    Laws and models stay ordinary Python, stated once, and still run inside a compiled loop.
    """
    names = function.__code__.co_names
    called = {name: function.__globals__[name] for name in names if name in function.__globals__}
    replaced = {
        name: jitted(value)
        for name, value in called.items()
        if isinstance(value, types.FunctionType) and value.__module__.startswith("squealpipe.")
    }
    scope = {**function.__globals__, **replaced}
    copy = types.FunctionType(function.__code__, scope, function.__name__, function.__defaults__)
    return numba.njit(copy)


@numba.njit
def step_through(
    forces: Any, data: Any, mass: float, speed: float, state: np.ndarray, step: float, n_steps: int,
    stop_at_switch: bool,
) -> tuple[int, int]:  # fmt: skip
    """Advance ``state`` in place by ``n_steps`` steps.

    Args:
        forces: compiled (x, y, data) → (smooth x-force, smooth y-force, friction bound μN), N.
        data: what ``forces`` needs, passed through.
        mass: kg; speed: that of the surface, m/s.
        state: (x, y, ẋ, ẏ).
        step: s; n_steps: how many of them.
        stop_at_switch: end after the first change of contact.

    Returns:
        How often the friction bound went from or to zero (separations and contacts), and the
        steps that were made.
    """
    x, y, vx, vy = state[0], state[1], state[2], state[3]
    touching = forces(x, y, data)[2] > 0.0
    switches, made = 0, 0
    for _ in range(n_steps):
        made += 1
        x += 0.5 * step * vx
        y += 0.5 * step * vy
        fx, fy, bound = forces(x, y, data)
        vx += step * fx / mass
        vy += step * fy / mass
        impulse = mass * (speed - vx)
        vx += min(max(impulse, -bound * step), bound * step) / mass
        x += 0.5 * step * vx
        y += 0.5 * step * vy
        if (bound > 0.0) != touching:
            touching = not touching
            switches += 1
            if stop_at_switch:
                break
    state[0], state[1], state[2], state[3] = x, y, vx, vy
    return switches, made
