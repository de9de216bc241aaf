"""What the compiled engine reads and writes, as records whose fields go by name.

All quantities are in units of m = k1 = l_pre = 1. Physical parameters come from the table in
:mod:`squealpipe.parameters`; a new result is a row of ``RESULT``.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from squealpipe.codes import Event
from squealpipe.methods.taylor.simd import LANES
from squealpipe.models import switching
from squealpipe.schema import Outcome
from squealpipe.solvers.a1.system import EXTENSIONS, PARAMETERS, PHYSICAL, UNITS

ASKED = (
    "t_end",
    "t_late",
    "stop_at_x",
    "stop_at_separation",
    "stop_at_turns",
    "max_steps",
    "max_events",
    "lost_growth",
)


def _record(**fields: Any) -> np.dtype:
    """Fields of 8 bytes each: "f8" or "i8", or (type, shape)."""
    return np.dtype(
        [(name, *((kind,) if isinstance(kind, str) else kind)) for name, kind in fields.items()]
    )


MARKS = (0.5, 0.75)
"""Shares of a run at whose ends (of a step) its sums are kept."""
ORDER = _record(
    **dict.fromkeys(
        (*UNITS, *PHYSICAL, *EXTENSIONS, "onset_mu", *switching.Rules._fields, *ASKED), "f8"
    )
)
"""A job: parameters and direction cosines, what its variant has (1 or 0), what is asked for.

It has the attributes of ``ScaledParameters``, ``Geometry`` and ``Rules``, so laws and switching
rules take it as it is.
"""
RESULT = _record(
    time="f8",
    first_separation="f8",
    separated_time="f8",
    stick_time="f8",
    lowest_y="f8",
    return_lowest_y="f8",
    impact_speed="f8",
    highest_y="f8",
    largest_r2="f8",
    early_largest_x="f8",
    late_largest_x="f8",
    early_largest_vx="f8",
    late_largest_vx="f8",
    largest_speed="f8",
    nearest_pivot2="f8",
    half_turns=("f8", (2,)),
    log_growth="f8",
    horizon="f8",
    final_state=("f8", (4,)),
    outcome="i8",
    regime="i8",
    steps="i8",
    late_events="i8",
    events="i8",
    kinds=("i8", (len(Event),)),
    marks="i8",
    mark_separated_time=("f8", (len(MARKS),)),
    mark_stick_time=("f8", (len(MARKS),)),
    mark_growth=("f8", (len(MARKS),)),
    mark_half_turns=("f8", (len(MARKS), 2)),
    mark_state=("f8", (len(MARKS), 4)),
    mark_kinds=("i8", (len(MARKS), len(Event))),
)
"""A job's results; ``kinds`` counts the events of each kind, ``mark_`` is what held at a mark."""


def _rows(*names: str) -> dict[str, Any]:
    return dict.fromkeys(names, ("f8", (LANES,)))


LANE = _record(
    **_rows("clock", "correction", "step", "x", "y", "vx", "vy", "ax", *PARAMETERS),
    **_rows("t_end", "t_late", "stop_at_x", "stop_at_turns", "max_steps", "steps"),
    **_rows("next_sample", "pivot_x1", "pivot_y1", "pivot_x2", "pivot_y2", "scale1", "scale2"),
    **_rows("reach2", "separated_time", "stick_time", "lowest_y", "highest_y", "largest_r2"),
    **_rows("early_largest_x", "late_largest_x", "largest_speed", "nearest_pivot2"),
    **_rows("half_turns1", "half_turns2", "dx", "dy", "dvx", "dvy", "lost_growth"),
    **_rows("lost_square", "longest_step", "early_largest_vx", "late_largest_vx", "next_mark"),
    job=("i8", (LANES,)),
    outcome=("i8", (LANES,)),
    sample=("i8", (LANES,)),
)
"""The lanes, one row of numbers a field: time, step and its end, the integrator's parameters,
what is asked for, what was seen, a perturbation; then job, outcome and next sample."""
_fields_of_lane: Any = LANE.fields
_rows_at: Any = [(name, int) for name in _fields_of_lane]
_At: Any = NamedTuple("_At", _rows_at)  # type: ignore[misc]
AT: Any = _At(*(_fields_of_lane[name][1] for name in _fields_of_lane))
"""Bytes from the start of ``LANE`` to each of its rows."""
TANGENT = ("dx", "dy", "dvx", "dvy")
OBSERVED = (
    "separated_time",
    "stick_time",
    "lowest_y",
    "highest_y",
    "largest_r2",
    "early_largest_x",
    "late_largest_x",
    "early_largest_vx",
    "late_largest_vx",
    "largest_speed",
    "nearest_pivot2",
)
"""Results that are kept in rows while a job runs."""
ARRAYS = (
    "lanes",
    "series",
    "inverses",
    "orders",
    "initial",
    "results",
    "sample_times",
    "samples",
    "sample_regimes",
    "event_times",
    "event_kinds",
    "event_states",
    "queue",
)
SIZES = ("n_terms", "n_jobs", "n_samples", "n_logged", "n_rounds", "tangent")
TABLE = _record(**dict.fromkeys((*ARRAYS, *SIZES, "take_step", "perturb", "longest"), "i8"))
"""What a compiled round is given: addresses of arrays, sizes, addresses of the series."""
QUEUE = _record(next="i8", end="i8", stride="i8")

TANGENT_NORM = 1.0
"""Norm that a perturbation starts from and is scaled back to."""
PIVOT_REACH2 = 1e-14
"""Squared distance from a pivot, in free lengths, below which the force's direction is lost."""
SUSPECT_PIVOT2 = 1e-6
"""Squared distance below which an overflow is a pivot's doing."""
JUMP2 = 1e-2
"""A step that ends its approach to a pivot this much nearer than it began, squared, has jumped over
the singularity: straight through a pivot the Taylor series of the force is smooth to round-off."""

_fields: Any = [(outcome.name, int) for outcome in Outcome]
_Codes: Any = NamedTuple("_Codes", _fields)  # type: ignore[misc]
CODES: Any = _Codes(*map(int, Outcome))
"""``schema.Outcome`` as plain integers."""
SEPARATED, STICK = switching.SEPARATED, switching.STICK
RUNNING, IDLE = -1, -1
"""A lane's outcome while it runs; its job where it has none."""
