"""A brake by force, ratio and stiffnesses is the brake of the parameters that these stand for."""

import math
import re

import numpy as np
import pytest

import squealpipe
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.parameters import Parameters
from squealpipe.substitutes import equal_springs

SI = Parameters(
    mass=0.45,
    k1=1e7,
    k2=1e7,
    k3=7e6,
    preload=4e3 / 7e6,
    belt_speed=2.0,
    damping1=2 * 0.01 * math.sqrt(1e7 * 0.45),
    damping2=2 * 0.01 * math.sqrt(1e7 * 0.45),
)


def test_a_pad_by_force_and_ratio_is_the_pad_in_si():
    written = Parameters.of(
        mass="450 g",
        k1="10 kN/mm",
        k2="10 kN/mm",
        k3="7 kN/mm",
        preload_force="4 kN",
        damping_ratio="1 %",
        belt_speed="7.2 km/h",
    )
    for name, value in SI.as_dict().items():
        assert getattr(written, name) == pytest.approx(value, rel=4e-16), name
    assert written.preload_force == pytest.approx(4e3, rel=4e-16)


def test_a_pad_by_stiffnesses_moves_like_the_pad_in_si():
    """The run agrees to the tolerance of the integration, from springs of another order too."""
    alphas = math.radians(50), math.radians(20)
    matrix = linear_stiffness(SI, geometry(*alphas))
    stiffness = {"along": matrix.k11, "across": matrix.k22, "coupling": matrix.k12}
    springs = equal_springs(**stiffness)
    written = Parameters.of(
        mass="450 g",
        k3="7 kN/mm",
        pressure="10 bar",
        area="40 cm^2",
        stiffness=stiffness,
        damping_ratio=0.01,
        belt_speed=2.0,
    )
    assert written.k1 == written.k2 == pytest.approx(SI.k1, rel=1e-15)
    assert springs[1:] == pytest.approx(alphas, rel=1e-14)
    one = squealpipe.simulate(SI, *alphas, t_end=0.01)
    other = squealpipe.simulate(written, *springs[1:], t_end=0.01)
    assert other.x.values == pytest.approx(one.x.values, abs=1e-10 * SI.preload)


def test_two_equal_springs_have_the_stiffness_that_is_wanted():
    draws = np.random.default_rng(49)
    for along, across in 10.0 ** draws.uniform(3, 9, (200, 2)):
        coupling = draws.uniform(-0.999, 0.999) * math.sqrt(along * across)
        springs = equal_springs(along, across, coupling)
        matrix = linear_stiffness(
            Parameters(k1=springs.k, k2=springs.k), geometry(*springs[1:])
        )
        assert all(0 <= angle <= math.pi for angle in springs[1:])
        assert matrix == pytest.approx((along, coupling, across), abs=1e-14 * springs.k)


def test_a_force_on_a_table_of_contact_is_the_first_compression_that_has_it():
    for between in ("linear", "cubic"):
        law = f"{between} 0:0 1e-4:200 2e-4:800 3e-4:2000"
        for force in (100.0, 500.0, 800.0, 4000.0):
            params = Parameters.of(contact_law=law, preload_force=force)
            assert params.preload_force == pytest.approx(force, rel=1e-12)
    with pytest.raises(ValueError, match="does not reach 900 N: it ends at 800 N"):
        Parameters.of(contact_law="linear 0:0 1e-4:800 2e-4:800", preload_force=900)


@pytest.mark.parametrize(
    ("inputs", "says"),
    [
        (
            {"preload_force": 1, "preload": 1},
            "preload_force stands for preload; keep one",
        ),
        ({"preload_force": 1, "pressure": 1, "area": 1}, "stands for"),
        ({"pressure": 1}, "pressure needs area beside it"),
        ({"damping_ratio": -0.1}, "damping_ratio = -0.1: must be 0 or greater"),
        ({"damping_ratio": 0.1, "damping2": 1}, "damping_ratio stands for damping2"),
        ({"area": "40 mm", "pressure": 1}, "area = '40 mm': that is a length; an area"),
        ({"preload_forse": 1}, "no such parameter; did you mean 'preload_force'?"),
        ({"stiffness": {"along": 1}}, "write {along: …, across: …, coupling: …}"),
        (
            {"stiffness": {"along": 4, "across": 1, "coupling": 2}},
            "the coupling below √(along · across) = 2 N/m",
        ),
    ],
)
def test_what_cannot_be_is_refused(inputs, says):
    with pytest.raises(ValueError, match=re.escape(says)):
        Parameters.of(**inputs)
