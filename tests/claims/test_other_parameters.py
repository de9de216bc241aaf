"""Other parameters: the same physics in other units, and verdicts that may rightly differ."""

from __future__ import annotations

import numpy as np
import xarray as xr

from squealpipe.claims.judge import judge
from squealpipe.parameters import Parameters
from squealpipe.schema.claims import Verdict

from .conftest import compute_evidence

LONG_RUNS = ("F3", "F4", "F9b", "E4")
"""Values of chaotic length, of ties between cells, or with a unit: verdicts are compared only."""


def test_verdicts_and_dimensionless_values_do_not_depend_on_the_units(
    evidence: dict[str, xr.Dataset], baseline: Parameters
) -> None:
    params = Parameters(
        mass=4.0,
        k1=100.0,
        k2=100.0,
        k3=75.0,
        mu=baseline.mu,
        preload=0.25,
        length1=1.25,
        length2=1.25,
        belt_speed=125.0,
        sigma=4000.0,
    )
    assert np.isclose(params.speed_ratio, baseline.speed_ratio)
    first, second = judge(baseline, evidence), judge(params, compute_evidence(params))
    np.testing.assert_array_equal(first.verdict_here, second.verdict_here)
    kept = ~np.isin(first.claim.values, LONG_RUNS)
    np.testing.assert_allclose(first.value[kept], second.value[kept], rtol=1e-6, atol=1e-8)


def test_without_friction_nothing_flutters_and_every_row_is_still_judged(
    evidence: dict[str, xr.Dataset],
) -> None:
    params = Parameters(mu=0.0)
    claims = judge(params, compute_evidence(params))
    verdicts = dict(zip(claims.claim.values, claims.verdict_here.values, strict=True))
    assert verdicts["S3"] == Verdict.fails
    assert verdicts["F6b"] == Verdict.holds
    assert Verdict.cannot_be_decided not in claims.verdict_here.values
