"""A Burridge–Knopoff chain: blocks on a moving belt, coupled by springs.

The model of Burridge and Knopoff (1967) for earthquakes. Each block hangs on a spring of its own,
is coupled to its neighbours, and is dragged along by friction that falls with the sliding speed w,
limit / (1 + fall w), as in Carlson and Langer (1989). Each has regimes of its own: all 3ᴺ
combinations take no more than N components.
"""

from functools import cache
from typing import Any

from squealpipe.systems.components import MOST_COMPONENTS, Component, Switch
from squealpipe.systems.inputs.gate import checked
from squealpipe.systems.shipped.belt_friction import BELT_REGIMES
from squealpipe.systems.system import System


@cache
@checked
def burridge_knopoff(blocks: int = 10) -> System:
    """The chain as a system: states ``x1``…, ``v1``…, components ``block1``….

    Parameters: ``mass`` of a block (kg), ``stiffness`` of its own spring and ``coupling`` to each
    neighbour (N/m), ``belt_speed`` (m/s), ``limit`` of friction in stick (N), ``fall`` (s/m).

    Raises:
        ValueError: more blocks than components can be carried.
    """
    if not 1 <= blocks <= MOST_COMPONENTS:
        raise ValueError(
            f"blocks = {blocks}: 1 to {MOST_COMPONENTS} can be carried, one a component"
        )
    numbers = range(1, blocks + 1)

    def field(t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:
        rates = {f"x{i}": getattr(s, f"v{i}") for i in numbers}
        for i in numbers:
            regime = getattr(r, f"block{i}")
            slides = regime.direction * (p.belt_speed - getattr(s, f"v{i}"))
            force = regime.direction * p.limit / (1.0 + p.fall * slides)
            total = pull(i, blocks, s, p) + force
            rates[f"v{i}"] = (1.0 - regime.stick) * total / p.mass
        return rates

    chain_parameters = {
        "mass": 1.0,
        "stiffness": 1.0,
        "coupling": 4.0,
        "belt_speed": 0.1,
        "limit": 1.0,
        "fall": 2.0,
    }
    return System(
        f"Burridge–Knopoff chain of {blocks} blocks",
        states={f"x{i}": "m" for i in numbers} | {f"v{i}": "m/s" for i in numbers},
        parameters=chain_parameters,
        components={f"block{i}": _block(i, blocks) for i in numbers},
        field=field,
        start={f"x{i}": 0.9 * (7 * i % 11) / 11 for i in numbers}
        | {f"v{i}": 0.0 for i in numbers},
        time_scale=lambda p: (p.mass / p.stiffness) ** 0.5,
    )


def pull(block: int, blocks: int, s: Any, p: Any) -> Any:
    """Force of all springs on a block, N."""
    x = getattr(s, f"x{block}")
    total = -p.stiffness * x
    for other in (block - 1, block + 1):
        if 1 <= other <= blocks:
            total = total + p.coupling * (getattr(s, f"x{other}") - x)
    return total


def _block(block: int, blocks: int) -> Component:
    """Slip slower or faster than the belt, or stick."""
    name, speed = f"block{block}", f"v{block}"

    def on_belt(t: Any, s: Any, p: Any, r: Any) -> Any:
        return p.belt_speed - getattr(s, speed)

    def slides(t: Any, s: Any, p: Any, r: Any) -> Any:
        return getattr(r, name).direction * on_belt(t, s, p, r)

    def holds(t: Any, s: Any, p: Any, r: Any) -> Any:
        return p.limit**2 - pull(block, blocks, s, p) ** 2

    def margin(sign: float) -> Any:
        return lambda t, s, p, r: p.limit + sign * pull(block, blocks, s, p)

    return Component(
        BELT_REGIMES,
        [
            Switch(
                "reversal",
                leaves=("slower", "faster"),
                when=slides,
                to=[
                    ("stick", holds, "stick"),
                    ("faster", lambda t, s, p, r: getattr(r, name).direction),
                    "slower",
                ],
                reset=lambda t, s, p, r: {speed: p.belt_speed},
            ),
            Switch("slip", "stick", margin(1.0), "slower"),
            Switch("overtake", "stick", margin(-1.0), [("faster", None, "slip")]),
        ],
        starts_in=[("stick", holds, on_belt), ("slower", on_belt), "faster"],
    )
