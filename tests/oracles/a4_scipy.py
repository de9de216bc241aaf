"""A4 by scipy, from the stiffness alone: an independent judge of our periodic motions."""

import numpy as np
from scipy.integrate import solve_ivp

from squealpipe.laws.springs import geometry, linear_elastic_force, linear_stiffness


def a4_by_scipy(params, angles, orbit, times):
    """(x, y, ẋ, ẏ) from the peak of an orbit on, at ascending instants.

    It stops at each switch: a step across one has an error that no tolerance bounds and that
    differs from processor to processor.
    """
    stiffness = linear_stiffness(params, geometry(*angles))

    def field(_, z, contact):
        fx, fy = linear_elastic_force(*z[:2], stiffness)
        normal = contact * params.k3 * (params.preload - z[1])
        return [
            *z[2:],
            (fx + params.drag * normal) / params.mass,
            (fy + normal) / params.mass,
        ]

    def gap(_, z, __):
        return z[1] - params.preload

    gap.terminal = True
    t, z, found = 0.0, [float(orbit.x_at_peak), float(orbit.y_peak), 0.0, 0.0], []
    contact = z[1] < params.preload
    while t < times[-1]:
        gap.direction = 1.0 if contact else -1.0
        piece = solve_ivp(
            field,
            (t, times[-1]),
            z,
            "DOP853",
            events=gap,
            args=(contact,),
            dense_output=True,
            rtol=1e-13,
            atol=1e-14 * params.preload,
        )
        if (here := times[(times >= t) & (times < piece.t[-1])]).size:
            found.append(piece.sol(here))
        t, z, contact = piece.t[-1], piece.y[:, -1], not contact
    return np.concatenate([*found, z[:, None]], axis=1)
