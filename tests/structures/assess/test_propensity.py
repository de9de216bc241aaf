"""Scatter of a structure's parameters, against the closed form of one whose onset is known."""

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import brentq

from squealpipe import Contact, Parameters, Structure, load, propensity, save
from squealpipe.cli import run
from squealpipe.plotting import picture
from squealpipe.structures import disc_brake
from squealpipe.structures.assess.propensity import known_inputs

MASS, STIFFNESS, MU, SPREAD = 0.5, 6e6, 0.2, 0.3
ROD = np.array([[1.2e7, -1.0e6], [-1.0e6, 8.0e6]])
DAMPING = np.diag([60.0, 60.0])


def structure(**changes):
    contact = Contact("pad", {1: 1.0}, {0: 1.0}, STIFFNESS, 3000.0)
    arguments = {"contacts": [contact], "mu": MU, "load": 0}
    return Structure(MASS * np.eye(2), ROD, DAMPING, **arguments | changes)


def growth(mu):
    stiffness = ROD + STIFFNESS * np.array([[0.0, mu], [0.0, 1.0]])
    state = np.block(
        [[np.zeros((2, 2)), np.eye(2)], [-stiffness / MASS, -DAMPING / MASS]]
    )
    return np.linalg.eigvals(state).real.max()


@pytest.mark.release
def test_shares_are_those_of_own_eigenvalues_and_friction_alone_decides(tmp_path):
    """Equations are homogeneous in preload and speed, so that the preload decides nothing."""
    critical = brentq(growth, 0.05, 1.0)
    width = np.sqrt(np.log(1.0 + SPREAD**2))
    factor = stats.lognorm(width, scale=1.0 / np.sqrt(1.0 + SPREAD**2))
    assert (factor.mean(), factor.std()) == pytest.approx((1.0, SPREAD))
    spread = propensity(
        structure(mu=0.9 * critical),
        relative_std={"mu": SPREAD, "preload": 0.2},
        samples=128,
        workers=1,
    )
    quiet = spread.sel(verdict="quiet")
    # evenly spread points miss the share of an interval by about one of them
    assert float(quiet.share) == pytest.approx(factor.cdf(1.0 / 0.9), abs=2.0 / 128)
    assert quiet.share_low < quiet.share < quiet.share_high
    assert float(spread.share.sum()) == pytest.approx(1.0)
    total = quiet.total_order
    assert float(total.sel(input="preload")) == 0.0
    assert float(total.sel(input="mu")) == pytest.approx(1.0, abs=0.15)
    never = spread.sel(verdict="undetermined")
    assert float(never.share) == 0.0
    assert np.isnan(never.total_order).all()
    again = load(save(spread, tmp_path / "spread.nc"))
    assert again.equals(spread)
    assert len(picture(again).axes) == 2


def test_each_parameter_changes_what_its_name_says():
    brake = disc_brake()
    known = known_inputs(brake.with_common_mu())
    assert {"mu", "preload_lining", "contact_stiffness_lining"} <= known.keys()
    assert "mu_lining" in known_inputs(brake)
    assert "modal_damping" not in known_inputs(structure())
    pad = structure(modal_damping=0.01)
    truths = {
        "mu": lambda s: s.mu_of_contacts[0] / MU,
        "belt_speed": lambda s: s.belt_speed / 2.0,
        "preload": lambda s: s.preloads[0] / 3000.0,
        "preload_pad": lambda s: s.preloads[0] / 3000.0,
        "contact_stiffness": lambda s: s.stiffnesses[0] / STIFFNESS,
        "contact_stiffness_pad": lambda s: s.stiffnesses[0] / STIFFNESS,
        "modal_damping": lambda s: float(s.modal_damping) / 0.01,
    }
    known = known_inputs(pad)
    assert known.keys() == truths.keys()
    for name, change in known.items():
        changed = change(pad, 1.5)
        assert truths[name](changed) == pytest.approx(1.5)
        assert [
            key for key in truths if truths[key](changed) != pytest.approx(1.0)
        ] in ([name], [name, f"{name}_pad"], [name.removesuffix("_pad"), name])


def test_scattered_friction_takes_its_limit_of_stick_along():
    """A limit that stayed was exceeded by some samples, which ended the whole computation."""
    contacts = [
        Contact("a", {1: 1.0}, {0: 1.0}, STIFFNESS, 3000.0),
        Contact("b", {1: 1.0}, {0: 2.0}, STIFFNESS, 3000.0, mu=0.3, mu_static=0.4),
    ]
    pad = structure(contacts=contacts, mu_static=0.25, friction_law="exponential")
    known = known_inputs(pad)
    for name, truth in (
        ("mu", [(0.4, 0.5), (0.3, 0.4)]),
        ("mu_b", [(0.2, 0.25), (0.6, 0.8)]),
    ):
        frictions = known[name](pad, 2.0).frictions
        assert [(each.mu, each.static_mu) for each in frictions] == truth


SPREAD_OF_PAD = {"mu": {"distribution": "uniform", "low": 0.1, "high": 0.9}}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"relative_std": {"mu": 0.1}, "samples": 100}, "power of 2"),
        ({"relative_std": {"mu": 0.0}}, "above 0 and up to 1"),
        ({"relative_std": {"mu": "10 mm"}}, "relative_std: mu"),
        ({"relative_std": {"nu": 0.1}}, "did you mean 'mu'"),
        ({"relative_std": {}}, "'mu': 0.1"),
        ({"relative_std": {"preload": 0.1, "preload_pad": 0.1}}, "keep one"),
        ({"relative_std": {"modal_damping": 0.1}}, "modal_damping"),
        ({"relative_std": {"mu": 0.1}, "t_end": 1.0}, "a structure has none"),
        ({"distributions": SPREAD_OF_PAD}, "a structure has none"),
    ],
)
def test_what_cannot_scatter_is_refused_with_its_name(options, message):
    with pytest.raises(ValueError, match=message):
        propensity(structure(), **options)


def test_pads_and_structures_need_arguments_of_their_own():
    with pytest.raises(TypeError, match="relative_std: missing"):
        propensity(structure())
    with pytest.raises(TypeError, match="distributions: missing"):
        propensity(Parameters(), 0.3, 1.0, samples=64, t_end=1.0)
    options = {"distributions": SPREAD_OF_PAD, "samples": 64, "t_end": 1.0}
    with pytest.raises(
        ValueError, match=r"relative_std = .*a pad on two springs has none"
    ):
        propensity(Parameters(), 0.3, 1.0, relative_std={"mu": 0.1}, **options)


def test_the_command_says_which_options_are_whose(tmp_path, capsys):
    file = tmp_path / "pad.yaml"
    file.write_text("mass: mass.mtx\n")
    assert run(["propensity", str(file), "--distribution", "mu=normal:1:2"]) == 2
    assert "only pads take this" in capsys.readouterr().err
    assert run(["propensity", "0.3", "1", "--relative-std", "mu=0.1"]) == 2
    assert "only structures take this" in capsys.readouterr().err
    assert run(["propensity", str(file)]) == 2
    assert "--relative-std is missing" in capsys.readouterr().err
