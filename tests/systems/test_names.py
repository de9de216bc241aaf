"""Names of starts, which states could have taken, of parameters and of regimes."""

import numpy as np
import pytest

from squealpipe import Switch, System


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
