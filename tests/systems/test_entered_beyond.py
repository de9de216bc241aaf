"""Regimes entered beyond one of their surfaces, and sticking contacts let go by others."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealpipe import Component, Switch, System, labels
from squealpipe.schema import Outcome
from tests.oracles.written import written
from tests.samples import some


def late(y):
    """Regime b is entered at x = ``place`` beyond its surface y = 0."""
    return System(
        "late",
        states={"x": "1", "y": "1", "z": "1"},
        parameters={"place": 1.0},
        regimes={"a": {"rate": 1.0}, "b": {"rate": 2.0}, "c": {"rate": 3.0}},
        field=lambda t, s, p, r: {"x": 1.0, "y": -0.1, "z": r.rate},
        switches=[
            Switch("ab", "a", lambda t, s, p, r: p.place - s.x, "b"),
            Switch("bc", "b", lambda t, s, p, r: s.y, "c"),
        ],
        start={"x": 0.0, "y": y, "z": 0.0, "regime": "a"},
    )


def test_a_regime_entered_beyond_a_surface_is_left_at_once():
    run = late(-0.5).simulate(3.0, sensitivity=["place"])
    np.testing.assert_allclose(run.event_time, [1.0, 1.0], rtol=1e-14)
    assert list(labels(run.event_kind).values) == ["ab", "bc"]
    assert float(run.z[-1]) == pytest.approx(1.0 + 3.0 * 2.0, rel=1e-13)
    # both events move together, so that regime b is never met
    np.testing.assert_allclose(run.event_time_by_place, [1.0, 1.0], rtol=1e-13)
    assert float(run.z_by_place[-1]) == pytest.approx(-2.0, rel=1e-13)


def test_a_perturbation_grows_as_if_there_were_no_regime_between():
    run = late(-0.5).ensemble(3.0, horizon=True)
    # (1, 1, 1)/√3 becomes (1, 1, 1 + 2)/√3: an earlier event brings two units more
    growth = 0.5 * np.log(11.0 / 3.0)
    assert 3.0 * float(run.lyapunov_exponent) == pytest.approx(growth, rel=1e-12)


def test_a_start_in_a_given_regime_beyond_its_surface_leaves_it_at_once():
    run = late(-0.5).simulate(3.0, start={"regime": "b"})
    np.testing.assert_array_equal(run.event_time, [0.0])
    assert late(0.1).simulate(0.5, start={"regime": "b"}).sizes["event"] == 0


def test_a_reset_that_leads_beyond_a_surface_is_followed_by_its_switch():
    jumps = System(
        "jumps",
        states={"x": "1", "y": "1"},
        parameters={},
        regimes={"up": {}, "down": {}},
        field=lambda t, s, p, r: {"x": 1.0, "y": 1.0},
        switches=[
            Switch(
                "jump",
                "up",
                lambda t, s, p, r: 1.0 - s.x,
                "up",
                reset=lambda t, s, p, r: {"x": 0.0, "y": -1.0},
            ),
            Switch("sink", "up", lambda t, s, p, r: s.y, "down"),
        ],
        start={"x": 0.0, "y": 0.5, "regime": "up"},
    )
    run = jumps.simulate(3.0)
    assert list(labels(run.event_kind).values) == ["jump", "sink"]
    np.testing.assert_allclose(run.event_time, [1.0, 1.0], rtol=1e-14)


def test_a_latch_that_catches_more_than_it_holds_lets_go_at_once():
    """The spring pulls with 1.57 times the limit where the mass is caught."""
    latch = System(
        "latch",
        states={"x": "1", "v": "1"},
        parameters={"stiffness": 1.57, "limit": 1.0},
        regimes={"free": {"free": 1.0}, "held": {"free": 0.0}},
        field=lambda t, s, p, r: {"x": r.free * s.v, "v": -r.free * p.stiffness * s.x},
        switches=[
            Switch(
                "caught",
                "free",
                lambda t, s, p, r: 1.0 - s.x,
                "held",
                reset=lambda t, s, p, r: {"v": 0.0},
            ),
            Switch(
                "lets_go",
                "held",
                lambda t, s, p, r: p.limit - p.stiffness * s.x,
                "free",
            ),
        ],
        start={"x": 0.0, "v": 2.0, "regime": "free"},
    )
    omega = np.sqrt(1.57)
    caught = np.arcsin(0.5 * omega) / omega
    run = latch.simulate(caught + 0.75 * np.pi / omega)
    names = run.event_kind.attrs["flag_meanings"].split()
    assert [names[k] for k in run.event_kind.values] == ["caught", "lets_go"]
    np.testing.assert_allclose(run.event_time, [caught, caught], rtol=1e-14)
    # released at rest at x = 1, it swings as a cosine does
    assert float(run.x[-1]) == pytest.approx(-np.sqrt(0.5), rel=1e-12)


def test_two_regimes_beyond_each_others_surface_end_with_a_reason():
    trap = System(
        "trap",
        states={"x": "1"},
        parameters={},
        regimes={"a": {}, "b": {}},
        field=lambda t, s, p, r: {"x": 1.0},
        switches=[
            Switch("ab", "a", lambda t, s, p, r: 1.0 - s.x, "b"),
            Switch("ba", "b", lambda t, s, p, r: 0.5 - s.x, "a"),
        ],
        start={"x": 0.0, "regime": "a"},
    )
    run = trap.simulate(3.0)
    assert Outcome(int(run.outcome)) == Outcome.accumulation
    assert float(run.end_time) == pytest.approx(1.0)


def test_a_stop_that_is_passed_at_the_start_ends_the_run_there():
    gone = System(
        "gone",
        states={"x": "1"},
        parameters={},
        regimes={"only": {}},
        field=lambda t, s, p, r: {"x": 1.0},
        stops={"far": lambda t, s, p, r: 1.0 - s.x},
        start={"x": 2.0},
    )
    run = gone.simulate(3.0)
    assert str(labels(run.outcome).values) == "far"
    assert float(run.end_time) == 0.0


def solved(matrix, right):
    """A small linear system, of floats or symbols, whose leading minors are not singular."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for k, pivot in enumerate(rows):
        for row in rows[k + 1 :]:
            share = row[k] / pivot[k]
            row[k:] = [a - share * b for a, b in zip(row[k:], pivot[k:], strict=True)]
    found = []
    for k, row in reversed(list(enumerate(rows))):
        known = sum(
            (a * b for a, b in zip(row[k + 1 : -1], found, strict=True)), 0.0 * row[k]
        )
        found.insert(0, (row[-1] - known) / row[k])
    return found


class Sticks:
    """Two or three blocks on a belt whose masses and springs are coupled."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        self.n = n = int(rng.integers(2, 4))
        a, b = rng.normal(size=(n, n)), 0.6 * rng.normal(size=(n, n))
        self.stiffness = a @ a.T + np.eye(n)
        self.damping = 0.02 * self.stiffness
        self.mobility = np.linalg.inv(np.eye(n) + b @ b.T)
        self.belt, self.static = rng.uniform(0.2, 0.8), rng.uniform(0.3, 0.5)
        self.load = rng.uniform(0.5, 1.5, n)
        self.start = 0.5 * rng.normal(size=n), rng.uniform(-0.5, 0.1, n)
        self.names = [f"block{i}" for i in range(n)]

    def forces(self, x, v, side, stuck):
        """Elastic and friction forces; those in stick are solved for together."""
        n, w = self.n, self.mobility.tolist()
        terms = zip(self.stiffness.tolist(), self.damping.tolist(), strict=True)
        elastic = [sum(-k[j] * x[j] - d[j] * v[j] for j in range(n)) for k, d in terms]
        slip = [
            0.3 * float(self.load[i]) * side[i] * (1.0 - stuck[i]) for i in range(n)
        ]
        free = [
            sum(w[i][j] * (elastic[j] + slip[j]) for j in range(n)) for i in range(n)
        ]
        matrix = [
            [
                stuck[i] * w[i][j] * stuck[j] + (i == j) * (1.0 - stuck[i])
                for j in range(n)
            ]
            for i in range(n)
        ]
        held = solved(matrix, [-1.0 * (stuck[i] * free[i]) for i in range(n)])
        return elastic, [slip[i] + held[i] for i in range(n)]

    def rates(self, x, v, side, stuck):
        elastic, friction = self.forces(x, v, side, stuck)
        w, n = self.mobility.tolist(), range(self.n)
        return [
            (1.0 - stuck[i]) * sum(w[i][j] * (elastic[j] + friction[j]) for j in n)
            for i in n
        ]

    def system(self):
        n = range(self.n)

        def seen(s, r, instead=None):
            parts = [getattr(r, name) for name in self.names]
            stuck = [1.0 if i == instead else parts[i].stick for i in n]
            x, v = ([getattr(s, f"{q}{i}") for i in n] for q in "xv")
            return x, v, [part.side for part in parts], stuck

        def field(t, s, p, r):
            rates = self.rates(*seen(s, r))
            return {f"x{i}": getattr(s, f"v{i}") for i in n} | {
                f"v{i}": rates[i] for i in n
            }

        def component(i):
            limit, name = float(self.static * self.load[i]), self.names[i]

            def hold(t, s, p, r):
                return self.forces(*seen(s, r, i))[1][i]

            def side(t, s, p, r):
                return getattr(r, name).side

            return Component(
                {
                    "slower": {"side": 1.0, "stick": 0.0},
                    "faster": {"side": -1.0, "stick": 0.0},
                    "stick": {"side": 0.0, "stick": 1.0},
                },
                [
                    Switch(
                        "turn",
                        ("slower", "faster"),
                        lambda t, s, p, r: (
                            side(t, s, p, r) * (self.belt - getattr(s, f"v{i}"))
                        ),
                        to=[
                            (
                                "stick",
                                lambda t, s, p, r: limit**2 - hold(t, s, p, r) ** 2,
                                "stick",
                            ),
                            ("faster", side, "reversal"),
                            ("slower", None, "reversal"),
                        ],
                        reset=lambda t, s, p, r: {f"v{i}": float(self.belt)},
                    ),
                    Switch(
                        "down",
                        "stick",
                        lambda t, s, p, r: limit - hold(t, s, p, r),
                        "slower",
                    ),
                    Switch(
                        "up",
                        "stick",
                        lambda t, s, p, r: limit + hold(t, s, p, r),
                        "faster",
                    ),
                ],
                ["slower"],
            )

        states = [f"{q}{i}" for q in "xv" for i in n]
        return System(
            "sticks",
            states=dict.fromkeys(states, "1"),
            parameters={},
            components={self.names[i]: component(i) for i in n},
            field=field,
            start=dict.fromkeys(states, 0.0),
        )

    def switch(self, z, side, block, name):
        """Carry out a block's switch; the name of the event."""
        n = self.n
        if name != "turn":
            side[block] = 1 if name == "down" else -1
            return name
        stuck = [float(i == block or not side[i]) for i in range(n)]
        hold = self.forces(z[:n], z[n:], side, stuck)[1][block]
        holds = abs(hold) <= self.static * self.load[block]
        side[block] = 0 if holds else -side[block]
        z[n + block] = self.belt
        return "stick" if holds else "reversal"

    @staticmethod
    def violated(here, later):
        """The first surface that is below zero, or at zero and falls."""
        for k, ((*_, height), (*_, next_height)) in enumerate(
            zip(here, later, strict=True)
        ):
            if height < -1e-11 or (height <= 1e-11 and next_height < height - 1e-11):
                return k
        return None

    def independent_run(self, start, side, t_end, most):
        """Events by DOP853; what is violated goes first in order of definition, one at a time."""
        n, side, t, z, found = self.n, list(side), 0.0, np.array(start), []

        def heights(z):
            """The surfaces of block after block, by name."""
            hold = self.forces(z[:n], z[n:], side, [float(not each) for each in side])[
                1
            ]
            for i in range(n):
                limit = self.static * self.load[i]
                if side[i]:
                    yield i, "turn", side[i] * (self.belt - z[n + i])
                else:
                    yield from (
                        (i, "down", limit - hold[i]),
                        (i, "up", limit + hold[i]),
                    )

        def rates(t, z):
            stuck = [float(not each) for each in side]
            return [*z[n:], *self.rates(z[:n], z[n:], side, stuck)]

        def guard(place):
            def height(t, z):
                return list(heights(z))[place][2]

            height.terminal, height.direction = True, -1
            return height

        while len(found) < most:
            here = list(heights(z))
            which = self.violated(here, list(heights(z + 1e-7 * np.array(rates(t, z)))))
            if which is None:
                guards = [guard(k) for k in range(len(here))]
                run = solve_ivp(
                    rates,
                    (t, t_end),
                    z,
                    "DOP853",
                    rtol=1e-12,
                    atol=1e-13,
                    max_step=0.05,
                    events=guards,
                )
                t, z = run.t[-1], run.y[:, -1].copy()
                if run.status != 1:
                    break
                which = next(k for k, times in enumerate(run.t_events) if len(times))
            block, name, _ = here[which]
            name = self.switch(z, side, block, name)
            found.append((t, f"block{block}_{name}"))
        return found, z


def start_of(sticks, held):
    """Places and speeds: of a push, or with the belt."""
    x, v = sticks.start
    return x, np.full(sticks.n, sticks.belt) if held else v


@written
def run_apart(seed, held):
    """Events and last state by DOP853."""
    sticks = Sticks(seed)
    x, v = start_of(sticks, held)
    return sticks.independent_run([*x, *v], [int(not held)] * sticks.n, 20.0, 60)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize(
    "seed",
    [
        *range(3),
        *(pytest.param(n, marks=pytest.mark.release) for n in some(range(3, 30))),
    ],
)
def test_sticking_contacts_are_let_go_in_order_until_nothing_is_violated(seed, held):
    sticks = Sticks(seed)
    x, v = start_of(sticks, held)
    start = {f"x{i}": x[i] for i in range(sticks.n)}
    start |= {f"v{i}": v[i] for i in range(sticks.n)}
    regime = dict.fromkeys(sticks.names, "stick" if held else "slower")
    run = sticks.system().simulate(20.0, start=start | {"regime": regime})
    events, z = run_apart(seed, held)
    assert list(labels(run.event_kind).values[:60]) == [kind for _, kind in events]
    np.testing.assert_allclose(run.event_time[:60], [t for t, _ in events], atol=1e-8)
    if len(events) < 60:
        mine = [float(run[name][-1]) for name in start]
        np.testing.assert_allclose(mine, z, atol=1e-8)
