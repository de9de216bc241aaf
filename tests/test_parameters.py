"""Parameters and scenes: what is allowed, and the dimensionless groups."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from squealpipe.parameters import DEFAULTS, SCENES, TABLE, Parameters, parameters_of
from squealpipe.study.configuration.settings import ConfigError, parse_study

positive = st.floats(1e-3, 1e3)


def test_whole_and_numpy_numbers_become_floats():
    params = Parameters(mass=2, k3=np.float32(0.5), belt_speed=np.int64(-3), mu=0)
    assert [type(value) for value in params.as_dict().values()] == [float] * 10
    assert params.belt_speed == -3.0


def test_parameters_cannot_be_changed_in_place():
    params = Parameters()
    with pytest.raises(dataclasses.FrozenInstanceError):
        params.mu = 0.1
    assert params.with_(mu=0.1).mu == 0.1
    with pytest.raises(ValueError, match="mass"):
        params.with_(mass=-1.0)


@given(mass=positive, stiffness=positive, length=positive)
def test_groups_do_not_depend_on_the_units(mass, stiffness, length):
    plain = Parameters()
    speed = length * math.sqrt(stiffness / mass)
    scaled = Parameters(
        mass=mass,
        k1=stiffness,
        k2=stiffness,
        k3=plain.k3 * stiffness,
        preload=length,
        length1=plain.length1 * length,
        length2=plain.length2 * length,
        belt_speed=plain.belt_speed * speed,
    )
    for group in ("kappa", "length_ratio", "speed_ratio"):
        assert math.isclose(
            getattr(scaled, group), getattr(plain, group), rel_tol=1e-14
        )


def test_scenes_are_those_of_the_paper():
    printed = {
        "F2a": (0.5, 1),
        "F2b": (1, 0.5),
        "F2c": (0.75, 0.75),
        "F2d": (0.83, 0.83),
        "F3": (0.4, 0.6),
        "F4": (0.2, 0.8),
        "F5a": (1, 1),
        "F5b": (0, 0),
        "F10": (0.5, 1),
        "F11": (1, 0.5),
        "F12": (0.75, 0.75),
        "F13": (5 / 6, 5 / 6),
    }
    assert set(SCENES) == set(printed)
    for name, over_pi in printed.items():
        scene = SCENES[name]
        assert (scene.alpha1 / math.pi, scene.alpha2 / math.pi) == pytest.approx(
            over_pi, rel=1e-15
        )


def test_repr_can_be_read_back_and_tells_the_groups():
    params = Parameters(k3=0.5, mu=0.25, length1=4.0, belt_speed=-0.3)
    text = repr(params)
    assert eval(text) == params  # noqa: S307
    assert text.endswith("# κ = 0.5, μ = 0.25, λ = 4, v = -0.3")
    groups = params.kappa, params.mu, params.length_ratio, params.speed_ratio
    assert groups == (0.5, 0.25, 4.0, -0.3)


EXTENSIONS = {"damping1": 0.1, "damping2": 0.2, "friction_law": "exponential"}
EXTENSIONS |= {"mu_static": 0.5, "friction_speed": 2.0}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mu": -0.1}, r"mu = -0\.1: must be 0 or greater"),
        ({"damping1": -0.1}, r"damping1 = -0\.1: must be 0 or greater"),
        ({"damping2": -1e-9}, r"damping2 = -1e-09: must be 0 or greater"),
        ({"mu_static": -0.1}, r"mu_static = -0\.1: must be 0 or greater"),
        ({"mu_static": 0.1}, r"mu_static = 0\.1: it must be 0\.3, the coefficient"),
        ({"friction_speed": 0.0}, r"friction_speed = 0\.0: must be greater than 0"),
        (
            {"friction_speed": 5e-324},
            r"friction_speed = 5e-324: must be 1e-300 or greater",
        ),
        ({"friction_law": "exponentail"}, r"did you mean 'exponential'\?"),
        ({"friction_law": 3}, "friction_law = 3: unknown"),
    ],
)
def test_extensions_refuse_what_makes_no_sense(change, message):
    with pytest.raises(ValueError, match=message):
        Parameters(**change)
    with pytest.raises(ConfigError, match=next(iter(change))):
        parse_study({"parameters": change})


def test_extensions_are_written_down_only_where_they_are_used():
    """Ids of datasets are made of these mappings, so those of the paper's model stay."""
    known = [name for name, row in TABLE.items() if not row.extension]
    assert list(Parameters().as_dict()) == known
    assert set(TABLE) - set(known) >= set(EXTENSIONS)
    params = Parameters(**EXTENSIONS)
    assert Parameters(**params.as_dict()) == params
    assert set(params.as_dict()) == {*known, *EXTENSIONS}
    plain = parse_study({"parameters": {"mu": 0.25}})
    spelled = parse_study(
        {"parameters": {"mu": 0.25, **{n: DEFAULTS[n] for n in EXTENSIONS}}}
    )
    assert plain.slice("parameters") == spelled.slice("parameters")
    assert sorted(plain.slice("parameters")["parameters"]) == sorted(known)
    full = parse_study({"parameters": EXTENSIONS}).slice("parameters")
    assert parameters_of(full) == params


def test_drag_follows_the_law_at_the_speed_of_the_belt():
    for law, factor in (("exponential", math.exp(-1.5)), ("hyperbolic", 1 / 2.5)):
        given = {"mu": 0.2, "mu_static": 0.5, "friction_speed": 2.0, "belt_speed": -3.0}
        params = Parameters(friction_law=law, **given)
        assert params.drag == pytest.approx(-(0.2 + 0.3 * factor), rel=1e-15)
        assert params.with_(mu_static=0.2).drag == -0.2


def test_every_row_says_what_tables_and_help_need():
    for name, row in TABLE.items():
        assert row.meaning
        assert row.symbol
        assert f"{name}: {row.meaning}" in (Parameters.__doc__ or "")
