"""Branches of doubled period that leave a branch of A4 at a period doubling, in scaled units."""

import numpy as np
from numpy.typing import NDArray

from squealpipe.brake.a4.system import ScaledSystem
from squealpipe.brake.orbits.orbits import Orbit, OrbitEquations, orbit_across
from squealpipe.brake.orbits.tracing import TraceEnd, TraceSettings, trace_branch

OFFSETS = (1e-4, 3e-4, 1e-3, 3e-3)
"""Distances of the first orbits from the doubling, over 1 + |z|; there the trace cannot separate
the doubled orbit from the one run through twice."""


def doubled_start(
    scene: ScaledSystem, orbit: Orbit
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the place and direction in which the doubled branch leaves a period doubling.

    With two periods as one the conditions of rest lose rank at one of the two instants of rest:
    there, and with both instants moving apart at constant period, the new orbits begin.
    Both are of (x, y, T), with the half of the doubled period.
    """
    candidates = []
    for rest in (orbit.point[:2], orbit.rest):
        start = np.array([*rest, 2.0 * orbit.point[2]])
        jacobian = OrbitEquations(scene.system).evaluate(start)[1][:, :2]
        _, values, vectors = np.linalg.svd(jacobian)
        direction = vectors[-1] * (1.0 if vectors[-1][1] >= 0.0 else -1.0)
        candidates.append((values[-1] / values[0], start, np.append(direction, 0.0)))
    _, start, direction = min(candidates, key=lambda candidate: float(candidate[0]))
    return start, direction


def doubled_branch_from(
    scene: ScaledSystem, orbit: Orbit, y_max: float
) -> tuple[list[Orbit], TraceEnd]:
    """Orbits of doubled period from a period doubling on, the doubling first, and the end.

    Its index is that of the orbit run through twice: the square of −2, less 2.
    """
    start, direction = doubled_start(scene, orbit)
    size = 1.0 + float(np.linalg.norm(start))
    index = orbit.stability_index**2 - 2.0
    orbits = [
        Orbit(
            start, start[:2], np.empty(2 * len(orbit.switches)), index, orbit.residual
        )
    ]
    for offset in OFFSETS:
        found = orbit_across(scene.system, start + offset * size * direction, direction)
        if found is None:
            return orbits, TraceEnd.branch_lost
        orbits.append(found)
    away = orbits[-1].point - start
    settings = TraceSettings(first_step=OFFSETS[-1], linear_x=abs(float(start[0])))
    # spacing of the recorded points, over 1 + |z|
    beyond, end = trace_branch(
        scene.system, orbits[-1].point, away, y_max, settings, 0.02
    )
    return orbits + beyond, end
