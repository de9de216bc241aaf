"""What follows for a candidate beyond the constraints: fine maps, random cells, resolutions."""

from __future__ import annotations

import numpy as np
import pytest

from squealpipe.models import a3
from squealpipe.models.contact_system import contact_system
from squealpipe.parameters import SCENES
from squealpipe.schema import Outcome
from squealpipe.tasks.dynamics.runs import validity_map
from squealpipe.tasks.inference.consequences import (
    ANGLES,
    CLEAR,
    RIM,
    _linear,
    _some_keep_contact,
    judge_consequences,
    separating_share,
    springs_are_equal,
    unstable_cells,
)
from squealpipe.tasks.inference.constraints import candidate_of, measure
from squealpipe.tasks.linear.maps import natural_frequencies, quasi_static_map, stability_map
from tests.former import FORMER
from tests.tasks.inference.parameter_sets import random_sets

BASELINE = FORMER


def test_consequences_at_the_baseline() -> None:
    """What is known of the baseline: F6b as printed only, Fig. 7 without black cells."""
    fields = {name: np.array([value]) for name, value in BASELINE.as_dict().items()}
    held = {key: bool(values[0]) for key, values in judge_consequences(fields, tol=1e-9).items()}
    assert held == {
        "S3": True,
        "F6b": False,
        "F6b_printed": True,
        "F7a": True,
        "F7_black": True,
        "F8c": False,
        "F8c_separated": True,
    }


def test_consequences_can_come_out_otherwise() -> None:
    """Without friction nothing is unstable; a soft contact on short springs is hardly left."""
    fields = {
        name: np.array([value]) for name, value in BASELINE.with_(mu=0.0, k3=0.05).as_dict().items()
    }
    held = {key: bool(values[0]) for key, values in judge_consequences(fields, tol=1e-9).items()}
    assert not held["S3"]
    assert held["F6b"]
    assert not held["F7a"]


@pytest.mark.parametrize("equal", [True, False])
def test_exact_conditions_agree_with_fine_maps(equal: bool) -> None:
    """The plane of Z against maps over the angles, at random parameters."""
    generator = np.random.default_rng(5)
    angles = np.linspace(0.0, np.pi, 241)
    on_lines = (np.arange(241)[:, None] + np.arange(241)) % 240 == 120
    seen = set()
    for params in random_sets(generator, 12, equal=equal):
        cells = unstable_cells(params)
        regime = stability_map(params, angles, angles).regime_linear.values
        sliding = quasi_static_map(params, angles, angles)
        found = {
            "S3": (regime == 1).any(),
            "F6b": not ((regime > 0) & sliding.possible.values).any(),
            "F6b_printed": not ((regime > 0) & sliding.possible_as_printed.values).any(),
        }
        exact = _linear(params, *cells)
        assert {key: exact[key] for key in found} == found, params
        frequencies = natural_frequencies(params, angles, angles).sel(mode=1)
        real = frequencies.outcome == Outcome.converged
        for state, key in (("contact", "F8c"), ("separated", "F8c_separated")):
            omega = frequencies.omega.where(real).sel(contact_state=state).values
            largest = np.nanmax(omega[on_lines]) >= np.nanmax(omega) * (1 - 1e-12)
            # The circle where ω1 is largest may cross the lines between two grid points.
            assert exact[key] == largest or (
                exact[key] and np.nanmax(omega[on_lines]) > 0.999 * np.nanmax(omega)
            )
        seen.add(tuple(exact.values()))
    assert len(seen) > 1 or equal


@pytest.fixture(scope="module")
def likely() -> dict[str, np.ndarray]:
    """Parameter sets from where the feasible ones lie, belt either way."""
    generator = np.random.default_rng(7)
    count = 24
    length = np.exp(generator.uniform(np.log(2.5), np.log(16.0), count))
    fields = {name: np.full(count, value) for name, value in BASELINE.as_dict().items()}
    return fields | {
        "k3": generator.uniform(0.4, 0.9, count),
        "mu": generator.uniform(0.05, 0.32, count),
        "length1": length,
        "length2": length,
        "belt_speed": generator.choice([-100.0, 100.0], count),
    }


def test_the_black_region_is_found_however_thin(likely: dict[str, np.ndarray]) -> None:
    """The rim of the disc of flutter, at three resolutions, against random cells of all of it."""
    sets = [
        FORMER.with_(**{name: float(values[i]) for name, values in likely.items()})
        for i in range(len(likely["mu"]))
    ]
    found = {
        number: _some_keep_contact(
            likely, [unstable_cells(params, rim=number) for params in sets], 1e-9, None
        )
        for number in (RIM // 2, RIM, 2 * RIM)
    }
    assert 0.2 < found[RIM].mean() < 0.8
    for number in (RIM // 2, 2 * RIM):
        assert (found[number] != found[RIM]).sum() <= 1
    generator = np.random.default_rng(3)
    cells = []
    for params in sets:
        alpha1, alpha2 = generator.uniform(0.0, np.pi, (2, 40_000))
        unstable = a3.regime(contact_system(params, alpha1, alpha2).invariants) > 0
        cells.append((alpha1[unstable][:400], alpha2[unstable][:400]))
    anywhere = _some_keep_contact(likely, cells, 1e-9, None)
    assert not (anywhere & ~found[2 * RIM]).any()
    assert anywhere.sum() >= 0.6 * found[2 * RIM].sum()


def test_the_separating_share_has_converged(likely: dict[str, np.ndarray]) -> None:
    """Twice the resolution leaves the shares within a spacing's error, and F7a within one set."""
    coarse = separating_share(likely, tol=1e-9)
    fine = separating_share(likely, angles=tuple(2 * number for number in ANGLES), tol=1e-9)
    assert np.abs(coarse - fine).max() < CLEAR / ANGLES[0]
    assert ((coarse > 0.5) != (fine > 0.5)).sum() <= 1
    few = {name: values[:3] for name, values in likely.items()}
    unequal = few | {"length2": few["length1"] * (1 + 1e-12)}
    np.testing.assert_array_equal(
        separating_share(few, angles=(12,), tol=1e-9),
        separating_share(unequal, angles=(12,), tol=1e-9),
    )


@pytest.mark.parametrize(
    "beyond",
    [
        {"damping1": 0.1, "damping2": 0.02},
        {"damping1": 0.0, "damping2": 0.05},
        {"friction_law": "exponential", "mu_static": 0.6, "friction_speed": 3.0},
    ],
)
def test_damped_settings_are_judged_by_the_damped_problem(beyond: dict[str, object]) -> None:
    """Against maps on other angles, at random parameters; dashpots alone make K12 = 0 flutter."""
    angles = np.linspace(0.0, np.pi, 240)
    changed = 0
    for params in random_sets(np.random.default_rng(8), 6, equal=False):
        scale = np.sqrt(params.k1 * params.mass)
        damped = params.with_(
            **{
                name: value * scale if name.startswith("damping") else value
                for name, value in beyond.items()
            }
        )
        regime = stability_map(damped, angles, angles).regime_linear.values
        sliding = quasi_static_map(damped, angles, angles)
        found = _linear(damped, *unstable_cells(damped))
        if "damping2" in beyond:  # uneven damping makes flutter in which frequencies do not merge
            assert not found["S3"]
        assert found["F6b"] == (not ((regime > 0) & sliding.possible.values).any())
        scene = SCENES["F3"]
        f6d = measure(candidate_of(damped, tol=1e-9))["F6d"].margin.item()
        growth = stability_map(damped, [scene.alpha1], [scene.alpha2]).growth_rate.item()
        if abs(growth) * params.time_unit > 1e-12:
            assert f6d == pytest.approx(-growth * params.time_unit, rel=1e-12)
        slow = params.with_(friction_law="exponential", mu_static=0.9, friction_speed=1e-3)
        margins = [
            measure(candidate_of(each, tol=1e-9))["F6d"].margin.item()
            for each in (slow.with_(belt_speed=40.0), params.with_(belt_speed=40.0))
        ]
        assert margins[0] == margins[1]  # friction falls by e^-40000 only
        changed += found != _linear(params, *unstable_cells(params))
    assert changed


@pytest.mark.parametrize("name", ["damping1", "damping2"])
def test_unequal_dashpots_have_no_mirror_image(name: str) -> None:
    """Cells (α1, α2) and (π − α2, π − α1) then move differently: share against the whole map."""
    params = FORMER.with_(**{name: 0.1})
    axis = (np.arange(12) + 0.5) * (np.pi / 12)
    whole = validity_map(params, axis, axis, t_end=200.0, tol=1e-9).separates.mean().item()
    fields = {key: np.array([value]) for key, value in params.as_dict().items()}
    assert separating_share(fields, angles=(12,), tol=1e-9).item() == whole
    assert springs_are_equal(fields | {"damping1": 0.1, "damping2": 0.1})
