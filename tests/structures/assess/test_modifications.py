"""What stops a structure, against eigenvalues of matrices that are written down here."""

import numpy as np
import pytest
from scipy.optimize import brentq

from squealpipe import Contact, Structure, assess, load, save
from squealpipe.codes import Verdict
from squealpipe.structures.assess.cures import cures_of
from squealpipe.structures.assess.designs import Design
from squealpipe.structures.assess.modifications import Modification
from squealpipe.vibration.boundaries import linear_intervals
from squealpipe.vibration.schema import Mechanism

MASS, STIFFNESS, PRELOAD, MU = 0.5, 6e6, 3000.0, 0.5
ROD = np.array([[1.2e7, -1.0e6], [-1.0e6, 8.0e6]])
WEIGHT, STRUT, DASHPOT = 0.3, 2e7, 600.0


def two_degrees(**changes):
    """Flutter: along and across the belt are coupled by the rod and by friction."""
    contact = Contact("pad", {1: 1.0}, {0: 1.0}, STIFFNESS, PRELOAD)
    arguments = {"damping": 8.0 * np.eye(2), "contacts": [contact], "mu": MU, "load": 0}
    return Structure(MASS * np.eye(2), ROD, **arguments | changes)


def growth(mass=0.0, spring=0.0, dashpot=0.0, mu=MU, damping=8.0):
    """Largest real part by numpy: friction μ k along the belt where the pad moves across it."""
    m = MASS * np.eye(2) + np.diag([0.0, mass])
    k = ROD + np.diag([spring, 0.0]) + STIFFNESS * np.array([[0.0, mu], [0.0, 1.0]])
    c = damping * np.eye(2) + dashpot * np.array([[1.0, -1.0], [-1.0, 1.0]])
    inverse = np.linalg.inv(m)
    state = np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ k, -inverse @ c]])
    return np.linalg.eigvals(state).real.max()


MODIFICATIONS = {
    "weight": {"added_mass": {1: WEIGHT}},
    "strut": {"spring": {0: STRUT}},
    "damper": {"dashpot": {(0, 1): DASHPOT}},
}


OTHERS = {"mu": "mu", "weight": "mass", "strut": "spring", "damper": "dashpot"}
"""Cure → the argument of growth that it changes."""


def crossings(argument, grid):
    """Values at which small motions begin to grow, or cease."""
    margins = [growth(**{argument: value}) for value in grid]
    return [
        brentq(lambda value: growth(**{argument: value}), low, high)
        for low, high, one, other in zip(
            grid, grid[1:], margins, margins[1:], strict=False
        )
        if one * other < 0.0
    ]


@pytest.mark.parametrize("cure", list(OTHERS))
def test_linear_boundaries_of_cures_are_those_of_own_eigenvalues(cure):
    assert growth() > 0.0
    design = Design.of(two_degrees())
    assert design.plant.rate == pytest.approx(growth(), rel=1e-6)
    assert design.mechanism is Mechanism.flutter
    cures, _ = cures_of(design, MODIFICATIONS)
    intervals = linear_intervals(cures[cure], lambda each: each.margin)
    grid = cures[cure].grid
    found = sorted(edge for each in intervals for edge in each.edges())
    truth = crossings(OTHERS[cure], np.linspace(grid[0], grid[-1], 400))
    assert truth or cure == "damper"  # which does not stop it
    assert found == pytest.approx(truth, rel=1e-6)


@pytest.mark.release
def test_what_stops_it_is_quiet_there_and_not_beside(tmp_path):
    answer = assess(two_degrees(), modifications=MODIFICATIONS, samples=4, workers=1)
    assert Verdict(int(answer.verdict)) is not Verdict.quiet
    mu = answer.quiet_from_any_start.sel(cure="mu").item()
    assert mu <= crossings("mu", np.linspace(0.0, MU, 50))[0] * (1.0 + 1e-9)
    quiet = assess(two_degrees(mu=0.99 * mu), samples=4, workers=1)
    assert int(quiet.verdict) == Verdict.quiet
    assert not bool(quiet.quiet_unless_struck)
    assert quiet.velocity_rms_along.item() == 0.0
    again = load(save(answer, tmp_path / "answer.nc"))
    assert again.quiet_low.equals(answer.quiet_low)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"added_mass": {7: 0.1}}, "degrees of freedom are 0 to 1"),
        ({"added_mass": {1: -0.1}}, "greater than 0"),
        ({"added_mass": {(0, 1): 0.1}}, "a mass is at one degree of freedom"),
        ({"sprng": {1: 0.1}}, "did you mean 'spring'"),
        ({"spring": {"5005.3": 1e6}}, "no mesh"),
        ({"spring": {(1, 1): 1e6}}, "two different"),
        (0.1, "added_mass, spring, dashpot is needed"),
    ],
)
def test_a_modification_that_cannot_be_is_refused_with_its_name(content, message):
    with pytest.raises(ValueError, match="modifications: weight") as error:
        Modification.read("weight", content, two_degrees())
    assert message in str(error.value)


def test_a_structure_has_no_angles_and_a_pad_no_modifications():
    with pytest.raises(ValueError, match=r"alpha1 = 1\.0: a structure has no angles"):
        assess(two_degrees(), 1.0)
    with pytest.raises(ValueError, match="name of a cure"):
        assess(two_degrees(), modifications={"mu": {"added_mass": {1: 0.1}}})
