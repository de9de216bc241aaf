"""How a job enters a lane, and how a regime is written into the integrator's parameters; compiled.

All quantities are in units of m = k1 = l_pre = 1.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import literal_unroll

from squealpipe.laws import contact, dashpots, friction, springs
from squealpipe.methods.compiled import also_compiled, part
from squealpipe.models import switching
from squealpipe.solvers.a1.observers import limit_growth
from squealpipe.solvers.a1.records import (
    MARKS,
    OBSERVED,
    PIVOT_REACH2,
    SEPARATED,
    STICK,
    TANGENT,
    TANGENT_NORM,
)
from squealpipe.solvers.a1.system import EXTENSIONS, PHYSICAL

TAKEN = (
    *PHYSICAL,
    *EXTENSIONS,
    "t_end",
    "t_late",
    "stop_at_x",
    "stop_at_turns",
    "max_steps",
    "lost_growth",
)
"""What a lane takes over from its order."""
CLEARED = ("clock", "correction", "steps", "half_turns1", "half_turns2", *OBSERVED)

for law in (
    springs.fixed_ends,
    springs.squared_distance,
    springs.spring_force,
    springs.long_spring_force,
    springs.elastic_force,
    springs.inclined_pair,
    springs.linear_stiffness,
    springs.linear_elastic_force,
    springs.spring_x_slopes,
    springs.elastic_x_slopes,
    dashpots.dashpot_force,
    dashpots.dashpot_x_slopes,
    dashpots.damping_force,
    dashpots.damping_x_slopes,
    dashpots.linear_damping,
    dashpots.linear_damping_force,
    contact.contact_force,
    friction.stick_limit,
    *switching.COMPILED,
):
    also_compiled(law)


@part
def set_regime(lanes: Any, order: Any, lane: int, regime: int) -> None:
    """Write a regime into the lane's parameters (see ``solvers.a1.system.REGIME``)."""
    slipping = regime not in (SEPARATED, STICK)
    lanes.contact[lane] = 0.0 if regime == SEPARATED else 1.0
    lanes.direction[lane] = 0.0 if not slipping else (1.0 if regime == 0 else -1.0)
    lanes.stick[lane] = 1.0 if regime == STICK else 0.0
    # The surface y = 1, or none.
    lanes.gap_weight[lane], lanes.gap_offset[lane] = order.separates, 1.0 - 2.0 * order.separates
    # The surface ẋ = V; none in the air; in stick the surfaces of release alone.
    weight, offset = 0.0, 0.0 if regime == STICK else 1.0
    if slipping and order.reverses > 0.0:
        weight, offset = 1.0, -order.belt_speed
    lanes.speed_weight[lane], lanes.speed_offset[lane] = weight, offset


@part
def start_job(lanes: Any, c: Any, order: Any, result: Any, initial: Any, lane: int) -> None:
    """Start a job in a lane."""
    x, vy = initial[0], initial[3]
    regime, y, vx = switching.start(x, initial[1], initial[2], vy, order, order, order)
    for name in literal_unroll(TAKEN):
        lanes[name][lane] = order[name]
    set_regime(lanes, order, lane, regime)
    c[0, 0, lane], c[1, 0, lane], c[2, 0, lane], c[3, 0, lane] = x, y, vx, vy
    for name in literal_unroll(CLEARED):
        lanes[name][lane] = 0.0
    for name in literal_unroll(TANGENT):
        lanes[name][lane] = 0.5 * TANGENT_NORM
    lanes.sample[lane] = 0
    x1, y1, x2, y2 = springs.fixed_ends(order, order)
    lanes.pivot_x1[lane], lanes.pivot_y1[lane] = x1, y1
    lanes.pivot_x2[lane], lanes.pivot_y2[lane] = x2, y2
    # quotients, as the power −2 raises where its square vanishes
    lanes.scale1[lane] = 1.0 / (order.length1 * order.length1)
    lanes.scale2[lane] = 1.0 / (order.length2 * order.length2)
    lanes.reach2[lane] = -1.0 if order.linear_springs > 0.0 else PIVOT_REACH2
    lanes.lowest_y[lane] = np.inf if regime == SEPARATED else y
    lanes.highest_y[lane] = -np.inf if regime == SEPARATED else y
    lanes.largest_r2[lane] = x * x + y * y
    lanes.early_largest_x[lane] = abs(x)
    lanes.largest_speed[lane] = vx
    lanes.early_largest_vx[lane] = abs(vx)
    lanes.next_mark[lane] = MARKS[0] * order.t_end
    lanes.nearest_pivot2[lane] = min(
        springs.squared_distance(x, y, x1, y1) / order.length1**2,
        springs.squared_distance(x, y, x2, y2) / order.length2**2,
    )
    result.lowest_y, result.impact_speed = np.inf, np.nan
    result.first_separation = 0.0 if regime == SEPARATED else np.nan
    result.log_growth, result.horizon = 0.0, np.nan
    result.regime = regime
    result.late_events = result.events = 0
    result.kinds[:] = 0
    result.marks = 0
    result.mark_separated_time[:] = np.nan
    result.mark_state[:] = np.nan
    limit_growth(lanes, result, lane)
