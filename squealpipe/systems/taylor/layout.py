"""Tables of the compiled loop.

:data:`LOOP_TABLE` is the record that it is called with: addresses of arrays and of functions, and
sizes. Each lane has rows of numbers and of integers, whose places are the fields of two records.
"""

from typing import Any, NamedTuple

import numpy as np

from squealpipe.systems.taylor.simd import LANES

LOST_ERROR = 1e-3
"""Error, in units of the states' sizes, from which a state says nothing about its run."""


class Outcomes(NamedTuple):
    """Ends of a run, by the numbers of ``schema.Outcome``.

    Attributes:
        by_event, by_turns: ends of runs that were to end at the first event of a kind, or after so
            many turns.
        stopped: a stop of the system's own is this plus its number.
    """

    running: int = -1
    converged: int = 0
    step_limit: int = 3
    event_limit: int = 4
    not_finite: int = 6
    accumulation: int = 38
    hidden: int = 40
    discontinuity: int = 41
    by_event: int = 98
    by_turns: int = 99
    stopped: int = 100


class NumberRows(NamedTuple):
    """Rows of numbers of the lanes that every system has; those of a system follow.

    Attributes:
        reach, across: follow ``step`` for ``shorten``: the longest step of late, and whether the
            step leads across what may be a jump.
        natural: the step that the series allow, before the end of the run cuts it short.
        first_of_system: how many rows every system has.
    """

    clock: int = 0
    correction: int = 1
    step: int = 2
    reach: int = 3
    across: int = 4
    longest: int = 5
    t_end: int = 6
    t_late: int = 7
    next_sample: int = 8
    steps: int = 9
    most_steps: int = 10
    lost: int = 11
    delay: int = 12
    gap: int = 13
    origin: int = 14
    natural: int = 15
    first_of_system: int = 16


class IntegerRows(NamedTuple):
    """Rows of integers of the lanes.

    Attributes:
        hit: the switch that ends the step, or ``late_begins`` where the late part of a run begins.
        first_regime: the first of the regimes, one a component.
        late_begins: no row, but a value of ``hit``.
    """

    job: int = 0
    outcome: int = 1
    sample: int = 2
    events: int = 3
    logged: int = 4
    chained: int = 5
    hit: int = 6
    late: int = 7
    first_regime: int = 8
    late_begins: int = -2


# compiled code takes fields of such records as the numbers that they are
outcomes, numbers, integers = Outcomes(), NumberRows(), IntegerRows()

# by array: type of its elements, and its shape by sizes; of the first two addresses are taken alone
LOOP_ARRAYS: dict[str, tuple[Any, ...]] = {
    "series": (),
    "inverses": (),
    "rows": ("f8", "n_rows", LANES),
    "integers": ("i8", f"n_components+{integers.first_regime}", LANES),
    "sizes": ("f8", "n_jobs", "n_states"),
    "units": ("f8", "n_states", LANES),
    "tracked": ("i8", "n_tracked", 2),
    "regimes": ("f8", "n_regimes", "n_table"),
    "falls": ("i8", "n_regimes", "n_surfaces"),
    "rises": ("i8", "n_regimes", "n_surfaces"),
    "component_of": ("i8", "n_regimes"),
    "first_constant": ("i8", "n_components+1"),
    "owner": ("i8", "n_surfaces"),
    "marks": ("i8", "n_regimes", "n_surfaces"),
    "clocks": ("i8", "n_surfaces"),
    "ticked": ("f8", "n_surfaces", LANES),
    "active": ("i8", "n_surfaces+n_outputs"),
    "fresh": ("i8", "n_surfaces"),
    "beyond": ("i8", "n_surfaces"),
    "exact": ("f8", "n_states+n_surfaces+n_outputs", LANES),
    "steep": ("i8", "n_states"),
    "bent": ("i8", "n_surfaces+n_outputs"),
    "share": ("f8", 3),
    "noise": ("f8", "n_surfaces", 2, LANES),
    "scratch": ("f8", 6, "n_scratch"),
    "initial": ("f8", "n_jobs", "n_states"),
    "parameters": ("f8", "n_jobs", "n_parameters"),
    "first_regime": ("i8", "n_jobs", "n_components"),
    "limits": ("f8", "n_jobs", 7),
    "final": ("f8", "n_jobs", "n_states"),
    "extremes": ("f8", "n_jobs", "n_tracked", 2, 2),
    "logs": ("i8", "n_kinds"),
    "counts": ("i8", "n_jobs", "n_kinds"),
    "firsts": ("f8", "n_jobs", "n_kinds"),
    "durations": ("f8", "n_jobs", "n_regimes"),
    "ends": ("i8", "n_jobs", 3),
    "summary": ("f8", "n_jobs", 3),
    "sample_times": ("f8", "n_jobs", "n_samples"),
    "samples": ("f8", "n_jobs", "n_samples", "n_states"),
    "sample_regimes": ("i8", "n_jobs", "n_samples", "n_components"),
    "sample_sums": ("f8", "n_jobs", "n_samples", "n_sums"),
    "sample_extremes": ("f8", "n_jobs", "n_between", "n_tracked", 2),
    "between": ("f8", "n_tracked", 2, LANES),
    "event_times": ("f8", "n_jobs", "n_logged"),
    "event_kinds": ("i8", "n_jobs", "n_logged"),
    "event_regimes": ("i8", "n_jobs", "n_logged"),
    "event_states": ("f8", "n_jobs", "n_logged", "n_states"),
    "peaks": ("f8", "n_jobs", "n_kinds", "n_states"),
    "points": ("f8", "n_jobs", "n_points", 2),
    "half_turns": ("f8", "n_jobs", "n_points"),
    "queue": ("i8", 3),
    "suspects": ("i8", "n_surfaces"),
}
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
    "n_scratch",
)
LOOP_TABLE = np.dtype([(name, "i8") for name in (*LOOP_ARRAYS, *LOOP_SIZES)])
