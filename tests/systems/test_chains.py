"""Shipped systems with components against integrators apart: a chain of blocks, a gear pair."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from squealpipe.systems.burridge_knopoff import burridge_knopoff
from squealpipe.systems.gear_pair import gear_pair

from squealpipe import labels
from tests.oracles.written import written


class Blocks:
    """The chain in arrays: side 1 slower than the belt, −1 faster, 0 stuck."""

    def __init__(self, system):
        self.p, self.n = system.parameters, len(system.states) // 2
        self.state = np.array([system.start[name] for name in system.states])
        coupling = self.p["coupling"]
        self.matrix = np.diag(np.full(self.n, -self.p["stiffness"]))
        for i in range(self.n - 1):
            for a, b in ((i, i + 1), (i + 1, i)):
                self.matrix[a, a] -= coupling
                self.matrix[a, b] += coupling
        self.side = np.ones(self.n)

    def rates(self, _t, z):
        x, v = z[: self.n], z[self.n :]
        away = self.side * (self.p["belt_speed"] - v)
        force = self.side * self.p["limit"] / (1.0 + self.p["fall"] * away)
        moved = (self.matrix @ x + force) / self.p["mass"]
        return np.concatenate([v, np.where(self.side == 0.0, 0.0, moved)])

    def guards(self):
        """(block, side that its switch leads to, height) of all that may end a leg."""
        for i in range(self.n):
            if self.side[i]:
                yield (
                    i,
                    0,
                    lambda t, z, i=i: (
                        self.side[i] * (self.p["belt_speed"] - z[self.n + i])
                    ),
                )
            else:
                for sign in (1, -1):
                    yield (
                        i,
                        sign,
                        lambda t, z, i=i, sign=sign: (
                            self.p["limit"] + sign * self.matrix[i] @ z[: self.n]
                        ),
                    )

    def run(self, most):
        """(time, block, what happens, state after it) of so many events."""
        time, found = 0.0, []
        while len(found) < most:
            guards = list(self.guards())
            for _, _, height in guards:
                height.terminal, height.direction = True, -1
            # a block that leaves the belt's speed may be back at once
            for length, step in ((0.02, 5e-4), (50.0, 0.02)):
                leg = solve_ivp(
                    self.rates,
                    (time, time + length),
                    self.state,
                    method="DOP853",
                    events=[height for _, _, height in guards],
                    rtol=3e-14,
                    atol=1e-15,
                    max_step=step,
                )
                time, self.state = leg.t[-1], leg.y[:, -1]
                if leg.status == 1:
                    break
            place = next(k for k, times in enumerate(leg.t_events) if times.size)
            block, leads, _ = guards[place]
            if leads:
                what, self.side[block] = "slip", leads
            else:
                self.state[self.n + block] = self.p["belt_speed"]
                pull = self.matrix[block] @ self.state[: self.n]
                stuck = abs(pull) <= self.p["limit"]
                what = "stick" if stuck else "reversal"
                self.side[block] = 0.0 if stuck else -self.side[block]
            found.append((time, block, what, self.state.copy()))
        return found


@pytest.mark.release
def test_ten_blocks_on_a_belt_agree_over_200_events():
    system = burridge_knopoff(10)
    truth = Blocks(system).run(200)
    end = truth[-1][0]
    run = system.simulate(end + 1e-6, times=np.array([0.0, end]))
    names = [str(each) for each in labels(run.event_kind).values[:200]]
    assert names == [f"block{block + 1}_{what}" for _, block, what, _ in truth]
    times = np.array([time for time, *_ in truth])
    assert np.abs(run.event_time.values[:200] - times).max() < 1e-8
    final = np.array([run[name].values[-1] for name in system.states])
    assert np.abs(final - truth[-1][3]).max() < 1e-8
    assert {"slip", "stick", "reversal"} == {what for _, _, what, _ in truth}


def flank_motion(p, side, t0, x0, v0):
    """x and v as functions of time on one flank (±1) or between them (0), in closed form."""
    z, w, f = p["damping"], p["omega"], p["amplitude"]
    k = abs(side)
    steady = f / complex(k - w * w, 2.0 * z * w)

    def forced(t):
        turn = steady * np.exp(1j * w * t)
        level = p["mean"] + side * p["gap"] if k else p["mean"] * t / (2.0 * z)
        drift = 0.0 if k else p["mean"] / (2.0 * z)
        return level + turn.real, drift + (1j * w * turn).real

    a, b = x0 - forced(t0)[0], v0 - forced(t0)[1]

    def at(t):
        s, (x, v) = t - t0, forced(t)
        if not k:
            decay = np.exp(-2.0 * z * s)
            return x + a + b * (1.0 - decay) / (2.0 * z), v + b * decay
        root = np.sqrt(1.0 - z * z)
        c, d, e = np.cos(root * s), np.sin(root * s), np.exp(-z * s)
        rest = (b + z * a) / root
        return (x + e * (a * c + rest * d), v + e * (b * c - (z * rest + root * a) * d))

    return at


@written
def gear_events(p, x, v, most):
    """(time, name) of the events, by closed forms and a search in small steps."""
    side, time, found = 1, 0.0, []

    def height(t, at, wall):
        return at(t)[0] - wall * p["gap"]

    while len(found) < most:
        at = flank_motion(p, side, time, x, v)
        walls = (side,) if side else (1, -1)
        left, hits = time + 1e-9, []
        while not hits:
            right = left + 0.002
            hits = [
                (brentq(height, left, right, (at, wall), xtol=1e-15), wall)
                for wall in walls
                if height(left, at, wall) * height(right, at, wall) < 0.0
            ]
            left = right
        time, which = hits[0]
        x, v = which * p["gap"], at(time)[1]
        name = "drive" if which > 0 else "coast"
        found.append((time, f"{name}_{'parts' if side else 'meets'}"))
        side = 0 if side else which
    return found


def test_a_gear_pair_agrees_with_closed_forms_over_60_events():
    truth = gear_events(gear_pair.parameters, 1.1, 0.0, 60)
    times, names = map(list, zip(*truth, strict=True))
    run = gear_pair.simulate(times[-1] + 1e-6)
    assert [str(each) for each in labels(run.event_kind).values] == names
    every = {
        f"{flank}_{what}" for flank in ("drive", "coast") for what in ("meets", "parts")
    }
    assert set(names) == every
    np.testing.assert_allclose(run.event_time, times, rtol=0, atol=1e-8)
