"""Curves of special cycles in two parameters against closed forms."""

import numpy as np
import pytest
from scipy.linalg import expm

from squealpipe import Switch, System
from squealpipe.functions import cos
from squealpipe.systems.branch_labels import Meeting
from squealpipe.systems.shipped.belt_friction import exponential_oscillator
from squealpipe.systems.shipped.dry_friction import dry_friction_oscillator
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator

DAMPING, GAP, RESTITUTION = 0.1, 1.0, 0.8
CORNERS = {0.998749217771909: 0.0999062060134404, 1.997498435543818: 2.996664812754339}
"""Where fold curves end on the grazing curve: frequency and amplitude, from 30 digits."""
ENDS = {"omega": (0.8, 3.0), "amplitude": (0.0, 20.0)}


def one_impact(omega):
    """Of the cycle with one impact: the flow over a period, and the forced motion at the impact.

    Over the impact velocity v the forced motion is ``fixed + v by_speed``.
    """
    flow = expm(np.array([[0.0, 1.0], [-1.0, -DAMPING]]) * 2 * np.pi / omega)
    inverse = np.linalg.inv(np.eye(2) - flow)
    fixed = inverse @ ((np.eye(2) - flow) @ [GAP, 0.0])
    return flow, fixed, inverse @ (np.array([0.0, 1.0]) + flow @ [0.0, RESTITUTION])


def amplitude(omega, speed):
    _, fixed, by_speed = one_impact(omega)
    forced = (fixed + speed * by_speed) / [1.0, omega]
    return np.linalg.norm(forced) * np.hypot(1.0 - omega**2, DAMPING * omega)


def trace(omega, amplitude, damping):
    """Of the monodromy of the cycle with one impact, which is the faster of the two."""
    flow = expm(np.array([[0.0, 1.0], [-1.0, -damping]]) * 2 * np.pi / omega)
    inverse = np.linalg.inv(np.eye(2) - flow)
    fixed = inverse @ ((np.eye(2) - flow) @ [GAP, 0.0]) / [1.0, omega]
    by_speed = (
        inverse @ (np.array([0.0, 1.0]) + flow @ [0.0, RESTITUTION]) / [1.0, omega]
    )
    size = amplitude / np.hypot(1.0 - omega**2, damping * omega)
    square, cross = by_speed @ by_speed, fixed @ by_speed
    speed = (-cross + np.sqrt(cross**2 - square * (fixed @ fixed - size**2))) / square
    forced = (fixed + speed * by_speed) * [1.0, omega]
    push = (1.0 - omega**2) * forced[0] + damping * forced[1] - GAP
    jump = RESTITUTION * (push - damping * speed) + push + damping * RESTITUTION * speed
    return -RESTITUTION * np.trace(flow) + jump * flow[0, 1] / speed


def fold(omega):
    _, fixed, by_speed = (
        each / [1.0, omega] if each.ndim == 1 else each for each in one_impact(omega)
    )
    return amplitude(omega, -(fixed @ by_speed) / (by_speed @ by_speed))


def flip(omega):
    flow, fixed, by_speed = one_impact(omega)

    def determinant(speed):
        """Of monodromy + 1, times the speed: linear in it."""
        forced = fixed + speed * by_speed
        push = (1.0 - omega**2) * forced[0] + DAMPING * forced[1] - GAP
        before, after = push - DAMPING * speed, push + DAMPING * RESTITUTION * speed
        fixed_part = -RESTITUTION * flow * speed
        turned = fixed_part + np.outer([0.0, RESTITUTION * before + after], flow[0])
        return speed * (1.0 + RESTITUTION**2 * np.linalg.det(flow)) + np.trace(turned)

    none, one = determinant(0.0), determinant(1.0)
    return amplitude(omega, none / (none - one))


@pytest.fixture(scope="module")
def branch():
    start = impact_oscillator.limit_cycle(omega=1.9, amplitude=2.2)
    return impact_oscillator.cycle_branch("amplitude", 4.0, start=start)


def curve_of(label, start, **options):
    return impact_oscillator.cycle_curve(
        label, ("omega", "amplitude"), start=start, **options
    )


def corners(curve):
    at = np.flatnonzero(curve.label.values == Meeting.fold_grazing)
    return dict(zip(curve.omega.values[at], curve.amplitude.values[at], strict=True))


def ends(curve):
    return [
        curve.outcome.attrs["flag_meanings"].split()[i] for i in curve.outcome.values
    ]


def test_grazing_curve_and_where_folds_meet_it(branch):
    curve = curve_of("grazing", branch, to=ENDS)
    omega = curve.omega.values
    exact = np.hypot(1.0 - omega**2, DAMPING * omega)
    np.testing.assert_allclose(curve.amplitude, exact, rtol=1e-12)
    found = corners(curve)
    assert list(found) == pytest.approx(list(CORNERS), abs=1e-12)
    assert list(found.values()) == pytest.approx(list(CORNERS.values()), abs=1e-12)
    assert ends(curve) == ["end_of_range", "end_of_range"]
    assert (omega[0], omega[-1]) == pytest.approx(ENDS["omega"], abs=1e-12)


def test_grazing_curve_starts_from_a_branch_that_first_touches_the_stop():
    """Round-off showed a touch where the impact without speed is, and the curve had one point."""
    omega, damping, gap = 1.7, 0.12, 1.27
    settings = {"omega": omega, "damping": damping, "gap": gap, "restitution": 0.62}
    grazes = gap * np.hypot(1.0 - omega**2, damping * omega)
    forced = 0.8 * grazes / complex(1.0 - omega**2, damping * omega)
    start = impact_oscillator.limit_cycle(
        guess={"x": forced.real, "v": -omega * forced.imag},
        amplitude=0.8 * grazes,
        **settings,
    )
    through = impact_oscillator.cycle_branch("amplitude", 1.2 * grazes, start=start)
    curve = curve_of("grazing", through, to={"omega": (1.5, 2.2)})
    omega = curve.omega.values
    exact = gap * np.hypot(1.0 - omega**2, damping * omega)
    np.testing.assert_allclose(curve.amplitude, exact, rtol=1e-12)
    assert ends(curve) == ["end_of_range", "end_of_range"]
    # folds end where the stop is met twice in a period of the free oscillation
    assert list(corners(curve)) == pytest.approx(
        [2.0 * np.sqrt(1.0 - 0.25 * damping**2)], abs=1e-10
    )


def test_fold_curve_ends_on_the_grazing_curve_at_both_sides(branch):
    curve = curve_of("fold", branch)
    exact = [fold(omega) for omega in curve.omega.values]
    np.testing.assert_allclose(curve.amplitude, exact, rtol=1e-10)
    assert fold(1.9) == pytest.approx(2.073204825805628, abs=1e-13)
    found = corners(curve)
    assert list(found) == pytest.approx(list(CORNERS), abs=1e-10)
    assert list(found.values()) == pytest.approx(list(CORNERS.values()), abs=1e-10)
    assert ends(curve) == ["order_changes_speed_of_impact"] * 2
    assert float(curve.residual.max()) < 1e-12


def test_curve_of_period_doublings():
    guess = {"x": -1.5, "v": 0.5}
    start = impact_oscillator.limit_cycle(omega=2.1, amplitude=4.5, guess=guess)
    start = impact_oscillator.cycle_branch("amplitude", 2.5, start=start)
    assert flip(2.1) == pytest.approx(3.506188447846005, abs=1e-12)
    curve = curve_of("period_doubling", start, to=ENDS)
    exact = [flip(omega) for omega in curve.omega.values]
    np.testing.assert_allclose(curve.amplitude, exact, rtol=1e-10)
    assert Meeting.flip_grazing in curve.label
    assert set(ends(curve)) == {"order_changes_speed_of_impact", "end_of_range"}


def test_curve_of_tori():
    """Where multipliers have the modulus 1: r² exp(−2π c/ω) = 1, until they meet at −1."""
    guess = {"x": -1.5, "v": 0.5}
    start = impact_oscillator.limit_cycle(omega=2.1, amplitude=4.5, guess=guess)
    start = impact_oscillator.cycle_branch("damping", -0.25, start=start)
    curve = impact_oscillator.cycle_curve(
        "torus", ("omega", "damping"), start=start, n_points=60
    )
    omega, damping = curve.omega.values, curve.damping.values
    np.testing.assert_allclose(damping, omega / np.pi * np.log(RESTITUTION), rtol=1e-12)
    assert set(ends(curve)) == {"multipliers_are_real", "point_limit"}
    for meeting, angle in (("2", np.pi), ("3", 2 * np.pi / 3), ("4", np.pi / 2)):
        (at,) = np.flatnonzero(curve.label.values == Meeting[f"resonance_1_{meeting}"])
        assert trace(omega[at], 4.5, damping[at]) == pytest.approx(
            2 * np.cos(angle), abs=1e-9
        )


def test_the_onset_of_stick_is_followed_in_belt_speed_and_damping():
    """Against the same onset found on branches in the speed alone, at other dampings."""
    system = exponential_oscillator
    start = system.cycle_branch(
        "belt_speed", 1.9, start=system.limit_cycle(belt_speed=1.25)
    )
    pair = ("belt_speed", "damping")
    curve = system.cycle_curve(
        "stick_onset", pair, start=start, to={"damping": (0.08, 0.12)}
    )
    at = int(np.argmin(np.abs(curve.damping.values - 0.1)))
    assert float(curve.belt_speed[at]) == pytest.approx(1.83660097221, abs=2e-11)
    assert ends(curve) == ["end_of_range", "end_of_range"]
    for end in (0, -1):
        damping = float(curve.damping[end])
        cycle = system.limit_cycle(belt_speed=1.25, damping=damping)
        other = system.cycle_branch("belt_speed", 2.6, start=cycle)
        onset = int(np.argmax(other.label.values == 5))
        assert float(curve.belt_speed[end]) == pytest.approx(
            float(other.belt_speed[onset]), abs=1e-10
        )


@pytest.mark.release
def test_folds_of_a_hardening_spring_are_born_in_the_cusp():
    """On this side of it a branch has no fold, on the other two."""
    system = System(
        "hardening spring",
        states={"x": "m", "v": "m/s"},
        parameters={"force": 0.3, "omega": 1.8, "damping": 0.2},
        regimes={"free": {}},
        field=lambda t, s, p, r: {
            "x": s.v,
            "v": p.force * cos(p.omega * t) - p.damping * s.v - s.x - s.x * s.x * s.x,
        },
        switches=[
            Switch(
                "far",
                leaves="free",
                when=lambda t, s, p, r: 50.0 - s.x,
                to="free",
                reset=lambda t, s, p, r: {"v": -s.v},
            )
        ],
        start={"x": 0.0, "v": 0.0},
        period=lambda p: 2 * np.pi / p.omega,
    )

    def branch_at(force):
        return system.cycle_branch("omega", 1.0, start=system.limit_cycle(force=force))

    limits = {"omega": (1.0, 2.0), "force": (0.1, 0.5)}
    curve = system.cycle_curve(
        "fold", ("omega", "force"), start=branch_at(0.3), to=limits
    )
    (cusp,) = np.flatnonzero(curve.label.values == Meeting.cusp)
    force = float(curve.force[cusp])
    assert force == curve.force.values.min()
    assert [int((branch_at(f * force).label == 1).sum()) for f in (0.98, 1.02)] == [
        0,
        2,
    ]


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"label": "folds"}, "fold"),
        ({"parameters": ("omega", "omga")}, "omga"),
        ({"parameters": ("omega", "omega")}, "two names"),
        ({"to": {"omega": (2.0, 1.0)}}, "ascend"),
        ({"to": {"omega": (2.0, 3.0)}}, "outside"),
        ({"n_points": 1}, "n_points = 1"),
        ({"label": "period_doubling"}, "no point of period_doubling"),
    ],
)
def test_what_cannot_be_followed_is_refused(branch, given, message):
    call = {
        "label": "fold",
        "parameters": ("omega", "amplitude"),
        "start": branch,
    } | given
    with pytest.raises(ValueError, match=message):
        impact_oscillator.cycle_curve(**call)


@pytest.mark.parametrize("to", [0.3, pytest.param(2.0, marks=pytest.mark.release)])
def test_onsets_of_stick_of_a_symmetric_motion_end_where_the_push_no_longer_falls(to):
    """The condition at the other reversal is zero all along: its sign ended curves 2 % early."""
    start = dry_friction_oscillator.limit_cycle(omega=0.95)
    branch = dry_friction_oscillator.cycle_branch("omega", to, start=start)
    curve = dry_friction_oscillator.cycle_curve(
        "stick_onset", ("omega", "force"), start=branch, to={"omega": (0.3, 1.8)}
    )
    slowest = curve.isel(point=int(curve.omega.values.argmin()))
    # at a reversal push + 1 and its rate both vanish: closed form of half a period without stick
    expected = 0.47593188, 4.02759878
    assert (float(slowest.omega), float(slowest.force)) == pytest.approx(
        expected, abs=1e-8
    )
