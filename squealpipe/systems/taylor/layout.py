"""What the compiled loop works on: addresses, sizes, and the rows that each lane has."""

from typing import Any, NamedTuple

import numpy as np

LOST_ERROR = 1e-3
"""Error, in units of the states' sizes, from which a state says nothing about its run."""
SHARE, ROUND_OFF = 0.1, 2e-14
"""Share of the tolerance by which a step's end may differ, and the least such difference."""
LATE_BEGINS = -2
"""What ends a step where the late part of a run begins."""
RUNNING, CONVERGED, STEP_LIMIT, EVENT_LIMIT, NOT_FINITE = -1, 0, 3, 4, 6
ACCUMULATION, HIDDEN, DISCONTINUITY = 38, 40, 41
"""How a run ends, by the numbers of ``schema.Outcome``."""
STOPPED = 100
"""A stop of the system's own is this plus its number."""
BY_EVENT, BY_TURNS = 98, 99
"""Ends of runs that were to end at the first event of a kind, or after so many turns."""
(
    CLOCK,
    CORRECTION,
    STEP,
    REACH,
    ACROSS,
    LONGEST,
    T_END,
    T_LATE,
    NEXT_SAMPLE,
    STEPS,
    MOST_STEPS,
    LOST,
    DELAY,
    GAP,
    ORIGIN,
    NATURAL,
    FIXED_ROWS,
) = range(17)
"""Rows of numbers of the lanes that every system has; those of a system follow.

``NATURAL`` is the step that the series allow, before the end of the run cuts it short.

``REACH`` and ``ACROSS`` follow ``STEP`` for ``shorten``: the longest step of late, and whether the
step leads across what may be a jump."""
JOB, OUTCOME, SAMPLE, EVENTS, LOGGED, CHAINED, HIT, LATE, FIRST_REGIME = range(9)
"""Rows of integers of the lanes; the last is the first of the regimes, one a component."""

LOOP_ARRAYS = (
    "rows",
    "integers",
    "series",
    "inverses",
    "sizes",
    "units",
    "tracked",
    "regimes",
    "falls",
    "rises",
    "component_of",
    "first_constant",
    "owner",
    "marks",
    "clocks",
    "ticked",
    "active",
    "fresh",
    "beyond",
    "exact",
    "steep",
    "bent",
    "share",
    "noise",
    "scratch",
    "initial",
    "parameters",
    "first_regime",
    "limits",
    "final",
    "extremes",
    "logs",
    "counts",
    "firsts",
    "durations",
    "ends",
    "summary",
    "sample_times",
    "samples",
    "sample_regimes",
    "sample_sums",
    "sample_extremes",
    "between",
    "event_times",
    "event_kinds",
    "event_regimes",
    "event_states",
    "peaks",
    "points",
    "half_turns",
    "queue",
    "suspects",
)
LOOP_FUNCTIONS = (
    "perturb",
    "longest",
    "gauge",
    "change",
    "jump",
    "settle",
    "verify",
    "shorten",
)
LOOP_SIZES = (
    "n_terms",
    "n_jobs",
    "n_states",
    "n_variables",
    "n_surfaces",
    "n_outputs",
    "n_tracked",
    "n_parameters",
    "n_constants",
    "n_regimes",
    "n_components",
    "n_table",
    "n_kinds",
    "n_samples",
    "n_sums",
    "n_between",
    "n_logged",
    "n_points",
    "n_rounds",
    "until",
    "late_from",
    "tangent",
    "take_step",
    *LOOP_FUNCTIONS,
    "n_series",
    "n_rows",
    "n_switches",
)
LOOP_TABLE = np.dtype([(name, "i8") for name in (*LOOP_ARRAYS, *LOOP_SIZES)])

_fields: Any = [
    (name, Any) for name in LOOP_ARRAYS if name not in {"series", "inverses"}
]
_named_tuple: Any = NamedTuple
Memory: Any = _named_tuple("Memory", _fields)
