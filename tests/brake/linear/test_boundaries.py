"""Boundary curves lie where the symbolic model says; areas follow from exact integrals."""

import math

import numpy as np
import pytest
import scipy.integrate

from squealpipe.brake.linear.boundaries import stability_boundaries
from squealpipe.brake.linear.maps import quasi_static_map, stability_map
from squealpipe.brake.schema.linear import BoundaryCurve
from tests import symbols
from tests.former import FORMER

HESSIAN = symbols.STIFFNESS
STIFFNESS = symbols.function([HESSIAN[0, 0], HESSIAN[0, 1], HESSIAN[1, 1]])
BASELINE = FORMER
MIDPOINTS = (np.arange(720) + 0.5) * math.pi / 720
UNEQUAL = FORMER.with_(k1=0.9, k2=0.6, k3=1.1, mu=0.7)


@pytest.mark.parametrize("params", [BASELINE, UNEQUAL])
def test_every_point_lies_on_its_curve_which_is_continuous(params):
    curves = stability_boundaries(params, points=201)
    angles = {"alpha1": curves.alpha1.values, "alpha2": curves.alpha2.values}
    k11, k12, k22 = STIFFNESS(params, **angles)
    coupled = k12 + params.mu * params.k3
    functions = {
        BoundaryCurve.flutter: (k11 - k22 - params.k3) ** 2 / 4 + k12 * coupled,
        BoundaryCurve.divergence: k11 * (k22 + params.k3) - k12 * coupled,
        BoundaryCurve.reaction_changes_sign: k11 - params.mu * k12,
        BoundaryCurve.no_coupling: k12,
    }
    for kind, values in functions.items():
        chosen = curves.boundary.values == kind
        assert chosen.any()
        np.testing.assert_allclose(values[chosen], 0.0, atol=2e-14)

    step = np.hypot(np.diff(curves.alpha1), np.diff(curves.alpha2))
    inside = np.diff(curves.segment) == 0
    assert step[inside].max() < 0.1


@pytest.mark.parametrize(
    ("params", "kind", "regime"),
    [
        (BASELINE, BoundaryCurve.flutter, 1),
        (UNEQUAL, BoundaryCurve.divergence, 2),
        pytest.param(UNEQUAL, BoundaryCurve.flutter, 1, marks=pytest.mark.release),
        pytest.param(BASELINE, BoundaryCurve.divergence, 2, marks=pytest.mark.release),
    ],
)
def test_the_regime_changes_across_the_curve(params, kind, regime):
    curves = stability_boundaries(params, points=41)
    chosen = curves.boundary.values == kind
    places = np.stack([curves.alpha1, curves.alpha2], axis=1)[chosen]
    for alpha1, alpha2 in places[::3]:
        near = 2e-3 * np.linspace(-1, 1, 9)
        regimes = stability_map(
            params, alpha1 + near, alpha2 + near
        ).regime_linear.values
        assert (regimes == regime).any()
        assert (regimes != regime).any()


def test_no_curve_where_there_is_no_friction():
    curves = stability_boundaries(BASELINE.with_(mu=0.0), points=21)
    assert not np.isin(curves.boundary, (BoundaryCurve.flutter,)).any()


@pytest.mark.parametrize("mu", [0.3, 1.0])
def test_share_without_sliding_by_an_integral_along_one_angle(mu):
    """Equal springs: 1 + cos p cos q < μ cos p sin q, with p the sum and q the difference."""

    def part(p):
        return (
            math.acos(min(1.0, abs(1.0 / (math.cos(p) * math.hypot(1.0, mu)))))
            / math.pi**2
        )

    edge = math.acos(1.0 / math.hypot(1.0, mu))
    exact = scipy.integrate.quad(
        part, math.pi - edge, math.pi + edge, points=[math.pi]
    )[0]
    found = ~quasi_static_map(BASELINE.with_(mu=mu), MIDPOINTS, MIDPOINTS).possible
    assert float(found.mean()) == pytest.approx(exact, rel=5e-3)


def test_printed_condition_fails_for_half_of_the_map_without_friction():
    sliding = quasi_static_map(BASELINE.with_(mu=0.0), MIDPOINTS, MIDPOINTS)
    assert float(sliding.possible_as_printed.mean()) == pytest.approx(0.5, abs=2e-3)
    assert sliding.possible.all()
