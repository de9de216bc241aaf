"""Names of starts, which states could have taken, of parameters and of regimes."""

import numpy as np
import pytest

from squealpipe import Switch, System, labels


def decays(*names, **options):
    """States that decay, each at a rate of its own: 1, 2, …"""
    return System(
        "decays",
        states=dict.fromkeys(names, "1"),
        parameters={"rate": 1.0} | options,
        regimes={"all": {}},
        field=lambda t, s, p, r: {
            name: -(i + 1.0) * p.rate * getattr(s, name) for i, name in enumerate(names)
        },
        start=dict.fromkeys(names, 1.0),
    )


@pytest.mark.parametrize(
    ("names", "starts"),
    [
        (("q1", "q2"), ["q10", "q20"]),
        (("q1", "q10"), ["q1_0", "q10_0"]),
        (("q1", "q10", "q1_0"), ["q1__0", "q10__0", "q1_0__0"]),
    ],
)
def test_starts_have_names_that_no_state_has(names, starts):
    given = {name: np.linspace(1.0, 2.0, 2 + i) for i, name in enumerate(names)}
    ends = decays(*names).ensemble(0.5, start=given, workers=1)
    assert list(ends.dims) == starts
    for i, (name, start) in enumerate(zip(names, starts, strict=True)):
        np.testing.assert_array_equal(ends[start], given[name])
        expected = ends[start] * np.exp(-0.5 * (i + 1))
        np.testing.assert_allclose(
            ends[name], expected.broadcast_like(ends[name]), rtol=1e-12
        )
    run = decays(*names).simulate(0.5, sensitivity=(starts[1],))
    slope = run[f"{names[1]}_by_{starts[1]}"].values[-1]
    assert slope == pytest.approx(np.exp(-1.0), rel=1e-12)


def test_a_parameter_named_as_a_start_is_told_so():
    with pytest.raises(ValueError, match=r"'q10'.*a start.*choose another"):
        decays("q1", q10=2.0)


def test_a_parameter_has_no_unit_of_the_brakes_of_its_name():
    own = System(
        "own",
        states={"x": "m"},
        parameters={"preload": 0.0},
        regimes={"free": {}},
        field=lambda t, s, p, r: {"x": p.preload},
        start={"x": 0.0},
    )
    with pytest.raises(ValueError, match="preload = '2 mm'"):
        own.simulate(1.0, preload="2 mm")


def test_a_switch_keeps_the_regimes_that_it_was_given():
    hit = Switch("hit", ("free", "held"), lambda t, s, p, r: s.x, "free")
    assert hit.leaves == ("free", "held")


def test_names_of_a_system_are_compared_as_they_were_written():
    turns = System(
        "back and forth",
        states={"x": "1"},
        parameters={},
        regimes={"to_right": {"speed": 1.0}, "to_left": {"speed": -1.0}},
        field=lambda t, s, p, r: {"x": r.speed},
        switches=[
            Switch("hit_wall", "to_right", lambda t, s, p, r: 1.0 - s.x, "to_left"),
            Switch("turn_back", "to_left", lambda t, s, p, r: s.x + 1.0, "to_right"),
        ],
        stops={"far_away": lambda t, s, p, r: 6.0 - t},
        start={"x": 0.0, "regime": "to_right"},
    )
    run = turns.simulate(10.0)
    assert labels(run.event_kind).values.tolist() == [
        "hit_wall",
        "turn_back",
        "hit_wall",
    ]
    entered = ["to_left", "to_right", "to_left"]
    assert labels(run.event_regime).values.tolist() == entered
    assert (labels(run.regime) == "to_right").values[0]
    assert labels(run.outcome).item() == "far_away"
    assert labels(turns.ensemble(10.0).outcome).item() == "far_away"
    # what the package says of a run stays in words
    regimes = labels(turns.simulate(10.0, times=[0.0, 9.0]).regime)
    assert regimes.values.tolist() == ["to_right", "not reached"]
