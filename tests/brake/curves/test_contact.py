"""The boundary of kept contact: its slopes, its residuals, and maps that it must agree with."""

import numpy as np
import pytest
import xarray as xr

import squealpipe
from squealpipe.brake.curves.regions import inside, loops_of
from squealpipe.brake.curves.zero_lines import FirstGrid, ZeroLines
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome

BASELINE = Parameters()
SETS = {
    "baseline": (BASELINE, "A1-as-printed"),
    "unequal springs": (BASELINE.with_(k2=1.8, length2=12.0, mu=0.45, k3=0.5), "A1"),
    "slow belt, sticking": (
        BASELINE.with_(belt_speed=-0.6, k2=0.6, length1=8.0, mu=0.2),
        "A1",
    ),
    "dashpots, falling friction": (
        BASELINE.with_(
            damping1=0.02,
            damping2=0.01,
            belt_speed=2.0,
            friction_law="exponential",
            mu_static=0.4,
        ),
        "A1",
    ),
    "a brake in SI units": (
        Parameters(
            mass=0.5,
            k1=1e7,
            k2=1.2e7,
            k3=6e6,
            mu=0.35,
            belt_speed=3.0,
            preload=1e-4,
            length1=1e-3,
            length2=1.2e-3,
        ),
        "A1",
    ),
}


def disagreement(boundary, uniform):
    """(points of a map with another answer, the largest distance of these from the outlines)."""
    axes = [uniform[name].values for name in boundary.parameter.values]
    loops = [
        boundary.outline.values[boundary.outline_loop.values == i]
        for i in np.unique(boundary.outline_loop)
    ]
    kept = inside(loops, *axes)
    edge = [np.isclose(axis, axis[[0, -1]][:, None]).any(axis=0) for axis in axes]
    wrong = (kept != (uniform.separates.values == 0)) & ~(edge[0][:, None] | edge[1])
    places = np.stack(
        [axis[i] for axis, i in zip(axes, np.nonzero(wrong), strict=True)], axis=1
    )
    return int(wrong.sum()), max(
        (_distance(loops, place) for place in places), default=0.0
    )


def _distance(loops, place):
    """From a point to the nearest of closed lines."""
    nearest = []
    for line in loops:
        chord = np.roll(line, -1, axis=0) - line
        share = ((place - line) * chord).sum(axis=1) / np.maximum(
            (chord**2).sum(axis=1), 1e-300
        )
        foot = line + np.clip(share, 0.0, 1.0)[:, None] * chord
        nearest.append(np.linalg.norm(foot - place, axis=1).min())
    return float(min(nearest))


SLOW = [
    pytest.param(name, marks=pytest.mark.release)
    for name in ("baseline", "a brake in SI units")
]


@pytest.mark.release
@pytest.mark.parametrize("name", [*list(SETS)[1:4], *SLOW])
def test_the_curves_agree_with_a_uniform_map(name):
    """Every point of a map that is finer than the one the curves start from."""
    params, model = SETS[name]
    t_end = 25.0 * params.time_unit
    coarse, fine = np.linspace(0.0, np.pi, 31), np.linspace(0.0, np.pi, 181)
    boundary = squealpipe.contact_boundary(
        params, coarse, coarse, t_end=t_end, model=model
    )
    sticks = (
        name == "slow belt, sticking"
    )  # there tongues are narrower than the finest grid
    assert boundary.outcome == (Outcome.unresolved if sticks else Outcome.converged)
    assert np.median(boundary.residual) < 1e-12
    assert boundary.residual.max() < 1e-7
    assert boundary.region_area_error.max() < (2e-5 if sticks else 2e-7)
    assert boundary.region_area.sum() == pytest.approx(np.pi**2, abs=1e-9)
    uniform = squealpipe.validity_map(params, fine, fine, t_end=t_end, model=model)
    wrong, distance = disagreement(boundary, uniform)
    assert wrong == 0, distance


@pytest.mark.release
def test_the_mirrored_regions_have_one_area():
    """(α1, α2) and (π − α2, π − α1) are one system: areas agree to the error that is stated."""
    angles = np.linspace(0.0, np.pi, 31)
    found = squealpipe.contact_boundary(
        BASELINE, angles, angles, t_end=20.0, model="A1-as-printed"
    )
    lost = np.sort(found.region_area.values[~found.region_kept.values.astype(bool)])[:2]
    assert lost[1] - lost[0] < 2.0 * found.region_area_error.max()
    assert found.region_area_error.max() < 2e-7


@pytest.mark.release
def test_two_parameters_under_their_own_names():
    """In a case with a closed form: K diagonal and equal, y_max = 2κ/(1 + κ), so κ = 1."""
    kappa, mu = np.linspace(0.6, 1.4, 9), np.linspace(0.1, 0.5, 7)
    params = BASELINE.with_(length1=1e5, length2=1e5)
    found = squealpipe.contact_boundary(
        params, np.pi / 2, np.pi, t_end=6.0, kappa=kappa, mu=mu
    )
    assert found.outcome == 0
    assert np.abs(found.kappa - 1.0).max() < 1e-4  # springs of 10⁵ l_pre, nearly linear
    assert found.region_area.values[
        found.region_kept.values == 1
    ].sum() == pytest.approx(0.16, 1e-3)


def two_discs(place):
    """Positive in the lens that two discs of radius 0.3 share, whose centres are 0.2 apart."""
    return np.asarray(0.09 - squares(place).max(axis=0))


def squares(place):
    return np.array([((place - [x, 0.5]) ** 2).sum(axis=1) for x in (0.41, 0.61)])


def test_a_lens_has_its_area_and_its_corners():
    def mark(place, slope):
        return np.asarray(squares(place).argmax(axis=0))

    lines = ZeroLines(two_discs, mark, FirstGrid(11, 2), jump=0.5)
    (lens,) = loops_of(lines, positive=True)
    outer, hole = sorted(loops_of(lines, positive=False), key=lambda loop: -loop.area)
    exact = 0.18 * np.arccos(1 / 3) - 0.1 * np.sqrt(0.32)
    assert abs(lens.area - exact) < lens.error < 1e-8
    assert outer.area + hole.area == pytest.approx(1.0 - lens.area, abs=1e-12)
    corners = lines.place[np.isnan(lines.slope[:, 0])]
    assert np.sort(corners[:, 1]) == pytest.approx(
        0.5 + np.sqrt(0.08) * np.array([-1, 1])
    )
    assert corners[:, 0] == pytest.approx([0.51, 0.51])
    # a corner may fall on the point before it
    before, corner = lines.chords[np.isnan(lines.slope[lines.chords[:, 1], 0])][0]
    lines.place[corner] = lines.place[before]
    assert loops_of(lines, positive=True)[0].area == pytest.approx(exact, abs=1e-6)


def test_what_cannot_vary_is_refused():
    angles = np.linspace(0.0, 1.0, 5)
    with pytest.raises(ValueError, match="two arguments"):
        squealpipe.contact_boundary(BASELINE, angles, 1.0)
    with pytest.raises(ValueError, match="'mass' cannot vary"):
        squealpipe.contact_boundary(BASELINE, angles, 1.0, mass=angles + 1.0)
    ratios, boundary = angles + 0.5, xr.Dataset()
    for ratio, own in (("kappa", "k3"), ("lambda_", "length2")):
        with pytest.raises(ValueError, match=f"{ratio} sets {own}"):
            squealpipe.contact_boundary(
                BASELINE, 1.0, 1.0, **{ratio: ratios, own: ratios}
            )
    with pytest.raises(ValueError, match="dataset of contact_boundary"):
        squealpipe.boundary_distance(boundary, {"kappa": 1.0, "mu": 0.1})
    with pytest.raises(ValueError, match="finite numbers"):
        squealpipe.boundary_distance(boundary, {"kappa": np.nan, "mu": 0.1})
