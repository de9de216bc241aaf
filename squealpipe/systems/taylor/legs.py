"""Taylor series along legs of given length in one regime each, every step kept; compiled.

Nothing is watched here: a leg may run on beyond a surface, or backwards by as much as one step,
so that what solves for a sequence of events is smooth.
"""

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from squealpipe.systems.compiled import part
from squealpipe.systems.taylor.lanes import (
    address_of,
    call,
    compile_advance,
    record_viewer,
    view,
)
from squealpipe.systems.taylor.roots import evaluate
from squealpipe.systems.taylor.simd import FEW, LANES, ROW, smaller, splat, store
from squealpipe.systems.taylor.step import reach, step_length

FIRST_PARAMETER = 3
"""The row of the first parameter, after those of the steps that ``shorten`` reads and writes."""
LEG_ARRAYS = (
    "rows",
    "series",
    "inverses",
    "units",
    "bent",
    "constants",
    "initial",
    "starts",
    "durations",
    "kept",
    "steps",
    "counts",
    "lanes",
)
LEG_SIZES = (
    "n_terms",
    "n_legs",
    "n_states",
    "n_variables",
    "n_kept",
    "n_parameters",
    "n_constants",
    "n_series",
    "n_steps",
    "take_step",
    "shorten",
)
LEG_TABLE = np.dtype([(name, "i8") for name in (*LEG_ARRAYS, *LEG_SIZES)])
_record_at: Any = record_viewer(LEG_TABLE)


class _Memory(NamedTuple):
    """Arrays of a run; ``clocks`` and ``lanes`` are of the legs that are under way."""

    rows: Any
    c: Any
    constants: Any
    initial: Any
    starts: Any
    durations: Any
    kept: Any
    steps: Any
    counts: Any
    lanes: Any
    clocks: Any


@part
def _begin(t: Any, m: Any, lane: int, leg: int, unit: float) -> None:
    """Put a leg into a lane."""
    m.lanes[lane], m.clocks[lane], m.counts[leg] = leg, 0.0, 0
    m.c[: t.n_variables, :, lane] = 0.0
    for variable in range(t.n_states):
        m.c[variable, 0, lane] = m.initial[leg, variable]
    if t.n_variables > t.n_states:
        m.c[t.n_states, 0, lane] = m.starts[leg] * unit
    m.rows[1, lane] = abs(m.durations[leg])
    first = FIRST_PARAMETER + t.n_parameters
    for constant in range(t.n_constants):
        m.rows[first + constant, lane] = m.constants[leg, constant]


@part
def _keep(t: Any, m: Any, lane: int, unit: float) -> bool:
    """Keep a lane's step and go to its end; returns whether that is the end of its leg."""
    leg = m.lanes[lane]
    step = m.rows[0, lane]
    left = m.durations[leg] - m.clocks[lane]
    place = m.counts[leg]
    ends = not abs(left) > step
    step = left if ends else math.copysign(step, left)
    m.counts[leg] = place + 1
    if place >= t.n_steps:
        return True
    m.steps[leg, place] = step
    for k in range(t.n_kept):
        for order in range(t.n_terms):
            m.kept[leg, place, k, order] = m.c[k, order, lane]
    m.clocks[lane] += step
    for variable in range(t.n_states):
        m.c[variable, 0, lane] = evaluate(m.c, variable, lane, step)
    if t.n_variables > t.n_states:
        m.c[t.n_states, 0, lane] = (m.starts[leg] + m.clocks[lane]) * unit
    return ends


@part
def _longest(m: Any) -> float:
    """The most that is left of a leg."""
    most = 0.0
    for lane in range(FEW):
        if m.lanes[lane] >= 0:
            most = max(most, abs(m.durations[m.lanes[lane]] - m.clocks[lane]))
    return most


def _advance(table: Any) -> int:
    """Run all legs, four side by side; returns 0. ``counts`` may be beyond the room for steps."""
    t = _record_at(address_of(table))
    n, terms = t.n_states, t.n_terms
    m = _Memory(
        rows=view(
            t.rows,
            (FIRST_PARAMETER + t.n_parameters + t.n_constants, LANES),
            np.float64,
        ),
        c=view(t.series, (t.n_series, terms, LANES), np.float64),
        constants=view(t.constants, (t.n_legs, t.n_constants), np.float64),
        initial=view(t.initial, (t.n_legs, n), np.float64),
        starts=view(t.starts, (t.n_legs,), np.float64),
        durations=view(t.durations, (t.n_legs,), np.float64),
        kept=view(t.kept, (t.n_legs, t.n_steps, t.n_kept, terms), np.float64),
        steps=view(t.steps, (t.n_legs, t.n_steps), np.float64),
        counts=view(t.counts, (t.n_legs,), np.int64),
        lanes=view(t.lanes, (FEW,), np.int64),
        clocks=view(t.lanes + 8 * FEW, (FEW,), np.float64),
    )
    bent = view(t.bent, (t.n_kept - t.n_variables,), np.int64)
    unit = m.rows[FIRST_PARAMETER + t.n_parameters - 1, 0]
    parameters = t.rows + FIRST_PARAMETER * ROW
    m.lanes[:] = -1
    following, busy = 0, 0
    while True:
        for lane in range(FEW):
            if m.lanes[lane] < 0 and following < t.n_legs:
                _begin(t, m, lane, following, unit)
                following += 1
                busy += 1
        if busy == 0:
            return 0
        call(t.take_step, (t.series, parameters, t.inverses, terms))
        length = step_length(t.series, terms, n, t.units)
        for event in range(t.n_kept - t.n_variables):
            if bent[event] or t.n_variables > n:
                series = t.series + (t.n_variables + event) * terms * ROW
                length = smaller(length, reach(series, terms))
        store(t.rows, smaller(length, splat(_longest(m))))
        if t.shorten:
            call(t.shorten, (t.series, parameters, t.rows, terms))
        for lane in range(FEW):
            if m.lanes[lane] >= 0 and _keep(t, m, lane, unit):
                m.lanes[lane] = -1
                busy -= 1


@cache
def run_legs() -> Any:
    """The compiled loop, built once a process."""
    return compile_advance(_advance)
