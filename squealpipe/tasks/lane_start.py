"""How a job enters a lane, and how a regime is written into the integrator's parameters; compiled.

All quantities are in units of m = k1 = l_pre = 1.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba.extending import register_jitable

from squealpipe.laws import contact, springs
from squealpipe.methods.lanes import PART_OPTIONS, part
from squealpipe.models import switching
from squealpipe.models.switching import Rules, ScaledParameters
from squealpipe.tasks.lane_layout import (
    BELT_SPEED,
    C1,
    C2,
    CLOCK,
    CONTACT,
    CORRECTION,
    COUNT,
    DIRECTION,
    EARLY_LARGEST_X,
    FIRST_SEPARATION,
    GAP_OFFSET,
    GAP_WEIGHT,
    HIGHEST_Y,
    HORIZON,
    K2,
    K3,
    LARGEST_R2,
    LARGEST_SPEED,
    LENGTH1,
    LENGTH2,
    LINEAR_SPRINGS,
    LOWEST_Y,
    MU,
    N_INTEGERS,
    N_MEMORY,
    N_PHYSICAL,
    NEAREST_PIVOT2,
    NEXT_SAMPLE,
    ORDER,
    PIVOTS,
    REGIME,
    RESULT,
    REVERSES,
    S1,
    S2,
    SEPARATED,
    SEPARATES,
    SPEED_OFFSET,
    SPEED_WEIGHT,
    STICK,
    STICKS,
    STICKS_NOW,
    TANGENT_NORM,
)

for law in (
    springs.fixed_ends,
    springs.squared_distance,
    springs.spring_force,
    springs.elastic_force,
    springs.linear_stiffness,
    springs.linear_elastic_force,
    contact.contact_force,
    *switching.COMPILED,
):
    register_jitable(**PART_OPTIONS)(law)


@part
def lane_parameters(memory: Any, lane: int) -> Any:
    """What the laws and the switching rules need, from the order in a lane's memory."""
    m = memory[lane, ORDER:]
    p = ScaledParameters(1.0, 1.0, m[K2], m[K3], m[MU], m[BELT_SPEED], 1.0, m[LENGTH1], m[LENGTH2])
    rules = Rules(m[SEPARATES] > 0.0, m[REVERSES] > 0.0, m[STICKS] > 0.0, m[LINEAR_SPRINGS] > 0.0)
    return p, springs.Geometry(m[C1], m[S1], m[C2], m[S2]), rules


@part
def set_regime(pars: Any, memory: Any, lane: int, regime: int) -> None:
    """Write a regime into the lane's parameters (see ``tasks.a1_system.REGIME``)."""
    slipping = regime not in (SEPARATED, STICK)
    pars[CONTACT, lane] = 0.0 if regime == SEPARATED else 1.0
    pars[DIRECTION, lane] = 0.0 if not slipping else (1.0 if regime == 0 else -1.0)
    pars[STICKS_NOW, lane] = 1.0 if regime == STICK else 0.0
    # The surface y = 1, or none.
    separates = memory[lane, ORDER + SEPARATES]
    pars[GAP_WEIGHT, lane], pars[GAP_OFFSET, lane] = separates, 1.0 - 2.0 * separates
    # The surface ẋ = V, scaled because the integrator's error norm includes it, and by a power of
    # two, so that a state one unit of round-off beside it stays beside it; none in the air; in
    # stick the surfaces of release alone.
    weight, offset = 0.0, 0.0 if regime == STICK else 1.0
    if slipping and memory[lane, ORDER + REVERSES] > 0.0:
        speed = memory[lane, ORDER + BELT_SPEED]
        weight = math.ldexp(1.0, -math.frexp(1.0 + abs(speed))[1])
        offset = -weight * speed
    pars[SPEED_WEIGHT, lane], pars[SPEED_OFFSET, lane] = weight, offset


@part
def load(state: Any, pars: Any, memory: Any, integers: Any, initial: Any, lane: int) -> None:
    """Start the job whose order is in the lane's memory."""
    p, g, rules = lane_parameters(memory, lane)
    x, vy = initial[0], initial[3]
    regime, y, vx = switching.start(x, initial[1], initial[2], vy, p, g, rules)
    for index in range(N_PHYSICAL):
        pars[index, lane] = memory[lane, ORDER + index]
    set_regime(pars, memory, lane, regime)
    state[0, lane], state[1, lane], state[2, lane], state[3, lane] = x, y, vx, vy
    for index in range(4, state.shape[0]):
        state[index, lane] = 0.5 * TANGENT_NORM
    m = memory[lane]
    m[CLOCK] = m[CORRECTION] = 0.0
    m[PIVOTS], m[PIVOTS + 1] = p.length1 * g.c1, p.length1 * g.s1
    m[PIVOTS + 2], m[PIVOTS + 3] = -p.length2 * g.c2, p.length2 * g.s2
    for index in range(RESULT, N_MEMORY):
        memory[lane, index] = 0.0
    m = memory[lane, RESULT:]
    m[FIRST_SEPARATION] = 0.0 if regime == SEPARATED else np.nan
    m[HORIZON] = np.nan
    m[LOWEST_Y], m[HIGHEST_Y] = (np.inf, -np.inf) if regime == SEPARATED else (y, y)
    m[LARGEST_R2] = x * x + y * y
    m[EARLY_LARGEST_X] = abs(x)
    m[LARGEST_SPEED] = vx
    nearest = min(
        ((x - p.length1 * g.c1) ** 2 + (y - p.length1 * g.s1) ** 2) / p.length1**2,
        ((x + p.length2 * g.c2) ** 2 + (y - p.length2 * g.s2) ** 2) / p.length2**2,
    )
    m[NEAREST_PIVOT2] = nearest
    for index in range(NEXT_SAMPLE, N_INTEGERS):
        integers[lane, index] = 0
    integers[lane, COUNT + REGIME] = regime


@part
def idle(state: Any, pars: Any, lane: int) -> None:
    """The state of rest in contact, again after each step: a finite step without events."""
    for variable in range(state.shape[0]):
        state[variable, lane] = 0.0
    pars[CONTACT, lane], pars[STICKS_NOW, lane] = 1.0, 0.0
    pars[GAP_WEIGHT, lane], pars[GAP_OFFSET, lane] = 0.0, 1.0
    pars[SPEED_WEIGHT, lane], pars[SPEED_OFFSET, lane] = 0.0, 1.0
