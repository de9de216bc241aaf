"""Components side by side: as one component with all combinations, or as systems apart."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from squealpipe.systems.impact_oscillator import impact_oscillator
from squealpipe.systems.rigid_pad import LEADING, TRAILING, approach, rigid_pad

from squealpipe import Component, Switch, System, labels, plot
from squealpipe.functions import cos

START = {"vx": 0.3, "y": 0.3, "spin": 0.5}


def combined():
    """The rigid pad with a regime for each combination of its contacts."""

    def switches(name, side, other):
        return [
            Switch(
                f"{name}_lifts",
                ("both", name),
                lambda t, s, p, r: approach(side, s, p),
                to=[
                    (other, lambda t, s, p, r: getattr(r, other).contact - 0.5),
                    "neither",
                ],
            ),
            Switch(
                f"{name}_lands",
                (other, "neither"),
                lambda t, s, p, r: -approach(side, s, p),
                to=[("both", lambda t, s, p, r: getattr(r, other).contact - 0.5), name],
            ),
        ]

    def nested(function):
        """The same function, of flat constants."""

        def of(t, s, p, r):
            leading, trailing = (
                type("r", (), {"contact": value}) for value in (r.leading, r.trailing)
            )
            both = type("r", (), {"leading": leading, "trailing": trailing})
            return function(t, s, p, both)

        return of

    made = [
        *switches("leading", LEADING, "trailing"),
        *switches("trailing", TRAILING, "leading"),
    ]
    flat = [
        replace(
            each, to=[(each.to[0][0], nested(each.to[0][1]), each.name), each.to[1]]
        )
        for each in made
    ]
    return System(
        "rigid pad",
        states=rigid_pad.units,
        parameters=rigid_pad.parameters,
        regimes={
            "both": {"leading": 1.0, "trailing": 1.0},
            "leading": {"leading": 1.0, "trailing": 0.0},
            "trailing": {"leading": 0.0, "trailing": 1.0},
            "neither": {"leading": 0.0, "trailing": 0.0},
        },
        field=nested(rigid_pad.field),
        switches=flat,
        start=rigid_pad.start,
    )


def test_two_contacts_side_by_side_have_the_bits_of_their_four_combinations():
    apart, together = (
        system.simulate(60.0, start=START) for system in (rigid_pad, combined())
    )
    assert apart.sizes["event"] > 20
    np.testing.assert_array_equal(apart.event_time, together.event_time)
    np.testing.assert_array_equal(apart.vx, together.vx)
    # kinds are numbered alike, since they sort alike
    np.testing.assert_array_equal(apart.event_kind, together.event_kind)


def test_regimes_are_told_by_component():
    run = rigid_pad.simulate(10.0, start=START)
    assert list(run.component.values) == ["leading", "trailing"]
    assert list(labels(run.event_regime).values[:2]) == [
        "leading_open",
        "trailing_open",
    ]
    found = rigid_pad.ensemble(10.0, start={**START, "x": np.array([0.0, 0.1])})
    for name in ("leading", "trailing"):
        spent = found[f"time_in_{name}_closed"] + found[f"time_in_{name}_open"]
        np.testing.assert_allclose(spent, 10.0, rtol=1e-13)


def pair():
    """Two impact oscillators that know nothing of each other, the second one shifted."""

    def contact(name):
        return Component(
            {"free": {}},
            [
                Switch(
                    "impact",
                    "free",
                    lambda t, s, p, r: p.gap - getattr(s, f"x{name}"),
                    "free",
                    reset=lambda t, s, p, r: {
                        f"v{name}": -p.restitution * getattr(s, f"v{name}")
                    },
                )
            ],
        )

    def field(t, s, p, r):
        force = p.amplitude * cos(p.omega * t)
        return {
            "x1": s.v1,
            "v1": force - p.damping * s.v1 - s.x1,
            "x2": s.v2,
            "v2": force - 2.0 * p.damping * s.v2 - s.x2,
        }

    return System(
        "two impact oscillators",
        states={"x1": "m", "v1": "m/s", "x2": "m", "v2": "m/s"},
        parameters=impact_oscillator.parameters,
        components={"first": contact("1"), "second": contact("2")},
        field=field,
        start={"x1": 0.0, "v1": 0.0, "x2": 0.0, "v2": 0.0},
        period=lambda p: 2.0 * pi / p.omega,
    )


def test_a_cycle_of_two_systems_side_by_side_has_the_multipliers_of_both():
    options = {"omega": 2.0, "amplitude": 4.0}
    both = pair().limit_cycle(**options)
    alone = [
        impact_oscillator.limit_cycle(**options, damping=damping)
        for damping in (0.1, 0.2)
    ]
    assert set(labels(both.event_kind).values) == {"first_impact", "second_impact"}
    expected = [
        complex(re, im)
        for each in alone
        for re, im in zip(each.multiplier_real, each.multiplier_imag, strict=True)
    ]
    found = both.multiplier_real.values + 1j * both.multiplier_imag.values
    np.testing.assert_allclose(
        np.sort_complex(found), np.sort_complex(expected), atol=1e-10
    )


@pytest.mark.parametrize(
    ("regime", "says"),
    [
        ({"leading": "shut"}, "choose from closed, open"),
        ({"middle": "open"}, "component 'middle'"),
        ("closed", "component: regime"),
    ],
)
def test_a_start_names_regimes_by_component(regime, says):
    with pytest.raises(ValueError, match=says):
        rigid_pad.simulate(1.0, start={"regime": regime})


def test_a_start_may_name_the_regimes_of_some_components():
    run = rigid_pad.simulate(0.0, start={"regime": {"leading": "open"}})
    assert list(labels(run.regime[0]).values) == ["leading_open", "trailing_closed"]


def test_a_picture_shows_the_regimes_of_each_component_as_a_band():
    run = rigid_pad.simulate(10.0, start=START)
    axes = plot(run)
    spent = rigid_pad.ensemble(10.0, start=START)
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    colours = {
        patch.get_label(): patch.get_facecolor()
        for patch in axes.get_legend().legend_handles
        if hasattr(patch, "get_facecolor")
    }
    assert {"closed", "open"} <= set(names)
    tops = [
        path.vertices[:, 1].max()
        for each in axes.collections
        for path in each.get_paths()
    ]
    assert axes.get_yticks().min() > max(tops)  # bands have no scale
    for component, band in zip(("leading", "trailing"), axes.collections, strict=True):
        for regime in ("closed", "open"):
            width = sum(
                np.ptp(path.vertices[:, 0])
                for path, colour in zip(
                    band.get_paths(), band.get_facecolors(), strict=True
                )
                if np.allclose(colour, colours[regime])
            )
            expected = float(spent[f"time_in_{component}_{regime}"])
            assert width == pytest.approx(expected, abs=1e-9)
