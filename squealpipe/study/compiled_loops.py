"""Compile the engine's loops in two processes side by side, into the user's cache folder.

Several first jobs, or tests, would otherwise compile the same at once. numba infers the types of a
function once a process: what shares functions is compiled by one, and the loop of structures, which
takes longest with what belongs to it, before the other is forked, whose event loop shares some.
"""

from typing import Any

from squealpipe.brake.backbones.orbit import periodic_orbit
from squealpipe.parameters import Parameters
from squealpipe.systems.linear import legs as structures_legs
from squealpipe.systems.linear import loop as structures_loop
from squealpipe.systems.processes import run_shared
from squealpipe.systems.taylor import collocation, legs, loop


def compile_loops() -> None:
    """Compile all loops that the cache does not hold yet."""
    structures_loop.loop()
    run_shared(_compile, {}, jobs=2, workers=2)


def _compile(_: dict[str, Any], first: int, stride: int) -> None:
    for compile_some in (_compile_systems, _compile_structures)[first::stride]:
        compile_some()


def _compile_systems() -> None:
    """Compile what integrates systems and follows their cycles, and the shots of orbits."""
    loop.loop()
    legs.run_legs()
    collocation.transfer_steps()
    periodic_orbit(Parameters(), 0.9, 2.8, mode=1, y_peak=2.0)


def _compile_structures() -> None:
    """Compile what the loop of structures calls, and what follows their cycles."""
    structures_loop.functions()
    structures_legs.run_legs()
