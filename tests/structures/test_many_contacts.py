"""Random structures of coupled friction contacts against an event-driven integrator apart."""

import numpy as np
import pytest

from squealpipe import Contact, Structure, labels, plot
from tests.oracles.many_contacts import compare


def random_structure(seed, most=12):
    """A structure, and displacements and velocities to start from.

    Every third has tangential springs, a third is symmetric, so that contacts switch in pairs, a
    third has unsymmetric stiffness and full damping, and half have static limits; belts run both
    ways.

    Args:
        most: contacts.
    """
    rng = np.random.default_rng(seed)
    sprung, twice, full = seed % 3 == 1, seed // 2 % 3 == 0, seed // 3 % 3 == 1
    count = int(rng.integers(2, most + 1))
    half = max(count // 2, 1) if twice else count
    size = half + int(rng.integers(1, 4))
    if sprung:  # more contacts than modes
        size = max(2, int(rng.integers(half // 2, half + 3)))

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
    if full:
        follower, gyroscopic = rng.normal(size=(2, size, size)) / np.sqrt(size)
        stiffness = stiffness + 0.15 * (follower - follower.T)
        damping = damping + 0.1 * (gyroscopic - gyroscopic.T)
    n, t = rng.normal(size=(2, half, size)) / np.sqrt(size)
    k, preload = rng.uniform(0.5, 2.0, half), rng.uniform(0.3, 1.0, half)
    speed = rng.uniform(0.5, 1.5, half) * rng.choice([-1.0, 1.0], half)
    springs = 10.0 ** rng.uniform(-0.3, 1.5, half)
    rigid = rng.random(half) < 0.25
    if not sprung or rigid.sum() >= size:
        rigid[:] = not sprung
    made = []
    for copy in range(1 + twice):
        place = slice(copy * size, (copy + 1) * size)
        for i in range(half):
            normal, along = np.zeros((2, size * (1 + twice)))
            normal[place], along[place] = n[i], t[i]
            name, spring = f"c{len(made) + 1}", None if rigid[i] else springs[i]
            made.append(
                Contact(
                    *(name, normal, along, k[i], preload[i], speed[i]),
                    tangential_stiffness=spring,
                )
            )
    mu = float(rng.uniform(0.2, 0.8))
    q, v = 0.5 * rng.normal(size=(2, size))
    structure = Structure(
        both(mass),
        both(stiffness, 0.3),
        both(damping),
        contacts=made,
        mu=mu,
        mu_static=None if seed % 2 else mu * float(rng.uniform(1.05, 1.7)),
        belt_speed=float(rng.uniform(0.1, 0.6) * rng.choice([-1.0, 1.0])),
    )
    return structure, np.tile(q, 1 + twice), np.tile(v, 1 + twice)


@pytest.mark.parametrize(
    "seeds",
    [
        range(1, 7),
        pytest.param(range(7, 60), marks=pytest.mark.release),
        pytest.param(range(60, 300), marks=pytest.mark.long),
    ],
)
def test_contacts_that_are_coupled_agree_with_an_integrator_apart(seeds):
    found = {seed: compare(*random_structure(seed)) for seed in seeds}
    assert found == dict.fromkeys(seeds, "ok")


@pytest.mark.release
def test_up_to_a_hundred_contacts_agree_with_an_integrator_apart():
    seeds = range(300, 318)
    found = {seed: compare(*random_structure(seed, 100), most=12) for seed in seeds}
    assert found == dict.fromkeys(seeds, "ok")


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
