"""The linear model of sliding in 60 digits, from C and K as they are defined."""

import mpmath as mp
import numpy as np

from squealpipe.laws.friction_laws import coefficient
from squealpipe.systems.natural_exponential import exp

exp.register(mp.mpf, mp.exp)


def added(p, speed):
    """μ of a law that has no formula here, as the law gives it; dμ/dw by differences."""
    return coefficient(speed, p), mp.diff(lambda w: coefficient(w, p), speed)


def first_order_matrix(p, alpha1, alpha2):
    """Of (x, y, ẋ, ẏ) about the static state, 4×4."""
    with mp.workdps(60):
        f = mp.mpf
        (c1, s1), (c2, s2) = mp.cos_sin(f(alpha1)), mp.cos_sin(f(alpha2))
        side, speed = (1 if p.belt_speed >= 0 else -1), abs(f(p.belt_speed))
        fall, v0 = f(p.static_mu) - f(p.mu), f(p.friction_speed)
        formulas = {
            "coulomb": lambda: (f(p.mu), f(0)),
            "exponential": lambda: (
                f(p.mu) + fall * mp.exp(-speed / v0),
                -fall / v0 * mp.exp(-speed / v0),
            ),
            "hyperbolic": lambda: (
                f(p.mu) + fall / (1 + speed / v0),
                -fall / v0 / (1 + speed / v0) ** 2,
            ),
        }
        mu, slope = formulas.get(p.friction_law, lambda: added(p, speed))()
        e1, e2 = mp.matrix([c1, s1]), mp.matrix([-c2, s2])
        k = f(p.k1) * e1 * e1.T + f(p.k2) * e2 * e2.T
        c = f(p.damping1) * e1 * e1.T + f(p.damping2) * e2 * e2.T
        k3 = f(p.k3)
        contact = k + mp.matrix([[0, side * mu * k3], [0, k3]])
        push = k3 * f(p.preload)
        if slope:
            rest = mp.lu_solve(contact, mp.matrix([side * mu * push, push]))
            c[0, 0] += k3 * (f(p.preload) - rest[1]) * slope
        whole = mp.zeros(4)
        for i in range(2):
            whole[i, 2 + i] = 1
            for j in range(2):
                whole[2 + i, j] = -contact[i, j] / f(p.mass)
                whole[2 + i, 2 + j] = -c[i, j] / f(p.mass)
        return whole


def eigenvalues(p, alpha1, alpha2):
    """All four s, rounded to doubles: roots of the characteristic polynomial, begun at numpy's."""
    with mp.workdps(60):
        matrix = first_order_matrix(p, alpha1, alpha2)
        # by Faddeev and LeVerrier; mpmath's own eigenvalues take three times as long
        power, coefficients = mp.eye(4), [mp.mpf(1)]
        for degree in range(1, 5):
            product = matrix * power
            trace = mp.fsum(product[i, i] for i in range(4))
            coefficients.append(-trace / degree)
            power = product + coefficients[-1] * mp.eye(4)
        starts = np.linalg.eigvals(np.array(matrix.tolist(), float))
        roots = mp.polyroots(
            coefficients,
            maxsteps=200,
            extraprec=60,
            roots_init=[*map(mp.mpmathify, starts)],
        )
        return [complex(s) for s in roots]
