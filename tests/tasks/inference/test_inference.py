"""Statements as constraints: closed forms, independent integration, the shipped baseline."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import scipy.integrate

from squealpipe.config import read_study
from squealpipe.models import a3
from squealpipe.models.contact_system import contact_system
from squealpipe.parameters import SCENES, Parameters
from squealpipe.schema import Outcome
from squealpipe.schema.inference import wilson_interval
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.store import load, save
from squealpipe.tasks.inference.consequences import (
    ANGLES,
    CLEAR,
    RIM,
    _linear,
    _some_keep_contact,
    judge_consequences,
    separating_share,
    unstable_cells,
)
from squealpipe.tasks.inference.constraints import (
    CONSTRAINTS,
    GROWTH,
    Candidates,
    candidate_of,
    measure,
)
from squealpipe.tasks.inference.inference import infer_parameters
from squealpipe.tasks.linear.maps import natural_frequencies, quasi_static_map, stability_map
from tests import symbols

ROOT = Path(__file__).resolve().parents[3]
BASELINE = Parameters()
FORCE = symbols.function(symbols.SPRING_FORCE)


@pytest.fixture(scope="module")
def inference() -> object:
    return infer_parameters(BASELINE, samples=256)


def long_springs(**arrays: object) -> Candidates:
    """Candidates in the limit of linear springs, with the given fields."""
    count = max(np.size(values) for values in arrays.values())
    fields = {
        name: np.broadcast_to(np.asarray(arrays.get(name, value), float), count)
        for name, value in BASELINE.with_(length1=1e6, length2=1e6).as_dict().items()
    }
    return Candidates(fields, 1e-9)


def test_the_shipped_baseline_is_feasible() -> None:
    study = read_study(ROOT / "workflow/config/paper.yaml")
    params = Parameters(**study.parameters.model_dump())
    verdicts = measure(candidate_of(params, tol=1e-12))
    assert {
        name: float(verdict.margin[0]) > 0 for name, verdict in verdicts.items()
    } == dict.fromkeys((statement.name for statement in CONSTRAINTS), True)
    assert all(verdict.outcome[0] == Outcome.converged for verdict in verdicts.values())


def test_contact_with_long_springs_as_the_closed_form_says() -> None:
    """(π/2, π) and its like: y = κ/(1+κ)(1 − cos √(1+κ) t), lowest force (1 − κ)/(1 + κ)."""
    kappa = np.array([0.3, 0.7, 0.99, 1.01, 1.3])
    verdicts = measure(long_springs(k3=kappa))
    for name in ("F2a", "F2b", "F2c"):
        np.testing.assert_allclose(verdicts[name].margin, (1 - kappa) / (1 + kappa), atol=1e-4)


def test_contact_is_lost_beyond_the_known_stiffness() -> None:
    """F2d with long springs: lost if and only if κ > 0.518 at 0.83π."""
    verdicts = measure(long_springs(k3=[0.51, 0.526], mu=0.3))
    assert verdicts["F2d"].margin[0] < 0 < verdicts["F2d"].margin[1]


@pytest.mark.parametrize("mu", [0.1, 0.32, 0.33, 0.7])
def test_linear_stability_of_the_scene_of_fig_3(mu: float) -> None:
    margin = measure(long_springs(mu=[mu]))["F6d"].margin[0]
    assert margin == pytest.approx(1 - mu * math.tan(0.4 * math.pi), abs=1e-12)


@pytest.mark.parametrize("kappa", [0.4, 1.2])
def test_the_modes_are_switched_while_the_contact_is_softer(kappa: float) -> None:
    """(5π/6, 5π/6): K11 = 1.5 against K22 + k3 = 0.5 + κ."""
    margin = measure(long_springs(k3=[kappa]))["F13"].margin[0]
    assert margin == pytest.approx(min(1 - kappa, kappa), abs=1e-12)


def test_unequal_springs_break_what_needs_equal_ones() -> None:
    """A user's k2 ≠ k1: (π, π) differs from (0, 0), and no x mode is isolated."""
    verdicts = measure(candidate_of(BASELINE.with_(k2=1.1, length2=6.0), tol=1e-12))
    assert verdicts["F5a"].margin[0] < 0
    assert verdicts["F13"].margin[0] == pytest.approx(-0.5 * 0.1, rel=1e-12)


def test_margins_do_not_depend_on_units() -> None:
    plain = measure(candidate_of(BASELINE, tol=1e-12))
    speed = 3.0 * math.sqrt(7.0 / 2.0)
    scaled = BASELINE.with_(
        mass=2.0,
        k1=7.0,
        k2=7.0,
        k3=7.0 * BASELINE.k3,
        preload=3.0,
        length1=15.0,
        length2=15.0,
        belt_speed=speed * BASELINE.belt_speed,
    )
    for name, verdict in measure(candidate_of(scaled, tol=1e-12)).items():
        # F3 and F4 are chaotic: only the other margins keep their digits.
        tolerance = 0.5 if name in {"F3", "F4"} else 1e-9
        assert float(verdict.margin[0]) == pytest.approx(
            float(plain[name].margin[0]), abs=tolerance
        )


def test_the_pulling_contact_loses_exactly_what_a1_loses() -> None:
    """A margin of Fig. 2 is negative if and only if A1 itself separates."""
    generator = np.random.default_rng(8)
    fields = {
        "k3": generator.uniform(0.3, 1.3, 200),
        "mu": generator.uniform(0.02, 0.8, 200),
        "belt_speed": generator.choice([-1, 1], 200) * np.exp(generator.uniform(-2, 5, 200)),
    }
    length = np.exp(generator.uniform(0.7, 4.6, 200))
    whole = {name: np.full(200, value) for name, value in BASELINE.as_dict().items()}
    whole |= {**fields, "length1": length, "length2": length}
    contact = Candidates(whole, 1e-9).contact
    for name in ("F2a", "F2d"):
        scene = SCENES[name]
        run = run_ensemble(whole, scene.alpha1, scene.alpha2, t_end=scene.t_end, tol=1e-9)
        np.testing.assert_array_equal(contact[name].margin < 0, run.separations > 0)


def test_lowest_force_agrees_with_an_independent_integration() -> None:
    """Scipy on the symbolic forces, while the mass slips behind the belt in contact."""
    scene = SCENES["F2a"]
    angles = {"alpha1": scene.alpha1, "alpha2": scene.alpha2}

    def field(_: float, u: np.ndarray) -> list[float]:
        fx, fy = FORCE(BASELINE, x=u[0], y=u[1], **angles)
        normal = BASELINE.k3 * (BASELINE.preload - u[1])
        return [u[2], u[3], fx + BASELINE.mu * normal, fy + normal]

    run = scipy.integrate.solve_ivp(
        field, (0, scene.t_end), np.zeros(4), method="DOP853", rtol=1e-10, atol=1e-12, max_step=0.01
    )
    lowest = 1.0 - run.y[1].max()
    found = candidate_of(BASELINE, tol=1e-12).contact["F2a"].margin[0]
    assert found == pytest.approx(lowest, abs=2e-5)


def test_growth_of_fig_3_and_bound_of_fig_4() -> None:
    """The criteria, measured again from sampled motions."""
    verdicts = measure(candidate_of(BASELINE, tol=1e-12))
    for name, sign in (("F3", 1), ("F4", -1)):
        scene = SCENES[name]
        times = np.linspace(0, scene.t_end, 20_001)
        run = run_ensemble(BASELINE, scene.alpha1, scene.alpha2, t_end=scene.t_end, times=times)
        x = np.abs(run.samples[:, 0])
        growth = math.log(x[10_000:].max() / x[:10_000].max() / GROWTH)
        size = math.log(x.max() / (2 * BASELINE.length1))
        expected = min(sign * growth, sign * size)
        assert float(verdicts[name].margin[0]) == pytest.approx(expected, abs=1e-4)


def test_samples_cover_the_ranges_evenly(inference: object) -> None:
    ranges = {"kappa": (0.3, 1.3), "mu": (0.02, 0.8)}
    logarithmic = {"length_ratio": (2, 100), "speed_ratio": (0.1, 316)}
    for name, (low, high) in ranges.items():
        share = (inference[name].values - low) / (high - low)
        assert abs(np.histogram(share, 8, (0, 1))[0] - 32).max() <= 3
    for name, (low, high) in logarithmic.items():
        share = np.log(inference[name].values / low) / np.log(high / low)
        assert abs(np.histogram(share, 8, (0, 1))[0] - 32).max() <= 3
    assert abs((inference.direction.values == 1).sum() - 128) <= 3


def test_verdicts_follow_from_margins(inference: object, tmp_path: Path) -> None:
    holds = inference.holds.values
    np.testing.assert_array_equal(holds, inference.margin.values > 0)
    np.testing.assert_array_equal(inference.feasible, holds.all(axis=1))
    np.testing.assert_allclose(inference.share_holding, holds.mean(axis=0))
    single = (~holds).sum(axis=1) == 1
    np.testing.assert_allclose(
        inference.share_cut_alone, [(~holds[single, i]).sum() / 256 for i in range(holds.shape[1])]
    )
    assert inference.baseline_holds.all()
    assert load(save(inference, tmp_path / "inference.nc")).equals(inference)


def test_the_number_of_processes_changes_nothing(inference: object) -> None:
    assert infer_parameters(BASELINE, samples=256, workers=1).identical(inference)


def test_consequences_at_the_baseline() -> None:
    """What the brief states of the baseline: F6b as printed only, Fig. 7 without black cells."""
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


def test_shares_of_the_feasible_samples(inference: object) -> None:
    feasible = inference.feasible.values
    size = int(inference.feasible_count)
    assert size == feasible.sum() > 0
    counts = inference.feasible_share.values * size
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-9)
    assert float(inference.feasible_share.sel(consequence="F6b_printed")) == 1.0
    for name in inference.consequence.values:
        row = inference.sel(consequence=name)
        assert row.feasible_share_low <= row.feasible_share <= row.feasible_share_high
    own = dict(
        zip(inference.consequence.values, inference.baseline_consequence.values, strict=True)
    )
    assert own["F7a"]
    assert own["F7_black"]


def test_wilsons_interval_as_in_closed_form() -> None:
    count, size, z = 7, 40, 1.959963984540054
    share = count / size
    middle = (share + z * z / (2 * size)) / (1 + z * z / size)
    half = z * math.sqrt(share * (1 - share) / size + (z / (2 * size)) ** 2) / (1 + z * z / size)
    assert wilson_interval(count, size) == pytest.approx((middle - half, middle + half), rel=1e-12)
    assert np.isnan(wilson_interval(0, 0)).all()


def random_sets(generator: np.random.Generator, count: int, *, equal: bool) -> list[Parameters]:
    """Parameter sets of either direction of the belt, in units of their own."""
    sets = []
    for _ in range(count):
        k1, length1, mass, preload = np.exp(generator.uniform(-1, 1, 4))
        k2, length2 = (k1, 1.0) if equal else np.exp(generator.uniform(-1, 1, 2))
        reach = preload * np.exp(generator.uniform(0.7, 3.5))
        sets.append(
            Parameters(
                mass=mass,
                k1=k1,
                k2=k2,
                k3=k1 * generator.uniform(0.1, 3.0),
                mu=generator.uniform(0.0, 0.9),
                preload=preload,
                length1=reach * (1.0 if equal else length1),
                length2=reach * length2,
                belt_speed=generator.choice([-1, 1]) * np.exp(generator.uniform(-2, 5)),
            )
        )
    return sets


def fields_of(sets: list[Parameters]) -> dict[str, np.ndarray]:
    return {
        name: np.array([params.as_dict()[name] for params in sets])
        for name in BASELINE.as_dict()
        if name != "sigma"
    }


def test_samples_and_maps_are_judged_alike() -> None:
    """F6d at random parameters, belt either way: stable exactly where ``stability_map`` is."""
    generator = np.random.default_rng(13)
    sets = random_sets(generator, 150, equal=True) + random_sets(generator, 150, equal=False)
    f6d = next(constraint for constraint in CONSTRAINTS if constraint.name == "F6d")
    margin = f6d.check(Candidates(fields_of(sets), 1e-9)).margin
    scene = SCENES["F3"]
    for params, value in zip(sets, margin, strict=True):
        regime = stability_map(params, [scene.alpha1], [scene.alpha2]).regime_linear.item()
        assert (value > 0) == (regime == 0), params
    assert 0.1 < (margin > 0).mean() < 0.9


def test_a_belt_along_minus_x_passes_beyond_the_bound_of_the_other() -> None:
    """The reproducer: μ above cot 0.4π is unstable with the belt along +x only."""
    margins = measure(long_springs(mu=[0.5, 0.5], belt_speed=[100.0, -100.0]))["F6d"].margin
    slope = 0.5 * math.tan(0.4 * math.pi)
    np.testing.assert_allclose(margins, [1 - slope, 1 + slope], rtol=1e-12)


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
        Parameters(**{name: float(values[i]) for name, values in likely.items()})
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


@pytest.mark.slow
def test_the_feasible_set_of_the_study() -> None:
    """An independent count has 474 of 20,480 samples; round-off decides a few runs of F4.

    F4 is a chaotic transient: our own counts are 472 at the tolerance 1e-9 and 473 from 1e-11 to
    1e-13.
    """
    found = infer_parameters(BASELINE, samples=20_480)
    assert abs(int(found.feasible_count) - 474) <= 3
    assert found.direction.values[found.feasible.values].min() == -1
