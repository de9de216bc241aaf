"""Compile the engine's loops in two processes side by side, into the user's cache folder.

Several first jobs, or tests, would otherwise compile the same at once. Loops that share functions
are compiled by one process, since numba infers the types of a function once a process: the legs of
a structure's cycle take 3 s of CPU time after its loop, and 7 s by themselves.
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
    """Compile what integrates structures and follows their cycles."""
    structures_loop.loop()
    structures_loop.functions()
    structures_legs.run_legs()
