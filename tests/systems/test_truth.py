"""Shipped systems against published numbers and closed forms."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from squealpipe.brake.a1.motion_system import brake_of
from squealpipe.functions import sqrt
from squealpipe.schema import Outcome
from squealpipe.systems.motion import MotionKind
from squealpipe.systems.shipped.belt_friction import exponential_oscillator
from squealpipe.systems.shipped.bouncing_ball import bouncing_ball
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator
from squealpipe.systems.shipped.mode_coupling import mode_coupling
from squealpipe.systems.shipped.rigid_pad import (
    LEADING,
    TRAILING,
    approach,
    rigid_pad,
    spring,
)
from tests.oracles.written import written

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.release
def test_the_page_on_systems_runs(capsys):
    page = (ROOT / "docs/systems.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
    scope = {}
    for block in blocks:
        exec(block, scope)  # noqa: S102
    printed = capsys.readouterr().out
    assert "19 impacts, the first at 6.57" in printed
    assert "fold at amplitude 2.073204825806" in printed
    assert scope["found"].outcome.dims == ("x0", "omega")
    assert (scope["found"].rattle > 0).sum("omega").values.tolist() == [3, 3, 3, 4, 4]


def times_of(run, kind):
    names = run.event_kind.attrs["flag_meanings"].split()
    return run.event_time.values[run.event_kind.values == names.index(kind)]


@pytest.mark.parametrize("restitution", [0.9, 0.5])
def test_a_bouncing_ball_comes_to_rest_at_the_closed_form_time(restitution):
    run = bouncing_ball.simulate(20.0, restitution=restitution)
    fall = float(sqrt(2.0 / 9.81))
    limit = fall * (1.0 + restitution) / (1.0 - restitution)
    assert Outcome(int(run.outcome)) == Outcome.accumulation
    assert float(run.end_time) == pytest.approx(limit, rel=1e-12)
    rest = bouncing_ball.ensemble(1.0, start={"y": 0.0}, horizon=True)
    assert Outcome(int(rest.outcome)) == Outcome.accumulation
    assert np.isnan(rest.lyapunov_exponent), "there is no growth in no time"


def test_impacts_without_damping_or_forcing_have_the_period_in_closed_form():
    """From x = −a at rest: the stop is met at cos⁻¹(−g/a), and again after twice that."""
    run = impact_oscillator.simulate(
        100.0, start={"x": -2.0}, amplitude=0.0, damping=0.0, restitution=1.0
    )
    first = np.arccos(-0.5)
    expected = first + 2.0 * first * np.arange(run.sizes["event"])
    np.testing.assert_allclose(run.event_time, expected, rtol=1e-13)
    assert run.sizes["event"] == 24


@pytest.mark.parametrize("omega", [0.7, 1.9])
def test_the_forced_oscillator_meets_its_stop_from_the_grazing_amplitude_on(omega):
    """Its orbit without impacts has amplitude A over the square root below."""
    stiffness = 1.0 - omega**2
    grazing = np.sqrt(stiffness**2 + 0.01 * omega**2)
    for factor, hits in ((1.0 - 1e-9, False), (1.0 + 1e-9, True)):
        amplitude = grazing * factor
        start = {
            "x": factor * stiffness / grazing,
            "v": factor * 0.1 * omega**2 / grazing,
        }
        run = impact_oscillator.ensemble(
            20.0, start=start, amplitude=amplitude, omega=omega
        )
        assert (int(run.count_impact) > 0) == hits


@pytest.mark.parametrize(
    ("mu", "flutters"), [(0.7, False), (0.74, False), (0.76, True)]
)
def test_two_modes_flutter_from_the_published_friction_on(mu, flutters):
    """In contact the run is exp(At); the largest growth rate is Re s with s² = −2 ± √(1 − 4μ/3)."""
    matrix = np.zeros((4, 4))
    matrix[:2, 2:] = np.eye(2)
    matrix[2:, :2] = -np.array([[2.0, -1.0 + 4.0 / 3.0 * mu], [-1.0, 2.0]])
    run = mode_coupling.simulate(100.0, mu=mu, start={"x": 1e-4})
    assert run.sizes["event"] == 0
    exact = expm(100.0 * matrix) @ [1e-4, 0.0, 0.0, 0.0]
    found = [float(run[name][-1]) for name in mode_coupling.states]
    np.testing.assert_allclose(found, exact, rtol=1e-9, atol=1e-14)
    growth = np.linalg.eigvals(matrix).real.max()
    assert growth == pytest.approx(
        np.sqrt(-2 + np.sqrt(1 - 4 / 3 * mu + 0j)).real, abs=1e-7
    )
    assert (growth > 1e-3) == flutters


def energy(s, p):
    """Of masses and springs, those of the contacts among them while they are pressed."""
    stored = 0.5 * p.mass * (s.vx**2 + s.vy**2) + 0.5 * p.inertia * s.spin**2
    for side in (LEADING, TRAILING):
        stored += 0.5 * p.stiffness * (spring(side, s, p)[0] - p.free_length) ** 2
        stored += 0.5 * p.contact_stiffness * np.maximum(approach(side, s, p), 0.0) ** 2
    return stored


@pytest.mark.parametrize("tilt", [0.0, 0.1, -0.3])
def test_a_rigid_pad_that_lifts_off_at_either_edge_gains_what_friction_does(tilt):
    run = rigid_pad.simulate(60.0, start={"theta": tilt})
    s = SimpleNamespace(**{name: run[name].values for name in rigid_pad.states})
    balance = energy(s, SimpleNamespace(**rigid_pad.parameters)) - s.work
    np.testing.assert_allclose(balance, balance[0], rtol=1e-12)


@written
def contacts_apart(tilt, t_end):
    """Instants at which leading and trailing edge lift or land, by DOP853.

    The same field with approaches cut off at zero: continuous, so that one run goes through.
    """
    p, names = SimpleNamespace(**rigid_pad.parameters), rigid_pad.states

    def rates(t, z):
        s = SimpleNamespace(**dict(zip(names, z, strict=True)))
        leading, trailing = (
            float(approach(side, s, p) > 0.0) for side in (LEADING, TRAILING)
        )
        r = SimpleNamespace(
            leading=SimpleNamespace(contact=leading),
            trailing=SimpleNamespace(contact=trailing),
        )
        found = rigid_pad.field(t, s, p, r)
        return [found[name] for name in names]

    def gap(side):
        return lambda t, z: approach(
            side, SimpleNamespace(**dict(zip(names, z, strict=True))), p
        )

    start = [tilt if name == "theta" else 0.0 for name in names]
    own = solve_ivp(
        rates,
        (0.0, t_end),
        start,
        "DOP853",
        rtol=1e-12,
        atol=1e-12,
        max_step=0.02,
        events=[gap(LEADING), gap(TRAILING)],
    )
    return own.t_events


def test_a_rigid_pad_lifts_and_lands_when_dop853_says():
    run = rigid_pad.simulate(30.0, start={"theta": 0.1})
    edges = zip(("leading", "trailing"), contacts_apart(0.1, 30.0), strict=True)
    for name, times in edges:
        found = [times_of(run, f"{name}_{what}") for what in ("lifts", "lands")]
        found = np.sort(np.concatenate(found))
        assert found.size > 2
        np.testing.assert_allclose(found, times, atol=1e-9)


def midpoints(low, high, n):
    return low + (high - low) * (np.arange(n) + 0.5) / n


@pytest.mark.release
def test_the_basin_of_the_fixed_point_has_its_exact_share():
    """0.356596 of [−2, 2] × [0, 2], the area within the unstable cycle, by 800 cells."""
    start = {"x": midpoints(-2.0, 2.0, 40), "v": midpoints(0.0, 2.0, 20)}
    found = exponential_oscillator.basin(1500.0, start=start, belt_speed=1.55)
    assert set(np.unique(found.motion)) == {MotionKind.rest, MotionKind.cycle}
    assert float((found.motion == MotionKind.rest).mean()) == pytest.approx(
        0.35659639, abs=0.01
    )
    assert set(np.unique(found.attractor)) == {0, 1}


def test_a_forced_motion_is_a_cycle_of_so_many_periods_or_unsettled():
    """At ω = 2.1 the cycle of one impact is doubled below A = 3.506188447846."""
    amplitude = np.array([3.5, 3.51])
    found = impact_oscillator.basin(
        4000.0, start={"x": 0.3}, omega=2.1, amplitude=amplitude
    )
    np.testing.assert_allclose(
        found.period * 2.1 / (2.0 * np.pi), [2.0, 1.0], rtol=1e-12
    )
    # from −1 the motion is still so far from its cycle that three periods differ by less than one
    found = impact_oscillator.basin(500.0, start={"x": [-1.0, 0.0, 1.0]}, omega=1.4)
    np.testing.assert_allclose(found.period * 1.4 / (2.0 * np.pi), 1.0, rtol=1e-12)
    early = impact_oscillator.basin(
        20.0, start={"x": 0.3}, omega=2.1, amplitude=amplitude
    )
    assert (early.motion == MotionKind.unsettled).all()
    assert np.isnan(early.period).all()


def test_systems_are_found_where_the_first_release_had_them():
    from squealpipe.systems.impact_oscillator import impact_oscillator as former

    from squealpipe.systems import impact_oscillator as module

    assert former is module.impact_oscillator
    assert repr(former) == repr(impact_oscillator)
    from squealpipe.systems.brake import brake_of as former_brake

    assert former_brake is brake_of
    with pytest.raises(ModuleNotFoundError, match="no_such_system"):
        import squealpipe.systems.no_such_system  # noqa: F401
