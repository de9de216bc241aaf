"""Propensities against closed forms; distributions and settings."""

from time import process_time
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from squealpipe import critical_friction_map, stability_map
from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.dynamics.motion import as_judged, classify_motion
from squealpipe.brake.propensity.distributions import (
    DISTRIBUTIONS,
    centred,
    distribution,
)
from squealpipe.brake.propensity.propensity import _events, propensity
from squealpipe.brake.schema.dynamics.runs import MotionFlag
from squealpipe.codes import LinearRegime
from squealpipe.paper import robustness
from squealpipe.paper.inference.inference import infer_parameters
from squealpipe.paper.robustness import _feasible, variants
from squealpipe.paper.schema.inference import of_study
from squealpipe.schema import Outcome
from squealpipe.vibration.shares import wilson_interval
from squealpipe.vibration.sobol import judged_matrices, scrambled, supported_indices
from tests.former import FORMER

ANGLES = (0.22, 0.96)
FRICTION = {"mu": {"distribution": "uniform", "low": 0.1, "high": 0.9}}


def onset():
    """The friction above which the undamped linear model flutters."""
    found = critical_friction_map(FORMER, [ANGLES[0]], [ANGLES[1]])
    return found.critical_mu_undamped.item()


@pytest.mark.parametrize("belt_speed", [100.0, -3.0])
def test_share_of_flutter_is_that_of_the_frictions_above_onset(belt_speed):
    angles = ANGLES if belt_speed > 0 else (np.pi - ANGLES[0], np.pi - ANGLES[1])
    given = {"distributions": FRICTION, "samples": 4096, "t_end": 1.0}
    spread = propensity(FORMER.with_(belt_speed=belt_speed), *angles, **given)
    exact = (0.9 - onset()) / 0.8
    found = spread.sel(quantity="flutter")
    # a scrambled Sobol sequence of n points misses an interval's share by about 1/n
    assert abs(float(found.share) - exact) < 2.5 / 4096
    assert found.share_low < exact < found.share_high
    np.testing.assert_allclose(found.total_order, 1.0, atol=0.05)
    np.testing.assert_allclose(found.share_by_size[-1], found.share)
    never = spread.sel(quantity="whirl")
    assert never.outcome == Outcome.unresolved
    assert np.isnan(never.total_order).all()


LAW = """
def coefficient(speed, p):
    return p.mu*(1 + 0.5/(1 + speed**2*4))
"""


@pytest.mark.parametrize(
    "change",
    [
        pytest.param({"damping1": 0.05, "damping2": 0.3}, marks=pytest.mark.release),
        {"friction_law": "exponential", "mu_static": 0.7, "belt_speed": 1.0},
        {"friction_law": LAW, "belt_speed": -0.5, "damping1": 0.1},
        {"contact_law": "dashpot", "damping3": 0.2},
    ],
)
def test_the_share_of_flutter_is_that_of_the_maps_of_its_sample(change):
    params = FORMER.with_(**change)
    given = {
        **FRICTION,
        "alpha1": {"distribution": "uniform", "low": 0.0, "high": 3.0},
        "alpha2": {"distribution": "uniform", "low": 0.0, "high": 3.0},
    }
    if params.mu_static:
        given["mu"] = {"distribution": "uniform", "low": 0.1, "high": 0.7}
    spread = propensity(params, *ANGLES, distributions=given, samples=64, t_end=1.0)
    points = scrambled(3, 64, 1)
    columns = [
        distribution(name, each).ppf(points[:, i])
        for i, (name, each) in enumerate(given.items())
    ]
    regimes = [
        stability_map(params.with_(mu=mu), [first], [second]).regime_linear.item()
        for mu, first, second in zip(*columns, strict=True)
    ]
    share = regimes.count(LinearRegime.flutter) / 64
    assert 0.0 < share < 1.0
    assert float(spread.share.sel(quantity="flutter")) == share


@pytest.mark.release
def test_dashpots_cost_no_more_than_three_times_as_much():
    given = {"distributions": FRICTION, "samples": 1024, "t_end": 10.0, "workers": 1}

    def cost(params):
        times = [process_time()]
        for _ in range(4):  # the first compiles
            propensity(params, *ANGLES, **given)
            times.append(process_time())
        return np.diff(times)[1:].min()

    assert cost(FORMER.with_(damping1=0.02, damping2=0.02)) < 3.0 * cost(FORMER)


def test_indices_are_those_of_a_product_and_too_wide_ones_are_not_given():
    """[u1 < a][u2 < b], u3 idle: variance ab(1 − ab), S1 = b² a(1 − a)/variance, T1 = 1 − S2."""
    frozen = {f"u{i}": stats.uniform(0.0, 1.0) for i in (1, 2, 3)}
    a, b = 0.6, 0.45

    def judge(u):
        return ((u[0] < a) & (u[1] < b))[None]

    (row,) = np.moveaxis(judged_matrices(judge, frozen, 2**14, 5), 1, 0)
    (small,) = np.moveaxis(judged_matrices(judge, frozen, 2**7, 5), 1, 0)
    found = supported_indices([row, small, np.zeros_like(row)], 3)
    variance = a * b * (1.0 - a * b)
    first = np.array([b * b * a * (1 - a), a * a * b * (1 - b), 0.0]) / variance
    total = np.array([1.0 - first[1], 1.0 - first[0], 0.0])
    for key, exact in (("first_order", first), ("total_order", total)):
        low, high = found[f"{key}_low"][0], found[f"{key}_high"][0]
        np.testing.assert_allclose(found[key][0], exact, atol=0.02)
        assert (0.5 * (high - low) <= 0.02).all()
        assert (np.abs(found[key][0] - exact) <= high - low).all()
        assert np.isnan(found[key][1:, :2]).all(), (
            "too small a sample, or nothing that differs"
        )
    widths = found["half_width_by_size"]
    assert (widths[0, 1:] < widths[0, :-1]).all()
    assert widths[1, -1] > 0.05
    assert np.isnan(widths[2]).all()


def test_correlated_springs_have_propensities_but_nosupported_indices():
    springs = {
        name: {"distribution": "normal", "mean": 1.0, "std": 0.05}
        for name in ("k1", "k2")
    }
    given = {"samples": 64, "t_end": 10.0, "spring_correlation": 0.9}
    spread = propensity(FORMER, *ANGLES, distributions=springs, **given)
    assert np.isfinite(spread.share).all()
    assert (spread.outcome == Outcome.unresolved).all()


@pytest.mark.parametrize(
    ("name", "given", "words"),
    [
        (
            "mu",
            {"distribution": "beta", "low": 0.0, "high": 1.0},
            "distribution = 'beta'",
        ),
        (
            "my",
            {"distribution": "uniform", "low": 0.0, "high": 1.0},
            "did you mean 'mu'",
        ),
        ("mu", {"distribution": "uniform", "low": -0.1, "high": 1.0}, "reaches -0.1"),
        ("k1", {"distribution": "normal", "mean": 1.0, "std": 0.3}, "reaches -0.2"),
        ("k1", {"distribution": "normal", "mean": 1.0}, "needs mean and std"),
        (
            "k1",
            {"distribution": "lognormal", "median": -1.0, "log_std": 0.1},
            "median = -1.0",
        ),
        ("k3", {"distribution": "uniform", "low": 1.0, "high": 1.0}, "must be below"),
        (
            "k3",
            {"distribution": "normal", "mean": 1.0, "std": float("nan")},
            "std = nan",
        ),
        ("mu", 0.3, r"mu = 0\.3: a mapping is needed, such as .*'uniform'"),
        ("k1", stats.norm(1.0, 0.1), "k1 = .*: a mapping is needed"),
        ("k1", {"distribution": ["uniform"]}, "one of uniform, normal"),
        (
            3,
            {"distribution": "uniform", "low": 0.0, "high": 1.0},
            "3: no parameter or angle",
        ),
    ],
)
def test_impossible_distributions_are_refused(name, given, words):
    with pytest.raises(ValueError, match=words):
        distribution(name, given)


def test_static_friction_below_that_of_sliding_is_for_laws_that_allow_it():
    static = {"mu_static": {"distribution": "uniform", "low": 0.1, "high": 0.2}}
    given = {"distributions": static, "samples": 64, "t_end": 1.0, "workers": 1}
    rising = FORMER.with_(friction_law="exponential", mu_static=0.2)
    assert propensity(rising, *ANGLES, **given).judged == 64
    with pytest.raises(ValueError, match=r"mu_static reaches 0\.1 and mu 0\.3"):
        propensity(FORMER, *ANGLES, **given)
    given["distributions"] = FRICTION
    with pytest.raises(ValueError, match=r"mu_static reaches 0\.31 and mu"):
        propensity(FORMER.with_(mu_static=0.31), *ANGLES, **given)


def test_what_a_table_stands_for_is_not_spread(tmp_path):
    table = tmp_path / "friction.csv"
    table.write_text("speed,coefficient\n0,0.5\n1,0.4\n2,0.38\n")
    params = FORMER.with_(friction_law=str(table), belt_speed=1.5)
    assert set(centred(params, *ANGLES)) == {"k1", "k2", "k3", "alpha1", "alpha2"}
    with pytest.raises(
        ValueError, match="a law's file stands for mu, which cannot be spread"
    ):
        propensity(params, *ANGLES, distributions=FRICTION, samples=64, t_end=1.0)


@pytest.mark.parametrize("name", ["sigma", "friction_speed", "damping3"])
def test_what_nothing_reads_is_not_spread(name):
    given = {name: {"distribution": "uniform", "low": 0.5, "high": 2.0}}
    with pytest.raises(ValueError, match=f"{name} cannot vary|{name}: the uniform"):
        propensity(FORMER, *ANGLES, distributions=given, samples=64, t_end=1.0)


def test_a_contact_dashpot_is_spread_where_its_law_reads_it():
    given = {"damping3": {"distribution": "uniform", "low": 0.05, "high": 0.5}}
    params = FORMER.with_(contact_law="dashpot", damping3=0.1)
    spread = propensity(params, *ANGLES, distributions=given, samples=64, t_end=1.0)
    assert spread.input.values.tolist() == ["damping3"]


def test_settings_differ_from_the_paper_one_at_a_time():
    params = FORMER.with_(k2=1.3, belt_speed=-2.0)
    found = dict(variants(params))
    assert found["as configured"] == params
    assert found["damping ratio 2 %"].damping2 == pytest.approx(0.04 * np.sqrt(1.3))
    assert found["half λ"].length1 == 0.5 * params.length1
    slow = found["exponential law, |V| = 1 v₀"]
    assert (slow.friction_speed, slow.mu_static) == (2.0, 0.6)
    assert len(set(found.values())) == len(found)


@pytest.mark.release
def test_feasible_sets_are_judged_by_what_was_predicted_alone():
    near = {"kappa": (0.55, 0.75), "mu": (0.2, 0.32), "length_ratio": (4.0, 16.0)}
    inferred = of_study(infer_parameters(FORMER, samples=64, tol=1e-6, **near))
    count = int(inferred.feasible_count)
    names = ["F2a", *inferred.consequence.values.tolist()]
    fitted, *predicted = _feasible(inferred, names)
    assert fitted[-1] == Outcome.not_computed
    assert np.isnan(fitted[0])
    assert count > 0
    for found, name in zip(predicted, names[1:], strict=True):
        one = inferred.sel(consequence=name)
        if count > 1:
            held = round(float(one.feasible_share) * count)
            exact = [one.feasible_share, *wilson_interval(held, count)]
            np.testing.assert_allclose(found[:3], exact, rtol=1e-12)
        assert found[3] == count


def test_statements_without_a_motion_are_no_sample_of_starts(monkeypatch):
    monkeypatch.setattr(robustness, "variants", lambda _: iter(()))
    found = robustness.verdict_robustness(FORMER, starts=4, tol=1e-9, workers=1)
    judged = found.judged.sel(statement=["F2a", "F3", "F6d", "F13"])
    np.testing.assert_array_equal(judged, [[4, 4, 1, 1]] * 2)
    assert (found.share.sel(statement="F6d") == 1.0).all()


def test_distributions_have_the_numbers_that_they_are_given():
    uniform, normal, lognormal = (
        distribution(
            "k1", {"distribution": kind, **dict(zip(names, pair, strict=True))}
        )
        for (kind, names), pair in zip(
            DISTRIBUTIONS.items(), [(2.0, 5.0), (3.0, 0.5), (3.0, 0.2)], strict=True
        )
    )
    assert uniform.support() == (2.0, 5.0)
    assert uniform.mean() == pytest.approx(3.5)
    assert (normal.mean(), normal.std()) == pytest.approx((3.0, 0.5), rel=1e-3)
    # the quantile one standard deviation of the logarithm above the median
    quantiles = lognormal.ppf([0.5, stats.norm.cdf(1.0)])
    assert quantiles == pytest.approx([3.0, 3.0 * np.exp(0.2)])


def test_events_are_those_of_runs_that_are_all_judged():
    """A perturbation along every run, against those alone that lose contact; of some none does."""
    generator = np.random.default_rng(3)
    angles = generator.uniform(0.0, np.pi, (2, 150))
    fields = {**FORMER.as_dict(), "mu": generator.uniform(0.1, 0.6, 150)}
    given = {"tol": 1e-9, "workers": 1}
    run = run_ensemble(fields, *angles, **as_judged(200.0), **given)
    motion, _ = classify_motion(run, SimpleNamespace(**fields))
    lost = np.isfinite(run.first_separation_time)
    kinds = (MotionFlag.irregular_hammering, MotionFlag.whirl)
    expected = np.array([lost, *(motion == kind for kind in kinds)])
    assert (expected.sum(axis=1) > 0).all()
    np.testing.assert_array_equal(_events(fields, *angles, 200.0, **given), expected)
    kept = fields | {"mu": fields["mu"][~lost]}
    assert not _events(kept, *angles[:, ~lost], 200.0, **given).any()
