"""Compile the engine's loops one after the other, into the user's cache folder.

Several first jobs, or tests, would otherwise compile the same at once. One process compiles all:
numba infers the types of a function once a process, and the event loop shares dozens with the loop
of structures. Two processes side by side took 4 s of CPU time more.
"""

from squealpipe.brake.backbones.orbit import periodic_orbit
from squealpipe.parameters import Parameters
from squealpipe.systems.linear import legs as structures_legs
from squealpipe.systems.linear import loop as structures_loop
from squealpipe.systems.taylor import collocation, legs, loop


def compile_loops() -> None:
    """Compile all loops that the cache does not hold yet."""
    # of structures, and of their cycles
    structures_loop.loop()
    structures_loop.functions()
    structures_legs.run_legs()
    # of systems, of their cycles, and shots of orbits
    loop.loop()
    legs.run_legs()
    collocation.transfer_steps()
    periodic_orbit(Parameters(), 0.9, 2.8, mode=1, y_peak=2.0)
