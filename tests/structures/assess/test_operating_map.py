"""Operating points of two degrees of freedom, against eigenvalues that are written down here."""

import numpy as np
import pytest

from squealpipe import Contact, Structure, load, operating_map, plot, save
from squealpipe.codes import Verdict

STIFFNESS = 6e6
ROD = np.array([[1.2e7, -1.0e6], [-1.0e6, 8.0e6]])


def structure():
    contact = Contact("pad", {1: 1.0}, {0: 1.0}, STIFFNESS, 3000.0)
    return Structure(
        0.5 * np.eye(2), ROD, 80.0 * np.eye(2), contacts=[contact], mu=0.5, load=0
    )


def growth(mu, direction):
    stiffness = ROD + STIFFNESS * np.array([[0.0, direction * mu], [0.0, 1.0]])
    state = np.block(
        [[np.zeros((2, 2)), np.eye(2)], [-2.0 * stiffness, -160.0 * np.eye(2)]]
    )
    return np.linalg.eigvals(state).real.max()


@pytest.fixture(scope="module")
def points():
    return operating_map(
        structure(),
        pressure=[1.0, 2.0],
        speed=[-2.0, 2.0, 4.0],
        mu=[0.05, 0.6],
        workers=1,
    )


def test_growth_and_verdicts_are_those_of_own_eigenvalues(points):
    for speed in (-2.0, 2.0, 4.0):
        for mu in (0.05, 0.6):
            at = points.sel(speed=speed, mu=mu)
            truth = growth(mu, np.sign(speed))
            assert at.growth_rate.values == pytest.approx(truth, rel=1e-6)
            assert ((at.verdict == Verdict.quiet).values == (truth < 0)).all()
            assert (np.isfinite(at.frequency).values == (truth > 0)).all()


def test_twice_the_pressure_and_speed_is_twice_as_loud_at_one_frequency(points):
    """The equations are homogeneous in the preload and the speed together."""
    one = points.sel(pressure=1.0, speed=2.0, mu=0.6)
    two = points.sel(pressure=2.0, speed=4.0, mu=0.6)
    assert float(one.velocity_rms) > 0.0
    assert float(two.velocity_rms) == pytest.approx(
        2.0 * float(one.velocity_rms), rel=1e-3
    )
    assert float(two.frequency) == pytest.approx(float(one.frequency), rel=1e-4)
    assert int(two.verdict) == int(one.verdict)


def test_occurrence_adds_up_to_the_share_of_noisy_points(points, tmp_path):
    noisy = np.isfinite(points.frequency.values)
    assert float(points.occurrence.sum()) == pytest.approx(noisy.mean())
    assert float(points.share_noisy) == noisy.mean()
    for frequency in points.frequency.values[noisy]:
        away = np.abs(np.log10(frequency / points.band.values))
        assert away.min() <= 0.05 + 1e-9
        assert points.occurrence.values[away.argmin()] > 0
    again = load(save(points, tmp_path / "points.nc"))
    assert again.verdict.equals(points.verdict)
    assert plot(again) is not None


@pytest.mark.parametrize(("name", "value"), [("pressure", [0.0, 1.0]), ("mu", [-0.1])])
def test_pressures_and_frictions_that_cannot_be_are_refused(name, value):
    with pytest.raises(ValueError, match=name):
        operating_map(structure(), **{name: value})
