"""Maps of operating points against own event-driven runs, which share no code with the project.

The list of noises is written from these runs.
"""

from dataclasses import replace

import numpy as np
import pytest

from squealpipe import Contact, Structure, operating_map
from squealpipe.codes import Verdict
from squealpipe.structures import elastic_pad
from squealpipe.structures.assess.measured import matched, read_noises
from squealpipe.structures.assess.operating_points import OperatingPoints
from squealpipe.structures.assess.operating_units import OperatingUnits
from squealpipe.structures.schema.operating_map import Match
from tests.oracles.structure_answers import Motion

UNITS = OperatingUnits("m s-1", np.nan)
MASS, STIFFNESS, PRELOAD = 0.5, 6e6, 3000.0
ROD = np.array([[1.2e7, -1.0e6], [-1.0e6, 8.0e6]])
DAMPING = np.diag([60.0, 60.0])
OVER_TEMPERATURE = {20.0: 0.1, 100.0: 0.3, 300.0: 0.7}
OVER_SPEED = "1:1.1 4:0.8"


def structure():
    contact = Contact("pad", {1: 1.0}, {0: 1.0}, STIFFNESS, PRELOAD)
    return Structure(MASS * np.eye(2), ROD, DAMPING, contacts=[contact], mu=0.5, load=0)


def truth(pressure, speed, mu):
    """Verdict, frequency (Hz), rms velocity (m/s) and share without contact by own runs."""
    step, period = 1.0 / (64 * 900.0), 1.0 / 900.0
    (contact,) = structure().contacts
    pressed = replace(contact, preload=pressure * PRELOAD)
    pad = structure().with_(contacts=[pressed], mu=mu, belt_speed=speed)
    sliding = np.array([*Motion(pad).steady()[0], 0.0, 0.0])
    motion = Motion(pad, sliding + np.array([1e-7, 2e-6, 0.0, 0.0]))
    motion.run(450 * period)
    late = motion.run(150 * period, step)
    away, opened = late["samples"] - sliding, late["open"][0] / (150 * period)
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


def test_a_map_is_run_in_the_modes_that_its_largest_friction_needs():
    """Two modes suffice where friction is small."""
    pad = elastic_pad(elements=(6, 2), contacts=2)
    small, large, both = (
        OperatingPoints.of(pad, mu=mu).reduced().structure
        for mu in ([0.02], [0.7], [0.02, 0.7])
    )
    assert both.size == large.size > small.size
    assert (both.stiffness != large.stiffness).nnz == 0
