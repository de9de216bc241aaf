"""Friction oscillators on a belt: slip slower or faster than it, or stick.

One mass on a spring, m ẍ + c ẋ + k x = F(V − ẋ), with a force F that falls with the sliding
speed. :data:`leine_oscillator` is that of Leine, van Campen, de Kraker and van den Steen (1998),
:data:`exponential_oscillator` the case study of bSTAB.
"""

from collections.abc import Callable, Mapping
from typing import Any

from squealpipe.systems.components import Switch
from squealpipe.systems.functions import exp
from squealpipe.systems.system import System

BELT_REGIMES = {
    "slower": {"direction": 1.0, "stick": 0.0},
    "faster": {"direction": -1.0, "stick": 0.0},
    "stick": {"direction": 0.0, "stick": 1.0},
}


def belt_oscillator(
    name: str,
    parameters: Mapping[str, float],
    friction: Callable[[Any, Any], Any],
    start: Mapping[str, float],
) -> System:
    """A mass of 1 on a spring of 1 and a dashpot, on a belt.

    Args:
        parameters: with ``belt_speed`` and ``damping``.
        friction: the friction force over (sliding speed, parameters); its limit in stick is that
            at speed 0.
    """

    def pull(s: Any, p: Any) -> Any:
        return -s.x - p.damping * s.v

    def margin(sign: float) -> Any:
        return lambda t, s, p, r: friction(0.0, p) + sign * pull(s, p)

    def field(t: Any, s: Any, p: Any, r: Any) -> dict[str, Any]:
        force = r.direction * friction(r.direction * (p.belt_speed - s.v), p)
        return {"x": s.v, "v": (1.0 - r.stick) * (pull(s, p) + force)}

    def holds(t: Any, s: Any, p: Any, r: Any) -> Any:
        """The force that stick would need does not reach the limit, whatever its sign."""
        return friction(0.0, p) ** 2 - pull(s, p) ** 2

    return System(
        name,
        states={"x": "m", "v": "m/s"},
        parameters=parameters,
        regimes=BELT_REGIMES,
        field=field,
        switches=[
            Switch(
                "reversal",
                leaves=("slower", "faster"),
                when=lambda t, s, p, r: r.direction * (p.belt_speed - s.v),
                to=[
                    ("stick", holds, "stick"),
                    ("faster", lambda t, s, p, r: r.direction),
                    "slower",
                ],
                reset=lambda t, s, p, r: {"v": p.belt_speed},
            ),
            Switch("slip", leaves="stick", when=margin(1.0), to="slower"),
            Switch("overtake", "stick", margin(-1.0), to=[("faster", None, "slip")]),
        ],
        start=start,
        starts_in=[
            ("stick", holds, lambda t, s, p, r: p.belt_speed - s.v),
            ("slower", lambda t, s, p, r: p.belt_speed - s.v),
            "faster",
        ],
    )


leine_oscillator = belt_oscillator(
    "Leine's friction oscillator",
    {"belt_speed": 0.2, "damping": 0.0, "limit": 1.0, "fall": 3.0},
    lambda speed, p: p.limit / (1.0 + p.fall * speed),
    {"x": 1.0, "v": 0.2},
)
exponential_oscillator = belt_oscillator(
    "friction oscillator with an exponential law",
    {
        "belt_speed": 1.5,
        "damping": 0.1,
        "mu": 0.5,
        "mu_static": 1.0,
        "friction_speed": 0.5,
    },
    lambda speed, p: p.mu + (p.mu_static - p.mu) * exp(-speed / p.friction_speed),
    {"x": 2.0, "v": 0.0},
)
