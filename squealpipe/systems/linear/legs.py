"""Taylor series of linear structures along legs of given length in one regime each; compiled.

Nothing is watched here: a leg may run on beyond a surface, or backwards by as much as one step, so
that what solves for a sequence of events is smooth. The series are those of the loop, called by
their address as there.
"""

import math
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from squealpipe.systems.compiled import inline
from squealpipe.systems.linear.loop import shorter_step, step_length
from squealpipe.systems.linear.plan import n_parameters, plan_at
from squealpipe.systems.taylor.lanes import call, compile_called, record_viewer, view
from squealpipe.systems.taylor.simd import LANES

RUN_ARRAYS = (
    "rows", "series", "units", "constants", "initial", "durations", "active", "kept", "steps",
    "counts",
)  # fmt: skip
RUN_SIZES = (
    "plan",
    "n_legs",
    "n_terms",
    "n_series",
    "n_surfaces",
    "n_room",
    "most_steps",
    "take_series",
)
RUN_TABLE = np.dtype([(name, "i8") for name in (*RUN_ARRAYS, *RUN_SIZES)])
_record_at: Any = record_viewer(RUN_TABLE)


class _Watched(NamedTuple):
    """Surfaces whose series must have converged in a step, as the loop names them."""

    active: Any


@inline
def _end_of_step(mem: Any, n_states: int, step: float) -> None:
    """Write the states at the end of a step as those of the next one's start."""
    for i in range(n_states):
        value = mem[mem.shape[0] - 1, i]
        for order in range(mem.shape[0] - 2, -1, -1):
            value = value * step + mem[order, i]
        mem[0, i] = value


def _run(address: int) -> None:
    """Run all legs; ``counts`` are the steps of each, also where there is no room to keep them.

    A leg of more than the most steps ends the run.
    """
    t = _record_at(address)
    k = plan_at(t.plan)
    n, given, constants = k.n_states, n_parameters(k), k.c * k.width
    rows = view(t.rows, (given + constants, LANES), np.float64)
    mem = view(t.series, (t.n_terms, t.n_series), np.float64)
    units = view(t.units, (n, 1), np.float64)
    of_legs = view(t.constants, (t.n_legs, constants), np.float64)
    initial = view(t.initial, (t.n_legs, n), np.float64)
    durations = view(t.durations, (t.n_legs,), np.float64)
    kept = view(t.kept, (t.n_room, t.n_series, t.n_terms), np.float64)
    steps = view(t.steps, (t.n_room,), np.float64)
    counts = view(t.counts, (t.n_legs,), np.int64)
    m = _Watched(view(t.active, (t.n_surfaces,), np.int64))
    k.counts[0] = -1  # contacts that stuck before
    used = 0
    for leg in range(t.n_legs):
        for i in range(constants):
            rows[given + i, 0] = of_legs[leg, i]
        call(k.settle, (t.rows,))
        for i in range(n):
            mem[0, i] = initial[leg, i]
        clock, ends, counts[leg] = 0.0, False, 0
        while not ends and counts[leg] <= t.most_steps:
            call(t.take_series, (t.rows, t.series, t.n_terms))
            left = durations[leg] - clock
            step = step_length(mem, units)
            if k.curved:
                step = shorter_step(m, k, rows, mem, min(step, abs(left)))
            # true where a step is no number, too
            ends = not abs(left) > step
            step = left if ends else math.copysign(step, left)
            if used < t.n_room:
                steps[used] = step
                for place in range(t.n_series):
                    for order in range(t.n_terms):
                        kept[used, place, order] = mem[order, place]
            used += 1
            counts[leg] += 1
            clock += step
            _end_of_step(mem, n, step)
        if not ends:
            return


@cache
def run_legs() -> int:
    """Return the address of the compiled function, built once a process and kept on disk."""
    return compile_called(_run, 1, Path(__file__).parent)
