"""The model written down once more, symbolically, from its energies: independent of the package.

Springs are given by their potential energy and fixed ends alone; forces, the stiffness matrix and
Jacobians follow by differentiation.
"""

from types import SimpleNamespace

import numpy as np
import sympy as sp

from squealpipe.parameters import Parameters

X, Y, ALPHA1, ALPHA2 = sp.symbols("x y alpha1 alpha2", real=True)
NAMES = (
    "mass",
    "k1",
    "k2",
    "k3",
    "mu",
    "belt_speed",
    "preload",
    "length1",
    "length2",
    "sigma",
)
P = SimpleNamespace(**{name: sp.Symbol(name, positive=True) for name in NAMES})
P.belt_speed = sp.Symbol("belt_speed", real=True)

FIXED1 = (P.length1 * sp.cos(ALPHA1), P.length1 * sp.sin(ALPHA1))
FIXED2 = (-P.length2 * sp.cos(ALPHA2), P.length2 * sp.sin(ALPHA2))


def _stretch_energy(stiffness, length, end):
    distance = sp.sqrt((X - end[0]) ** 2 + (Y - end[1]) ** 2)
    return stiffness * (distance - length) ** 2 / 2


SPRING_ENERGY = _stretch_energy(P.k1, P.length1, FIXED1) + _stretch_energy(
    P.k2, P.length2, FIXED2
)
SPRING_FORCE = (-sp.diff(SPRING_ENERGY, X), -sp.diff(SPRING_ENERGY, Y))
CONTACT_ENERGY = P.k3 * (P.preload - Y) ** 2 / 2
CONTACT_FORCE = -sp.diff(CONTACT_ENERGY, Y)
# sp.simplify finds the lengths, too, but takes seconds of every process of the tests
STIFFNESS = (
    sp.hessian(SPRING_ENERGY, (X, Y))
    .subs({X: 0, Y: 0})
    .subs(FIXED1[0] ** 2 + FIXED1[1] ** 2, P.length1**2)
    .subs(FIXED2[0] ** 2 + FIXED2[1] ** 2, P.length2**2)
)
LINEAR_FORCE = tuple(-(STIFFNESS * sp.Matrix([X, Y])))


def function(expression):
    """A symbolic expression as a function of parameters and x, y, alpha1, alpha2."""
    symbols = [X, Y, ALPHA1, ALPHA2, *vars(P).values()]
    compiled = sp.lambdify(symbols, expression, "numpy")

    def call(params, *, x=0.0, y=0.0, alpha1=0.0, alpha2=0.0):
        numbers = [getattr(params, name) for name in NAMES]
        return np.asarray(compiled(x, y, alpha1, alpha2, *numbers), dtype=float)

    return call


RNG_SEED = 4


def random_parameters(generator):
    """Parameters without any symmetry."""
    return Parameters(
        mass=generator.uniform(0.3, 3),
        k1=generator.uniform(0.3, 3),
        k2=generator.uniform(0.3, 3),
        k3=generator.uniform(0.3, 3),
        mu=generator.uniform(0, 1),
        belt_speed=generator.uniform(-5, 5),
        preload=generator.uniform(0.3, 3),
        length1=generator.uniform(3, 8),
        length2=generator.uniform(3, 8),
        sigma=generator.uniform(0.3, 5),
    )


def draws(count):
    """Random parameters with a random state and random angles."""
    generator = np.random.default_rng(RNG_SEED)
    cases = []
    for _ in range(count):
        params = random_parameters(generator)
        state = zip("xy", generator.uniform(-1, 1, 2), strict=True)
        angles = zip(("alpha1", "alpha2"), generator.uniform(0, np.pi, 2), strict=True)
        cases.append((params, dict([*state, *angles])))
    return cases
