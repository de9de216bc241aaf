"""One Taylor step of all lanes: its length, its end, and where an event or the run's end cuts it.

``base`` is the address of the series of :func:`squealpipe.methods.taylor.series.series_source`,
``c`` the same as an array [series, order, lane]; compiled.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from squealpipe.methods.compiled import inline, part
from squealpipe.methods.taylor.roots import first_root
from squealpipe.methods.taylor.simd import (
    LANES,
    ROW,
    bits_below,
    fma,
    larger,
    load,
    magnitude,
    rough_power,
    smaller,
    splat,
    store,
)
from squealpipe.methods.taylor.taylor_polynomial import evaluate_state, evaluate_with_slope
from squealpipe.solvers.a1.records import AT, CODES, RUNNING, SUSPECT_PIVOT2
from squealpipe.solvers.a1.system import STATE

N_STATE = len(STATE)
N_EVENTS = 3
ALL = (1 << LANES) - 1
AT_STATE = tuple(getattr(AT, name) for name in STATE)


@inline
def _step_length(base: int, terms: int) -> Any:
    """Lengths of the next steps from the last two orders (Jorba and Zou 2005; Biscani 2021)."""
    size, last, previous = splat(1.0), splat(1e-300), splat(1e-300)
    for variable in range(N_STATE):
        series = base + variable * terms * ROW
        size = larger(magnitude(load(series)), size)
        last = larger(magnitude(load(series + (terms - 1) * ROW)), last)
        previous = larger(magnitude(load(series + (terms - 2) * ROW)), previous)
    order = terms - 1.0
    reach = smaller(
        rough_power(size / last, splat(1.0 / order)),
        rough_power(size / previous, splat(1.0 / (order - 1.0))),
    )
    return reach * math.exp(-2.0 - 0.7 / (order - 1.0))


@inline
def _at_end(series: int, terms: int, step: Any) -> Any:
    """A series' value at the end of its step."""
    value = load(series + (terms - 1) * ROW)
    for k in range(terms - 2, -1, -1):
        value = fma(value, step, load(series + k * ROW))
    return value


@inline
def _slope_at_end(series: int, terms: int, step: Any) -> Any:
    """Its rate there."""
    slope = load(series + (terms - 1) * ROW) * (terms - 1.0)
    for k in range(terms - 2, 0, -1):
        slope = fma(slope, step, load(series + k * ROW) * splat(k * 1.0))
    return slope


@inline
def _free_of_events(base: int, terms: int, step: Any) -> Any:
    """Lanes in which no event function has a root: both ends are further from zero than it bends.

    A function with |p''| <= M lies within M h^2/8 of the chord of its ends.
    """
    free = ALL
    for event in range(N_STATE, N_STATE + N_EVENTS):
        series = base + event * terms * ROW
        value, bend = load(series + (terms - 1) * ROW), splat(0.0)
        for k in range(terms - 1, 1, -1):
            row = load(series + k * ROW)
            bend = fma(bend, step, magnitude(row) * splat(k * (k - 1.0)))
        value = _at_end(series, terms, step)
        first = load(series)
        free &= bits_below(splat(0.0), first * value)
        nearest = smaller(magnitude(first), magnitude(value))
        free &= bits_below(bend * step * step * 0.125, nearest)
    return free


@inline
def take_step(at: int, base: int, terms: int) -> Any:
    """Ends of all lanes' steps; returns the lanes that need a look of their own."""
    step = smaller(_step_length(base, terms), load(at + AT.longest_step))
    store(at + AT.step, step)
    lost = step
    store(at + AT.ax, _slope_at_end(base + 2 * terms * ROW, terms, step))
    for variable in range(N_STATE):
        value = _at_end(base + variable * terms * ROW, terms, step)
        store(at + AT_STATE[variable], value)
        lost = lost + value * 0.0
    plain = _free_of_events(base, terms, step) & bits_below(magnitude(lost), splat(np.inf))
    return ~plain | reaches(at, AT.t_end)


@inline
def reaches(at: int, instant: int) -> Any:
    """Lanes whose step does not end before the instant in a row."""
    clock, correction = load(at + AT.clock), load(at + AT.correction)
    return ~bits_below(load(at + AT.step), (load(at + instant) - clock) - correction)


@part
def end_of_step(lanes: Any, c: Any, lane: int) -> Any:
    """Cut a step at its first event or at the end of the run; returns an outcome or RUNNING."""
    total = lanes.step[lane]
    for value in (lanes.x[lane], lanes.y[lane], lanes.vx[lane], lanes.vy[lane]):
        total += 0.0 * value
    if not math.isfinite(total):
        lanes.step[lane] = 0.0
        _set_end(lanes, c, lane)
        if lanes.nearest_pivot2[lane] < SUSPECT_PIVOT2:
            return CODES.singular_geometry
        return CODES.not_finite
    remaining = (lanes.t_end[lane] - lanes.clock[lane]) - lanes.correction[lane]
    step = min(lanes.step[lane], remaining)
    ends = remaining <= lanes.step[lane]
    for event in range(N_STATE, N_STATE + N_EVENTS):
        root = first_root(c, event, lane, step)
        if 0.0 <= root < step:
            step, ends = root, False
    if step != lanes.step[lane]:
        lanes.step[lane] = step
        _set_end(lanes, c, lane)
    return CODES.converged if ends else RUNNING


@part
def _set_end(lanes: Any, c: Any, lane: int) -> None:
    """The state at the end of a lane's step, from its polynomials."""
    x, y, vx, vy = evaluate_state(c, lane, lanes.step[lane])
    lanes.x[lane], lanes.y[lane], lanes.vx[lane], lanes.vy[lane] = x, y, vx, vy
    _, lanes.ax[lane] = evaluate_with_slope(c, 2, lane, lanes.step[lane])
