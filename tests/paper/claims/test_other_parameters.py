"""Other parameters: the same physics in other units, and verdicts that may rightly differ."""

import re

import numpy as np
import pytest

from squealpipe.paper.claims.judge import judge
from squealpipe.paper.claims.table import rows
from squealpipe.parameters import Parameters

from .conftest import compute_evidence

LONG_RUNS = ("F3", "F4", "F9b")
"""Values of chaotic length or of ties between cells: verdicts are compared only."""


@pytest.mark.release
def test_verdicts_and_dimensionless_values_do_not_depend_on_the_units(
    evidence, baseline
):
    params = Parameters(
        mass=4.0,
        k1=100.0,
        k2=100.0,
        k3=65.0,
        mu=baseline.mu,
        preload=0.25,
        length1=3.75,
        length2=3.75,
        belt_speed=125.0,
        sigma=4000.0,
    )
    assert np.isclose(params.speed_ratio, baseline.speed_ratio)
    scaled = compute_evidence(params, "as_printed", beside=True)
    first, second = (
        judge(baseline, evidence, "as_printed"),
        judge(params, scaled, "as_printed"),
    )
    np.testing.assert_array_equal(first.corrected_verdict, second.corrected_verdict)
    np.testing.assert_array_equal(first.verdict_here, second.verdict_here)
    kept = ~np.isin(first.claim.values, LONG_RUNS)
    np.testing.assert_allclose(
        first.value[kept], second.value[kept], rtol=1e-6, atol=1e-8
    )


OTHERS = {
    "no friction": Parameters(mu=0.0),
    "less friction": Parameters(mu=0.25),
    "unequal springs": Parameters(k2=1.6, length2=7.0),
    "slow belt along -x": Parameters(belt_speed=-1.0),
}


@pytest.mark.release
@pytest.mark.parametrize("params", OTHERS.values(), ids=OTHERS)
def test_evidence_states_its_data(params):
    data = compute_evidence(params)
    table = {row["id"]: row for row in rows(judge(params, data))}
    text = {name: row["evidence"] for name, row in table.items()}
    assert not [
        name for name, words in text.items() if re.search(r"\b(nan|inf)\b", words)
    ]
    assert all(row["value"] is not None for row in table.values())
    validity = data["validity_map"]
    unstable = validity.regime_linear.values > 0
    black = (validity.separates.values == 0) & unstable
    assert f"unstable {int(black.sum())} keep contact in their runs" in text["E10"]
    within = data["validity_boundary"].kept.values & unstable
    assert f"lie {int(within.sum())} unstable cells" in text["E10"]
    k12 = data["quasi_static_map"].stiffness_xy
    negative = 100 * float((k12 < -1e-15 * params.k1).mean())
    assert f"K12 is negative in {negative:.3g} %" in text["E5"]
