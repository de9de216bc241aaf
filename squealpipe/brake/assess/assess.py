"""Answer for one brake: verdict, cause, frequency, level, and what stops it.

Idea: steady sliding, pushed in the direction in which small motions grow fastest, is run until it
has settled; the verdict is what it ends in. The sudden start, from rest at r = 0, decides in its
place where there is no steady sliding. Three strikes of steady sliding look for other motions that
last. Then each parameter alone, and both angles together, are changed until the verdict changes
(:mod:`squealpipe.brake.assess.cures`). Invariant: the search does not alter the verdict. Cost: two
runs to the verdict, five where small motions die out; the search takes most of the time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.brake.assess.cures import nearest_angles, pad_boundaries
from squealpipe.brake.assess.levels import levels
from squealpipe.brake.assess.settling import pushed, settle, start_at, strikes
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.assess.snap_through import SnapThrough
from squealpipe.brake.linear.maps import stability_map
from squealpipe.brake.models.refusals import refuse_scales
from squealpipe.brake.schema.assess import CURES
from squealpipe.codes import Verdict
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.origin import recorded
from squealpipe.systems.one_thread import one_thread
from squealpipe.validation import Angle, Tolerance
from squealpipe.vibration import judgement
from squealpipe.vibration.any_start import different_motions
from squealpipe.vibration.boundaries import Search
from squealpipe.vibration.cures import Boundary, cure_table
from squealpipe.vibration.schema import Mechanism, assess_schema
from squealpipe.vibration.settled_runs import SettledRun, Start
from squealpipe.vibration.settling import settling_of_numbers


@recorded(model="A1", method="Taylor series with located events")
def assess(
    params: Parameters, alpha1: Angle, alpha2: Angle, *, tol: Tolerance = 1e-12
) -> xr.Dataset:
    """Return verdict, cause, frequency, level and cures: see :func:`squealpipe.assess`."""
    return judge(params, alpha1, alpha2, tol=tol).with_cures()


@dataclass(frozen=True)
class Judged:
    """Verdict on a brake and its motions, before the search for what stops it.

    Attributes:
        verdict: what pushed steady sliding ends in, or the sudden start where there is none.
        lasting: runs that have not died out.
        later: strikes that no fact depends on. They are run before the search, which follows the
            motions that they end in.
        facts: variables of the dataset that are known before the search.
        tol: tolerance of the runs.
    """

    design: Design
    verdict: Verdict
    lasting: list[SettledRun]
    later: list[Start]
    facts: dict[str, Any]
    tol: float

    def without_cures(self) -> xr.Dataset:
        """Return the dataset with verdict, cause, frequency and level, but without cures."""
        return self._answer({}, {}, (np.nan, np.nan))

    @one_thread()
    def with_cures(self) -> xr.Dataset:
        """Return the whole dataset; the search for cures takes most of the time."""
        struck = settle(self.later, tol=self.tol, rules=settling_of_numbers)
        motions = different_motions(
            [*self.lasting, *(run for run in struck if not run.quiet)]
        )
        coarse = max(self.tol, Search.tol)
        cures, snaps = pad_boundaries(self.design, self.verdict, motions, tol=coarse)
        nearest = nearest_angles(self.design, self.verdict, tol=coarse)
        return self._answer(cures, snaps, nearest)

    def _answer(
        self,
        cures: Mapping[str, Boundary],
        snaps: Mapping[str, SnapThrough],
        nearest: tuple[float, float],
    ) -> xr.Dataset:
        of_cures = [snaps.get(name, SnapThrough()) for name in cures]
        return build(
            assess_schema,
            {
                **self.facts,
                **cure_table(cures, CURES),
                "snaps_from": np.array([each.value for each in of_cures]),
                "snap_distance": np.array([each.distance for each in of_cures]),
                "quiet_alpha1": nearest[0],
                "quiet_alpha2": nearest[1],
            },
            {"cure": np.array(list(cures), str), "mode": [1, 2]},
        )


@one_thread()
def judge(params: Parameters, alpha1: float, alpha2: float, *, tol: float) -> Judged:
    """Judge a brake by runs that have settled: pushed steady sliding, the sudden start, strikes.

    Args:
        alpha1, alpha2: spring angles, rad.
        tol: tolerance of the runs.
    """
    refuse_scales(params)
    design = Design(params, alpha1, alpha2)
    sliding = Sliding.of(design)
    sudden = start_at(design, sliding, np.zeros(4))
    starts: list[Start] = [sudden]
    later: list[Start] = []
    if sliding is not None:
        starts.append(pushed(design, sliding))
        # only a pad that a push leaves quiet may be so "unless struck"
        (later if sliding.is_unstable else starts).extend(strikes(design, sliding))
    of_sudden, *rest = settle(starts, tol=tol, rules=settling_of_numbers)
    of_push = rest.pop(0) if rest else None
    judged = judgement.judge(
        of_push, of_sudden, rest, partial(levels, design, sliding, tol=tol)
    )
    facts = {
        **judged.facts,
        **_linear(design, sliding),
        "alpha1": alpha1,
        "alpha2": alpha2,
        "preload": params.preload,
    }
    return Judged(design, judged.verdict, judged.lasting, later, facts, tol)


def _linear(design: Design, sliding: Sliding | None) -> dict[str, Any]:
    """Return the variables of the dataset about small motions."""
    linear = stability_map(design.params, [design.alpha1], [design.alpha2])
    linear_facts = {
        "growth_rate": float(linear.growth_rate[0, 0]),
        "mode_frequency": linear.frequency.values[0, 0] / (2.0 * np.pi),
    }
    if sliding is None:
        return linear_facts | {
            "mechanism": Mechanism.no_sliding_state,
            **dict.fromkeys(
                ("sliding_growth_rate", "x_sliding", "y_sliding", "sliding_force"),
                np.nan,
            ),
        }
    return linear_facts | {
        "mechanism": sliding.mechanism,
        "sliding_growth_rate": sliding.growth_rate,
        "x_sliding": sliding.state[0],
        "y_sliding": sliding.state[1],
        "sliding_force": sliding.force,
    }
