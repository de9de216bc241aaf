"""Random structures of coupled friction contacts against an event-driven integrator apart."""

import numpy as np
import pytest

from squealpipe import Contact, Structure, labels, plot
from tests.oracles.many_contacts import compare


def random_structure(seed):
    """A structure, and displacements and velocities to start from.

    Every third is symmetric: its contacts switch in pairs; every second has a static limit.
    """
    rng = np.random.default_rng(seed)
    contacts = int(rng.integers(2, 9))
    twice = seed % 3 == 0
    contacts -= contacts % 2 if twice else 0
    half = max(contacts // 2, 1) if twice else contacts
    size = half + int(rng.integers(1, 3))

    def definite(scale):
        root = rng.normal(size=(size, size)) / np.sqrt(size)
        return scale * (np.eye(size) + root @ root.T)

    def both(matrix, coupling=0.0):
        other = coupling * np.eye(size)
        return (
            np.block([[matrix + other, -other], [-other, matrix + other]])
            if twice
            else matrix
        )

    mass, stiffness, damping = definite(1.0), definite(1.0), definite(0.003)
    n, t = rng.normal(size=(2, half, size)) / np.sqrt(size)
    k, preload = rng.uniform(0.5, 2.0, half), rng.uniform(0.3, 1.0, half)
    speed = rng.uniform(0.5, 1.5, half) * rng.choice([-1.0, 1.0], half)
    made = []
    for copy in range(1 + twice):
        place = slice(copy * size, (copy + 1) * size)
        for i in range(half):
            normal, along = np.zeros((2, size * (1 + twice)))
            normal[place], along[place] = n[i], t[i]
            made.append(
                Contact(f"c{len(made) + 1}", normal, along, k[i], preload[i], speed[i])
            )
    mu, belt_speed = float(rng.uniform(0.2, 0.8)), float(rng.uniform(0.1, 0.6))
    q, v = 0.5 * rng.normal(size=(2, size))
    structure = Structure(
        both(mass),
        both(stiffness, 0.3),
        both(damping),
        contacts=made,
        mu=mu,
        mu_static=None if seed % 2 else mu * float(rng.uniform(1.05, 1.7)),
        belt_speed=belt_speed,
    )
    return structure, np.tile(q, 1 + twice), np.tile(v, 1 + twice)


@pytest.mark.parametrize(
    "seed",
    [1, 2, *(pytest.param(seed, marks=pytest.mark.release) for seed in range(3, 16))],
)
def test_contacts_that_are_coupled_agree_with_an_integrator_apart(seed):
    assert compare(*random_structure(seed)) == "ok"


def test_bands_of_regimes_are_those_of_their_contact():
    # the name of one contact begins like that of the other
    contacts = [
        Contact("c_2", {1: -1.0}, {0: 1.0}, stiffness=4e8 / 3, preload=2e3),
        Contact("c", {0: -1.0}, {1: 1.0}, stiffness=1e8 / 3, preload=1e3),
    ]
    structure = Structure(
        np.eye(2),
        1e8 * np.array([[2.0, -1.0], [-1.0, 2 / 3]]),
        modal_damping=0.02,
        contacts=contacts,
        mu=1.0,
        belt_speed=-2.0,
    )
    run = structure.system().simulate(1e-3)
    names = labels(run.event_regime).values
    switches = sum(name.startswith("c_2_") for name in names)
    assert switches
    bands = plot(run).collections
    assert [len(band.get_paths()) for band in bands] == [
        1 + switches,
        1 + len(names) - switches,
    ]
