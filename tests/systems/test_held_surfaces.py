"""Surfaces along which a motion stays, as in stick, are known in any units."""

import numpy as np
import pytest

from squealpipe import Switch, System


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_a_gear_in_mesh_holds_its_surface_whatever_its_units(size):
    """Wheels of radii 3 and 7 roll on each other: 3 w1 = 7 w2, for ever, beside a free one."""

    def rolling(t, s, p, r):
        return {
            "w1": 7.0 * size * np.pi * s.x,
            "w2": 3.0 * size * np.pi * s.x,
            "x": -s.w1,
        }

    def slip(t, s, p, r):
        return size * (3.0 * s.w1 - 7.0 * s.w2)

    system = System(
        "gear",
        states={"w1": "", "w2": "", "x": ""},
        parameters={},
        regimes={"rolling": {}, "free": {}},
        field=rolling,
        start={"w1": 7.0, "w2": 3.0, "x": 0.0},
        switches=[
            Switch("slips", leaves="rolling", when=slip, to="free"),
            Switch(
                "turns", leaves="rolling", when=lambda t, s, p, r: s.x - 2.0, to="free"
            ),
        ],
    )
    assert system.joint.holds(0).sum() == 1
