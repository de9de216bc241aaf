"""Shipped systems against published numbers and closed forms."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from squealpipe.functions import sqrt
from squealpipe.schema import Outcome
from squealpipe.systems.belt_friction import exponential_oscillator, leine_oscillator
from squealpipe.systems.bouncing_ball import bouncing_ball
from squealpipe.systems.impact_oscillator import impact_oscillator

ROOT = Path(__file__).resolve().parents[2]


def test_the_page_on_systems_runs(capsys):
    page = (ROOT / "docs/systems.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL)
    scope = {}
    for block in blocks:
        exec(block, scope)  # noqa: S102
    assert "19 impacts, the first at 6.57" in capsys.readouterr().out
    assert scope["found"].outcome.dims == ("x0", "omega")


def times_of(run, kind):
    names = run.event_kind.attrs["flag_meanings"].split()
    return run.event_time.values[run.event_kind.values == names.index(kind)]


def test_leines_oscillator_has_its_published_period_and_slip_time():
    run = leine_oscillator.simulate(100.0)
    sticks, slips = times_of(run, "stick"), times_of(run, "slip")
    assert np.diff(slips)[-1] == pytest.approx(12.001031295, abs=2e-9)
    assert (sticks[-1] - slips[slips < sticks[-1]][-1]) == pytest.approx(4.295999525, abs=2e-9)


@pytest.mark.parametrize("restitution", [0.9, 0.5])
def test_a_bouncing_ball_comes_to_rest_at_the_closed_form_time(restitution):
    run = bouncing_ball.simulate(20.0, restitution=restitution)
    fall = float(sqrt(2.0 / 9.81))
    limit = fall * (1.0 + restitution) / (1.0 - restitution)
    assert Outcome(int(run.outcome)) == Outcome.accumulation
    assert float(run.end_time) == pytest.approx(limit, rel=1e-12)


def test_impacts_without_damping_or_forcing_have_the_period_in_closed_form():
    """From x = −a at rest: the stop is met at cos⁻¹(−g/a), and again after twice that."""
    run = impact_oscillator.simulate(
        100.0, start={"x": -2.0}, amplitude=0.0, damping=0.0, restitution=1.0
    )
    first = np.arccos(-0.5)
    expected = first + 2.0 * first * np.arange(run.sizes["event"])
    np.testing.assert_allclose(run.event_time, expected, rtol=1e-13)
    assert run.sizes["event"] == 24


def test_the_unstable_cycle_divides_the_starts_of_the_exponential_oscillator():
    """Its amplitude at V = 1.25 is 0.664228586 about x* = 0.5 + 0.5 exp(−2V)."""
    centre = 0.5 + 0.5 * np.exp(-2.5)
    starts = centre + 0.664228586 * np.array([1.0 - 1e-4, 1.0 + 1e-4])
    found = exponential_oscillator.ensemble(600.0, start={"x": starts}, belt_speed=1.25)
    assert float(found.late_x_max[0] - found.late_x_min[0]) < 1.0
    assert float(found.late_x_max[1] - found.late_x_min[1]) > 1.5
