"""Maps of operating points against own event-driven runs, which share no code with the project.

Between events the pad is linear, so that each step is a matrix exponential; events are located by
Brent's method. The list of noises is written from these runs.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from squealpipe import Contact, Structure, operating_map
from squealpipe.codes import Verdict
from squealpipe.structures.assess.measured import matched, read_noises
from squealpipe.structures.assess.operating_units import OperatingUnits
from squealpipe.structures.schema.operating_map import Match

UNITS = OperatingUnits("m s-1", np.nan)
MASS, STIFFNESS, PRELOAD = 0.5, 6e6, 3000.0
ROD = np.array([[1.2e7, -1.0e6], [-1.0e6, 8.0e6]])
DAMPING = np.diag([60.0, 60.0])
OVER_TEMPERATURE = {20.0: 0.1, 100.0: 0.3, 300.0: 0.7}
OVER_SPEED = "1:1.1 4:0.8"


def structure():
    contact = Contact("pad", {1: 1.0}, {0: 1.0}, STIFFNESS, PRELOAD)
    return Structure(MASS * np.eye(2), ROD, DAMPING, contacts=[contact], mu=0.5, load=0)


class Pad:
    """Two degrees of freedom on a belt: state x, y, vx, vy, the contact pressed along −y."""

    def __init__(self, pressure, speed, mu, step):
        self.preload, self.speed, self.mu = pressure * PRELOAD, speed, mu
        self.step = step
        self.powers, self.whole = {}, {}
        at = np.linalg.solve(
            ROD + STIFFNESS * np.array([[0.0, mu * np.sign(speed)], [0.0, 1.0]]),
            self.preload * np.array([mu * np.sign(speed), 1.0]),
        )
        self.sliding = np.array([*at, 0.0, 0.0])

    def law(self, regime):
        """Affine acceleration of a regime, as the matrix of (state, 1)."""
        a = np.zeros((5, 5))
        a[:2, 2:4] = np.eye(2)
        a[2:4, :2], a[2:4, 2:4] = -ROD / MASS, -DAMPING / MASS
        if regime != "open":
            a[3, 1] -= STIFFNESS / MASS
            a[3, 4] = self.preload / MASS
        if regime in (1, -1):
            a[2, 1] -= regime * self.mu * STIFFNESS / MASS
            a[2, 4] = regime * self.mu * self.preload / MASS
        if regime == "stick":
            a[2] = 0.0
        return a

    def after(self, state, regime, time):
        """State after a time, by the series of the matrix exponential to order 16."""
        if regime not in self.powers:
            a, power, powers = self.law(regime), np.eye(5), []
            for order in range(17):
                powers.append(power)
                power = a @ power / (order + 1)
            self.powers[regime] = np.array(powers)[:, :4]
            self.whole[regime] = sum(
                power * self.step**order
                for order, power in enumerate(self.powers[regime])
            )
        start = np.array([*state, 1.0])
        if time == self.step:
            return self.whole[regime] @ start
        return time ** np.arange(17) @ (self.powers[regime] @ start)

    def force(self, state):
        return self.preload - STIFFNESS * state[1]

    def held(self, state):
        """Friction that stick needs."""
        return ROD[0] @ state[:2] + DAMPING[0] @ state[2:]

    def limits(self, state, regime):
        """Quantities that are positive while a regime lasts."""
        normal, slip = self.force(state), self.speed - state[2]
        if regime == "open":
            return [-normal]
        if regime == "stick":
            return [normal, self.mu * normal - abs(self.held(state))]
        return [normal, regime * slip]

    def next(self, state, regime, ended):
        """Regime after the limit of that number was reached."""
        if regime == "open":
            return int(np.sign(self.speed - state[2])) or 1
        if ended == 0:
            return "open"
        if regime == "stick":
            return int(np.sign(self.held(state)))
        state[2] = self.speed
        if abs(self.held(state)) < self.mu * self.force(state):
            return "stick"
        return int(np.sign(self.held(state)))

    def run(self, periods, per_period=64):
        """Samples of the last quarter, and the share of the time without contact."""
        state = self.sliding + np.array([1e-7, 2e-6, 0.0, 0.0])
        regime = int(np.sign(self.speed))
        count = periods * per_period
        kept, opened = [], 0.0
        for number in range(count):
            left = self.step
            late = number >= 3 * count // 4
            while left > 0.0:
                reached = self.after(state, regime, left)
                gone = [
                    i
                    for i, value in enumerate(self.limits(reached, regime))
                    if value < 0.0
                ]
                at, ended = left, None
                for i in gone:

                    def limit(time, i=i, state=state, regime=regime):
                        return self.limits(self.after(state, regime, time), regime)[i]

                    start = 1e-9 * self.step
                    root = brentq(limit, start, left) if limit(start) > 0 else start
                    if root < at or ended is None:
                        at, ended = root, i
                opened += at * (late and regime == "open")
                if ended is None:
                    state, left = reached, 0.0
                else:
                    state = self.after(state, regime, at)
                    regime, left = self.next(state, regime, ended), left - at
            if late:
                kept.append(state)
        return np.array(kept), opened / (len(kept) * self.step)


def truth(pressure, speed, mu):
    """Verdict, frequency (Hz), rms velocity (m/s) and share without contact by own runs."""
    step = 1.0 / (64 * 900.0)
    pad = Pad(pressure, speed, mu, step)
    samples, opened = pad.run(600)
    away = samples - pad.sliding
    velocity = np.sqrt((away[:, 2:] ** 2).mean(axis=0).sum())
    if velocity < 1e-4:
        return Verdict.quiet, np.nan, 0.0, 0.0
    loud = away[:, 2 + int(away[:, 2:].std(axis=0).argmax())]
    spectrum = np.abs(np.fft.rfft((loud - loud.mean()) * np.hanning(len(loud)), 2**19))
    frequency = np.fft.rfftfreq(2**19, step)[spectrum.argmax()]
    verdict = Verdict.hammers if opened > 0 else Verdict.squeals
    return verdict, frequency, velocity, opened


def friction(temperature, speed):
    knots = list(OVER_TEMPERATURE)
    over = np.interp(temperature, knots, [OVER_TEMPERATURE[each] for each in knots])
    return over * np.interp(abs(speed), [1.0, 4.0], [1.1, 0.8])


AXES = {
    "pressure": [0.5, 1.0, 2.0],
    "speed": [-2.0, 1.0, 2.0, 4.0],
    "temperature": [20.0, 60.0, 150.0, 220.0, 300.0],
}


def mapped(axes, **options):
    tables = {"temperature": OVER_TEMPERATURE, "speed": OVER_SPEED}
    return operating_map(structure(), **axes, mu_of=tables, workers=1, **options)


def confirm(points, axes, places):
    """Compare some points with own runs; return what was seen there."""
    seen = []
    for place in places:
        at = [
            float(points[name].values[i]) for name, i in zip(axes, place, strict=True)
        ]
        one = points.isel(dict(zip(axes, place, strict=True)))
        pressure, speed, temperature = at
        mu = friction(temperature, speed)
        assert float(one.friction) == pytest.approx(mu, rel=1e-12)
        verdict, frequency, velocity, opened = truth(pressure, speed, mu)
        assert Verdict(int(one.verdict)) is verdict, at
        seen.append((verdict, at, frequency))
        if verdict is Verdict.quiet:
            assert np.isnan(one.frequency)
            continue
        assert float(one.frequency) == pytest.approx(frequency, rel=1e-2)
        assert float(one.velocity_rms) == pytest.approx(velocity, rel=1e-2)
        assert float(one.separated_fraction) == pytest.approx(opened, abs=1e-2)
        level = 20.0 * np.log10(velocity / 5e-8)
        assert float(one.velocity_level) == pytest.approx(level, abs=0.2)
    return seen


def test_two_points_are_those_of_own_event_driven_runs():
    axes = {"pressure": [2.0], "speed": [1.0], "temperature": [20.0, 220.0]}
    seen = confirm(mapped(axes), axes, [(0, 0, 0), (0, 0, 1)])
    assert [verdict for verdict, *_ in seen] == [Verdict.quiet, Verdict.squeals]


@pytest.mark.release
def test_sixty_points_are_confirmed_and_a_list_from_own_runs_is_matched(tmp_path):
    """Every tenth point, and six more, since the tenths alone miss a kind of motion."""
    shape = tuple(map(len, AXES.values()))
    assert np.prod(shape) == 60
    places = [
        np.unravel_index(i, shape) for i in (*range(0, 60, 10), *range(4, 60, 10))
    ]
    noises = tmp_path / "noises.csv"
    head = "pressure;speed [km/h];temperature [°C];frequency [Hz];level [dB]\n"
    noises.write_text(head + "1;3,6;20;;\n", encoding="utf-8")
    points = mapped(AXES, measured=noises)
    seen = confirm(points, AXES, places)
    assert {verdict for verdict, *_ in seen} >= {Verdict.quiet, Verdict.hammers}
    lines, expected = [], []
    for number, (verdict, (pressure, speed, temperature), frequency) in enumerate(seen):
        heard, match = {
            (True, 0): (frequency * 1.03, Match.hit),
            (True, 1): (frequency * 0.9, Match.miss),
            (True, 2): (None, Match.false_alarm),
            (False, 0): (None, Match.both_quiet),
            (False, 1): (800.0, Match.miss),
            (False, 2): (None, Match.both_quiet),
        }[verdict is not Verdict.quiet, number % 3]
        text = "" if heard is None else f"{heard:.3f}"
        row = (pressure, 3.6 * speed, temperature)
        lines.append(";".join([*(f"{each:g}" for each in row), text, ""]))
        expected.append(match)
    noises.write_text(head.replace(",", ".") + "\n".join(lines), encoding="utf-8")
    again = matched(points, read_noises(noises, UNITS), 0.05)
    assert [Match(each) for each in again["match"]] == expected
    assert again["hits"] == expected.count(Match.hit) > 0
    assert again["misses"] == expected.count(Match.miss) > 0
    assert again["false_alarms"] == expected.count(Match.false_alarm) > 0
