"""The equations of the problems are those of the package's systems."""

import numpy as np
import pytest

from squealpipe.benchmark.problems import Problem, all_data
from squealpipe.brake.a1.motion_system import brake
from squealpipe.systems.shipped.belt_friction import leine_oscillator
from squealpipe.systems.shipped.bouncing_ball import bouncing_ball
from squealpipe.systems.shipped.dry_friction import dry_friction_oscillator
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator
from squealpipe.systems.shipped.relief_valve import relief_valve
from squealpipe.systems.taylor.symbols import parameter, substituted, symbol
from squealpipe.systems.text import expression
from squealpipe.systems.trace import TIME, TIME_UNIT

SYSTEMS = {
    "bouncing ball": lambda: bouncing_ball,
    "relief valve": lambda: relief_valve,
    "dry friction": lambda: dry_friction_oscillator,
    "stick–slip": lambda: leine_oscillator,
    "chaotic impacts": lambda: impact_oscillator,
    "A1: hammering": brake,
}
"""Problem that has the equations → system; the other problems have equations of their own."""
CASES = {
    data["name"]: data
    for data in all_data()
    if data.get("system", data["name"]) in SYSTEMS
}


def traced(data, system):
    """The problem with the equations of a system."""
    unit = {id(parameter(TIME_UNIT)): symbol(1.0)}

    def text(root):
        if root is None:
            return None
        return expression(substituted([root], unit)[id(root)])

    switches = []
    for switch, symbols in zip(system.switches, system.traced.switches, strict=True):
        made = {"name": switch.name, "leaves": np.atleast_1d(switch.leaves).tolist()}
        made |= {"when": text(symbols.surface), "to": []}
        for regime, condition, kind in symbols.targets:
            made["to"].append(
                [system.name_of(regime), text(condition), system.traced.kinds[kind]]
            )
        assert symbols.has_one_reset
        reset = next(iter(symbols.resets.values()))
        made["reset"] = {system.states[i]: text(value) for i, value in reset.items()}
        switches.append(made)
    rates = zip(system.states, system.traced.rates, strict=False)
    field = {name: text(rate) for name, rate in rates}
    return Problem(
        {**data, "regimes": system.regimes, "field": field, "switches": switches}
    )


@pytest.mark.parametrize("name", CASES)
def test_equations_are_those_of_the_system(name):
    data, rng = CASES[name], np.random.default_rng(3)
    system = SYSTEMS[data.get("system", name)]()
    ours, theirs = Problem(data), traced(data, system)
    assert ours.regimes == theirs.regimes
    if (
        data["class"] != "simultaneous"
    ):  # that one starts on two surfaces, in a regime of its own
        given = {**system.parameters, **data["parameters"], **data["start"], TIME: 0.0}
        given = {key: np.array([value]) for key, value in given.items()}
        assert ours.regime == system.name_of(int(system.first_regimes(given, 1)[0, 0]))
    for regime in ours.regimes:
        t, y = rng.uniform(), rng.uniform(0.2, 2.0, len(ours.states)).tolist()
        assert ours.field(t, y, regime) == pytest.approx(theirs.field(t, y, regime))
        for mine, other in zip(ours.switches, theirs.switches, strict=True):
            assert (mine.name, mine.leaves) == (other.name, other.leaves)
            assert mine.when(t, y, regime) == pytest.approx(other.when(t, y, regime))
            (*to, after), (*other_to, other_after) = (
                s.fire(t, y, regime) for s in (mine, other)
            )
            assert to == other_to
            assert after == pytest.approx(other_after)
