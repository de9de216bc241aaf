"""Shares of the verdicts over scattered parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
import xarray as xr
from annotated_types import Ge, MinLen

from squealpipe.brake.assess.settling import pushed, settle, start_at
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.brake.propensity.distributions import check_stick, distribution
from squealpipe.brake.schema.assess import verdict_shares_schema
from squealpipe.codes import Verdict
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.origin import recorded
from squealpipe.validation import Angle, Seed, Tolerance, Whole
from squealpipe.vibration import sobol
from squealpipe.vibration.shares import wilson_interval


@recorded(model="A1", method="quasi-random sample")
def verdict_shares(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    distributions: Annotated[Mapping[str, Any], MinLen(1)],
    samples: Annotated[Whole, Ge(16)] = 256,
    seed: Seed = 1,
    tol: Tolerance = 1e-9,
) -> xr.Dataset:
    """Estimate how often a brake of scattered parameters is quiet, squeals, hammers or is
    undetermined.

    Args:
        distributions: as :func:`squealpipe.propensity` takes them.
        samples: a power of 2.
    """
    frozen = {name: distribution(name, given) for name, given in distributions.items()}
    check_stick(params, frozen)
    points = sobol.scrambled(len(frozen), samples, seed)
    draws = np.stack(
        [each.ppf(points[:, i]) for i, each in enumerate(frozen.values())], axis=1
    )
    starts = []
    for row in draws.tolist():
        given = dict(zip(frozen, row, strict=True))
        angles = [
            given.pop(n, a)
            for n, a in zip(("alpha1", "alpha2"), (alpha1, alpha2), strict=True)
        ]
        design = Design(params.with_(**given), *angles)
        sliding = Sliding.of(design)
        starts.append(
            start_at(design, None, np.zeros(4))
            if sliding is None
            else pushed(design, sliding)
        )
    verdicts = np.array([each.verdict for each in settle(starts, tol=tol)])
    counts = [int((verdicts == kind).sum()) for kind in Verdict]
    low, high = np.transpose([wilson_interval(count, samples) for count in counts])
    return build(
        verdict_shares_schema,
        {
            "share": np.array(counts) / samples,
            "share_low": low,
            "share_high": high,
            "samples": samples,
            "alpha1": alpha1,
            "alpha2": alpha2,
        },
        {"kind": [kind.name for kind in Verdict]},
    )
