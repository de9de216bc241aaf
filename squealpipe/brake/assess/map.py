"""The verdict over both spring angles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr

from squealpipe.brake.assess.settling import pushed, settle, start_at
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.schema.assess import verdict_map_schema
from squealpipe.codes import Verdict
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.systems.processes import run_shared
from squealpipe.validation import Angles, Tolerance, Workers
from squealpipe.vibration.schema import Mechanism
from squealpipe.vibration.settled_runs import Start


@recorded(model="A1", method="Taylor series with located events")
def verdict_map(
    params: Parameters,
    alpha1: Angles,
    alpha2: Angles,
    *,
    tol: Tolerance = 1e-9,
    workers: Workers = None,
) -> xr.Dataset:
    """The verdict of :func:`squealpipe.assess` over both spring angles, in 1,600 periods at most.

    Where no steady sliding exists it is that of the sudden start.

    Args:
        alpha1, alpha2: 1-D arrays of angles, rad; alpha1 counted from +x, alpha2 from −x.
    """
    count = alpha2.size

    # a cell that has not settled after so many periods is undetermined
    most_periods = 1600.0

    def fill(arrays: dict[str, np.ndarray], first: int, stride: int) -> None:
        for row in range(first, alpha1.size, stride):
            cells = slice(row * count, (row + 1) * count)
            designs = [Design(params, float(alpha1[row]), float(b)) for b in alpha2]
            slides = [Sliding.of(design) for design in designs]
            starts = [_start(*each) for each in zip(designs, slides, strict=True)]
            settled = settle(starts, tol=tol, most=most_periods)
            arrays["verdict"][cells] = [each.verdict for each in settled]
            arrays["mechanism"][cells] = [
                Mechanism.no_sliding_state if sliding is None else sliding.mechanism
                for sliding in slides
            ]
            arrays["growth"][cells] = [
                np.nan if sliding is None else sliding.growth_rate for sliding in slides
            ]

    cells = (alpha1.size * count,)
    filled = run_shared(
        fill,
        {
            "verdict": (cells, np.int8),
            "mechanism": (cells, np.int8),
            "growth": (cells, np.float64),
        },
        jobs=alpha1.size,
        workers=workers,
    )
    maps = {name: values.reshape(-1, count) for name, values in filled.items()}
    undetermined = maps["verdict"] == Verdict.undetermined
    without = maps["mechanism"] == Mechanism.no_sliding_state
    return build(
        verdict_map_schema,
        {
            "verdict": maps["verdict"],
            "mechanism": maps["mechanism"],
            "sliding_growth_rate": maps["growth"],
            "outcome": np.select(
                [undetermined, without],
                [Outcome.unresolved, Outcome.no_sliding_state],
                Outcome.converged,
            ),
        },
        {"alpha1": alpha1, "alpha2": alpha2},
    )


def _start(design: Design, sliding: Sliding | None) -> Start:
    if sliding is None:
        return start_at(design, None, np.zeros(4))
    start = pushed(design, sliding)
    if not sliding.is_unstable:
        return start
    # where small motions grow, the push starts so much larger: they would pass there anyhow
    growth_of_push = 30.0
    grown = sliding.state + growth_of_push * (start.state - sliding.state)
    return replace(start, state=grown)
