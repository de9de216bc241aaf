"""Random parameter sets for the tests of this folder."""

import numpy as np

from squealpipe.parameters import Parameters


def random_sets(generator, count, *, equal):
    """Parameter sets of either direction of the belt, in units of their own."""
    sets = []
    for _ in range(count):
        k1, length1, mass, preload = np.exp(generator.uniform(-1, 1, 4))
        k2, length2 = (k1, 1.0) if equal else np.exp(generator.uniform(-1, 1, 2))
        reach = preload * np.exp(generator.uniform(0.7, 3.5))
        params = Parameters(
            mass=mass,
            k1=k1,
            k2=k2,
            k3=k1 * generator.uniform(0.1, 3.0),
            mu=generator.uniform(0.0, 0.9),
            preload=preload,
            length1=reach * (1.0 if equal else length1),
            length2=reach * length2,
            belt_speed=generator.choice([-1, 1]) * np.exp(generator.uniform(-2, 5)),
        )
        sets.append(params)
    return sets


def fields_of(sets):
    names = set(Parameters().as_dict()) - {"sigma"}
    return {
        name: np.array([params.as_dict()[name] for params in sets]) for name in names
    }
