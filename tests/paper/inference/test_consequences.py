"""What follows for a candidate beyond the constraints: fine maps, random cells, resolutions."""

from dataclasses import replace

import numpy as np
import pytest

from squealpipe.brake.dynamics.runs import validity_map
from squealpipe.brake.linear.maps import (
    natural_frequencies,
    quasi_static_map,
    stability_map,
)
from squealpipe.brake.models import a3
from squealpipe.brake.models.contact_system import contact_system
from squealpipe.laws.springs import springs_are_equal
from squealpipe.paper.inference.angle_maps import (
    CLEAR,
    MAP_SIZES,
    _lost,
    _runs,
    keeping_share,
    separating_share,
)
from squealpipe.paper.inference.candidates import Candidates, sets_of
from squealpipe.paper.inference.consequences import judge_consequences
from squealpipe.paper.inference.constraints import (
    Stage,
    _sliding_share,
    _unstable_only_without_sliding,
    measure,
)
from squealpipe.parameters import HORIZON, SCENES
from squealpipe.reading import READINGS
from squealpipe.schema import Outcome
from tests.former import FORMER
from tests.paper.inference.parameter_sets import fields_of, random_sets


def linear(params):
    """Whether statements of linear stability, sliding and frequencies hold at one set."""
    found = judge_consequences(Candidates.of(params, tol=1e-9))
    return {name: bool(held[0]) for name, held in found.items()}


def judged(params):
    """And those on all angles."""
    on_maps = [Stage.printed, Stage.black, Stage.maps]
    found = measure(Candidates.of(params, tol=1e-9), on_maps)
    return linear(params) | {
        name: bool(each.margin[0] > 0) for name, each in found.items()
    }


def test_consequences_at_the_baseline():
    """What is known of the former baseline: F6b as printed only, Fig. 7 without black cells."""
    assert [name for name, held in judged(FORMER).items() if not held] == [
        "F6b",
        "F8c",
        "F7_black",
    ]


def test_consequences_can_come_out_otherwise():
    """Without friction nothing is unstable; a soft contact on short springs is hardly left."""
    held = judged(FORMER.with_(mu=0.0, k3=0.05))
    assert not held["S3"]
    assert held["F6b"]
    assert not held["F7a"]


def literally(params, sliding):
    """Where Eq. (11) as printed allows sliding, whatever the belt's direction."""
    k11, k12 = sliding.stiffness_x.values, sliding.stiffness_xy.values
    coupled = np.abs(k12) > 1e-12 * params.k1
    return np.where(coupled, params.mu < k11 / np.where(coupled, k12, 1.0), k11 > 1e-12)


@pytest.mark.parametrize(
    "equal", [True, pytest.param(False, marks=pytest.mark.release)]
)
def test_exact_conditions_agree_with_fine_maps(equal):
    """The plane of Z against maps over the angles, at random parameters."""
    generator = np.random.default_rng(5)
    angles = np.linspace(0.0, np.pi, 241)
    on_lines = (np.arange(241)[:, None] + np.arange(241)) % 240 == 120
    seen = set()
    for params in random_sets(generator, 12, equal=equal):
        candidates = Candidates.of(params, tol=1e-9)
        regime = stability_map(params, angles, angles).regime_linear.values
        sliding = quasi_static_map(params, angles, angles)
        found = {
            "S3": (regime == 1).any(),
            "F6b": not ((regime > 0) & sliding.possible.values).any(),
            "F6b_printed": not ((regime > 0) & literally(params, sliding)).any(),
        }
        exact = linear(params)
        exact["F6b_printed"] = bool(
            _unstable_only_without_sliding(candidates).margin[0] > 0
        )
        assert {key: exact[key] for key in found} == found, params
        frequencies = natural_frequencies(params, angles, angles).sel(mode=1)
        real = frequencies.outcome == Outcome.converged
        for state, key in (("contact", "F8c"), ("separated", "F8c_separated")):
            omega = frequencies.omega.where(real).sel(contact_state=state).values
            share = np.nanmax(omega[on_lines]) / np.nanmax(omega)
            # The circle where ω1 is largest may cross the lines between two grid points.
            assert share > 0.999 if exact[key] else share < 1 - 1e-12
        seen.add(tuple(exact.values()))
    assert len(seen) > 1 or equal


@pytest.fixture(scope="module")
def likely():
    """Parameter sets from where the feasible ones lie, belt either way."""
    generator = np.random.default_rng(7)
    count = 24
    length = np.exp(generator.uniform(np.log(2.5), np.log(16.0), count))
    fields = {name: np.full(count, value) for name, value in FORMER.as_dict().items()}
    return fields | {
        "k3": generator.uniform(0.4, 0.9, count),
        "mu": generator.uniform(0.05, 0.32, count),
        "length1": length,
        "length2": length,
        "belt_speed": generator.choice([-100.0, 100.0], count),
    }


def test_the_black_region_is_where_a_map_shows_it(likely):
    """Cells along the rim of the disc of flutter, against the cells of a map of 121 angles."""
    candidates = Candidates(likely, 1e-9)
    share = keeping_share(candidates)
    assert 0.2 < (share > 0).mean() < 0.8
    axis = np.linspace(0.0, np.pi, 121)
    cells = [each.ravel() for each in np.meshgrid(axis, axis)]
    seen = []
    for i, params in enumerate(candidates.sets):
        unstable = a3.regime(contact_system(params, *cells).invariants) > 0
        one = candidates.subset(np.full(unstable.sum(), i))
        outcome, *_ = _runs(one, cells[0][unstable], cells[1][unstable])
        seen.append((outcome == Outcome.converged).mean())
    assert ((share > 0) != (np.array(seen) > 0)).sum() <= 2
    assert np.corrcoef(share, seen)[0, 1] > 0.9


def test_every_unstable_cell_is_run_once_where_none_keeps_contact(likely, monkeypatch):
    """Cells are run in three turns; where all of them separate, in each turn all that are left.

    Where they separate at once, none is left after the second turn.
    """
    candidates = replace(Candidates(likely, 1e-9), exact=False)
    cells = candidates.unstable_cells(0.95)
    every = np.stack([likely["k3"][cells.owner], cells.alpha1, cells.alpha2])

    def turns(time, sets=candidates):
        run = []

        def separate(some, alpha1, alpha2):
            run.append(np.stack([some.fields["k3"], alpha1, alpha2]))
            outcome = np.full(alpha1.size, int(Outcome.separated))
            return outcome, np.full(alpha1.size, time), None

        monkeypatch.setattr("squealpipe.paper.inference.angle_maps._runs", separate)
        assert (keeping_share(sets) == 0).all()
        return run

    run = turns(0.9 * HORIZON)
    assert [turn.shape[1] for turn in run] == sorted(turn.shape[1] for turn in run)
    for all_run in (run, turns(1.0, replace(candidates, exact=True))):
        joined = np.concatenate(all_run, axis=1)
        order = [np.lexsort(each) for each in (joined, every)]
        np.testing.assert_array_equal(joined[:, order[0]], every[:, order[1]])
    sizes = [turn.shape[1] for turn in turns(1.0)]
    assert sizes == [run[0].shape[1], run[1].shape[1], 0]


@pytest.mark.parametrize("exact", [True, False])
def test_no_sets_have_no_shares(likely, exact):
    none = replace(Candidates(likely, 1e-9), exact=exact).subset(np.arange(0))
    assert keeping_share(none).size == 0


def test_cells_that_are_not_run_change_no_verdict(likely):
    """Signs without the cells between those that lose contact at once, against those with them."""
    exact = Candidates(likely, 1e-9)
    signs = [keeping_share(each) > 0 for each in (exact, replace(exact, exact=False))]
    np.testing.assert_array_equal(*signs)


@pytest.mark.parametrize("hole", [0.0, 0.15])
def test_midpoints_amidst_kept_ones_are_run_where_they_decide(
    likely, monkeypatch, hole
):
    """Discs of many sizes keep contact but for a hole, which no midpoint of the coarsest map hits.

    The verdicts are those by all midpoints, a fifth of which are not run.
    """
    candidates = Candidates(likely, 1e-9)
    radius = dict(zip(likely["k3"], np.sqrt(np.linspace(1.52, 1.62, 24)), strict=True))
    run = []

    def lose(some, alpha1, alpha2, _):
        run.append(alpha1.size)
        reach = np.array([radius[k3] for k3 in some.fields["k3"]])
        total, apart = alpha1 + alpha2 - np.pi, alpha1 - alpha2
        lost = np.hypot(total, apart - 0.3) > np.sqrt(2.0) * reach
        lost |= np.hypot(total, apart - 0.52) < hole
        outcome = np.where(lost, int(Outcome.separated), int(Outcome.converged))
        return outcome, None, np.zeros(alpha1.size)

    monkeypatch.setattr("squealpipe.paper.inference.angle_maps._runs", lose)
    holds, runs = [], []
    for exact in (True, False):
        run.clear()
        holds.append(separating_share(replace(candidates, exact=exact)) > 0.5)
        runs.append(sum(run))
    np.testing.assert_array_equal(*holds)
    assert 0 < holds[0].sum() < candidates.size
    assert runs[1] < 0.8 * runs[0]


@pytest.mark.release
def test_the_separating_share_has_converged(likely):
    """Twice the resolution leaves the shares within a spacing's error, and F7a within one set."""
    coarse = separating_share(Candidates(likely, 1e-9))
    fine = separating_share(
        Candidates(likely, 1e-9), angles=tuple(2 * number for number in MAP_SIZES)
    )
    assert np.abs(coarse - fine).max() < CLEAR / MAP_SIZES[0]
    assert ((coarse > 0.5) != (fine > 0.5)).sum() <= 1
    bounds = separating_share(replace(Candidates(likely, 1e-9), exact=False))
    np.testing.assert_array_equal(bounds > 0.5, coarse > 0.5)
    assert (bounds <= coarse).all()
    few = {name: values[:3] for name, values in likely.items()}
    unequal = few | {"length2": few["length1"] * (1 + 1e-12)}
    np.testing.assert_array_equal(
        *(
            separating_share(Candidates(each, 1e-9), angles=(12,))
            for each in (few, unequal)
        )
    )


def test_readings_share_what_the_mass_does_below_the_speed_of_the_belt(likely):
    """Shares that were taken over from another reading, against runs in each; no slow belt's."""
    groups = {
        "kappa": likely["k3"][:8],
        "mu": likely["mu"][:8],
        "length_ratio": likely["length1"][:8],
        "speed_ratio": np.geomspace(0.1, 300.0, 8),
    }
    sets = sets_of(groups, tol=1e-9, workers=1)
    runs, half = [], np.array([0.5, 0.5])
    for name in READINGS:
        read = sets.read(name)
        alone = separating_share(replace(read, known_maps=None), angles=(12,))
        np.testing.assert_array_equal(separating_share(read, angles=(12,)), alone)
        maps = (
            _lost(each, 12, None, half)
            for each in (read, replace(read, known_maps=None))
        )
        np.testing.assert_array_equal(*maps)
        runs.append(alone)
    assert (runs[0] != runs[1]).any()
    assert len(sets.known_maps) == 16


def test_few_of_the_unstable_cells_say_which_set_eq_11_refutes(likely):
    """The verdict by cells of which one in 16 comes first, against that by all of them."""
    exact = Candidates(likely, 1e-9)
    margins = [
        _unstable_only_without_sliding(each).margin
        for each in (exact, replace(exact, exact=False))
    ]
    np.testing.assert_array_equal(*(margin > 0 for margin in margins))
    assert 0 < (margins[0] > 0).sum() < exact.size


def test_no_unstable_cell_fulfils_eq_11_as_printed_where_friction_drags_along_x():
    """Which is why no cell is looked at there: by all cells of random sets."""
    sets = random_sets(np.random.default_rng(9), 400, equal=False)
    candidates = Candidates(fields_of(sets), 1e-9)
    share, along = _sliding_share(candidates, 1), candidates.drag > 0
    assert 100 < along.sum() < 300
    assert (share[along] == 0).all()
    margin = _unstable_only_without_sliding(candidates).margin
    np.testing.assert_array_equal(margin, np.where(share > 0, -share, 1.0))


@pytest.mark.release
@pytest.mark.parametrize(
    "beyond",
    [
        {"damping1": 0.1, "damping2": 0.02},
        {"damping1": 0.0, "damping2": 0.05},
        {"friction_law": "exponential", "mu_static": 0.6, "friction_speed": 3.0},
    ],
)
def test_damped_settings_are_judged_by_the_damped_problem(beyond):
    """Against maps on other angles, at random parameters; dashpots alone make K12 = 0 flutter."""
    angles = np.linspace(0.0, np.pi, 90)
    changed = 0
    for params in random_sets(np.random.default_rng(8), 3, equal=False):
        scale = np.sqrt(params.k1 * params.mass)
        damped = params.with_(
            **{
                n: v * scale if n.startswith("damping") else v
                for n, v in beyond.items()
            }
        )
        regime = stability_map(damped, angles, angles).regime_linear.values
        sliding = quasi_static_map(damped, angles, angles)
        found = linear(damped)
        assert found["F6b"] == (not ((regime > 0) & sliding.possible.values).any())
        scene = SCENES["F3"]
        f6d = measure(Candidates.of(damped, tol=1e-9), [Stage.linear])[
            "F6d"
        ].margin.item()
        growth = stability_map(
            damped, [scene.alpha1], [scene.alpha2]
        ).growth_rate.item()
        if abs(growth) * params.time_unit > 1e-12:
            assert f6d == pytest.approx(-growth * params.time_unit, rel=1e-12)
        slow = params.with_(
            friction_law="exponential", mu_static=0.9, friction_speed=1e-3
        )
        fast = (each.with_(belt_speed=40.0) for each in (slow, params))
        margins = {
            measure(Candidates.of(p, tol=1e-9), [Stage.linear])["F6d"].margin.item()
            for p in fast
        }
        assert len(margins) == 1  # friction falls by e^-40000 only
        changed += found != linear(params)
    assert changed


@pytest.mark.parametrize("name", ["damping1", "damping2"])
def test_unequal_dashpots_have_no_mirror_image(name):
    """Cells (α1, α2) and (π − α2, π − α1) then move differently: share against the whole map."""
    params = FORMER.with_(**{name: 0.1})
    axis = (np.arange(12) + 0.5) * (np.pi / 12)
    whole = (
        validity_map(params, axis, axis, t_end=200.0, tol=1e-9).separates.mean().item()
    )
    fields = {key: np.array([value]) for key, value in params.as_dict().items()}
    assert separating_share(Candidates(fields, 1e-9), angles=(12,)).item() == whole
    assert springs_are_equal(fields | {"damping1": 0.1, "damping2": 0.1})
