"""A system with other constants of its regimes is the one that is traced with them."""

import numpy as np
import pytest

from squealpipe.brake.a1.motion_system import brake
from squealpipe.laws.tables import scaled
from squealpipe.systems.system import Switch, System


def spring(stiffness, softer):
    """A mass between two springs, of which the one on the left is softer."""
    return System(
        "two springs",
        states={"x": "m", "v": "m/s"},
        parameters={"mass": stiffness},
        regimes={"left": {"k": softer}, "right": {"k": stiffness}},
        field=lambda t, s, p, r: {"x": s.v, "v": -r.k * s.x / p.mass},
        switches=[
            Switch("to the right", "left", lambda t, s, p, r: -s.x, "right"),
            Switch("to the left", "right", lambda t, s, p, r: s.x, "left"),
        ],
        start={"x": 1.0, "v": 0.0},
    )


def test_its_runs_are_those_of_the_system_that_is_traced_anew():
    first, wanted = spring(1.0, 0.5), spring(3.0, 0.2)
    before = first.simulate(t_end=9.0).x.values
    made = first.with_numbers(wanted.regimes, wanted.parameters)
    for run, expected in (
        (made.simulate(t_end=9.0), wanted.simulate(t_end=9.0)),
        (first.simulate(t_end=9.0), None),
    ):
        np.testing.assert_array_equal(
            run.x.values, before if expected is None else expected.x.values
        )
    assert made.text == wanted.text
    # half a period on either side: π √(m/k)
    crossings = made.simulate(t_end=20.0).event_time.values[:3]
    halves = [np.pi * np.sqrt(3.0 / 0.2), np.pi]
    assert np.diff(crossings) == pytest.approx(halves, rel=1e-9)


def test_tables_whose_values_alone_differ_share_one_trace():
    table = "cubic 0.0:0.5 0.5:0.42 1.5:0.4"
    contact = "linear 0.0:0.0 0.5:0.4 1.0:1.0"
    first = brake(table, contact_law=contact)
    other = brake(scaled(table, 1.0, 2.0), contact_law=scaled(contact, 1.1, 1.0))
    assert other.form is first.form
    assert np.ptp(first.traced.regimes - other.traced.regimes) > 0.0
    moved = brake(scaled(table, 2.0, 1.0), contact_law=contact)
    assert moved.form is not first.form
