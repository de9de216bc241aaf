"""Random structures of coupled friction contacts against an event-driven integrator apart."""

import numpy as np
import pytest

from squealpipe import Contact, Structure, labels, plot
from tests.oracles.many_contacts import OPEN, SAME, ManyContacts

INSTANTS = 30
SIDES = {"slip_slower": 1, "slip_faster": -1, "stick": 0, "separated": OPEN}


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


def instants(run, system):
    """(time, sides after it) where the regimes change, from the events of a run."""
    names = run.event_regime.attrs["flag_meanings"].split()
    first = [system.name_of(r) for r in range(len(system.regimes))]
    assert len(first) == len(names)
    components = list(run.component.values)
    sides = {
        c: SIDES[names[int(k)].removeprefix(f"{c}_")]
        for c, k in zip(components, run.regime.values[0], strict=True)
    }
    found = [(0.0, tuple(sides.values()))]
    for time, number in zip(
        run.event_time.values, run.event_regime.values, strict=True
    ):
        component, _, regime = names[int(number)].partition("_")
        sides[component] = SIDES[regime]
        if time - found[-1][0] < SAME and len(found) > 1:
            found[-1] = (found[-1][0], tuple(sides.values()))
        else:
            found.append((float(time), tuple(sides.values())))
    return found


def compare(seed):
    """ok, refused (the run says why), or what is wrong."""
    structure, q, v = random_structure(seed)
    truth = ManyContacts(structure, q, v)
    expected = [(0.0, tuple(truth.side))]
    while len(expected) <= INSTANTS:
        wait = truth.next_event(0.05, most=50.0)
        if wait is None:
            break
        expected.append((expected[-1][0] + wait, tuple(truth.side)))
    end = expected[-1][0]
    system = structure.system()
    start = {f"q{i + 1}": x for i, x in enumerate(q)} | {
        f"v{i + 1}": x for i, x in enumerate(v)
    }
    run = system.simulate(end + SAME, start=start, times=np.array([0.0, end]))
    if int(run.outcome):
        return f"refused: outcome {int(run.outcome)}"
    found = instants(run, system)[: len(expected)]
    for place, (a, b) in enumerate(zip(expected, found, strict=False)):
        if abs(a[0] - b[0]) > 1e-8 or a[1] != b[1]:
            return f"wrong at {place}: {a} for {b}"
    if len(found) < len(expected):
        return f"wrong: {len(found)} instants for {len(expected)}"
    final = np.array([float(run[name][-1]) for name in system.states])
    error = abs(final - truth.state).max()
    return "ok" if error < 1e-8 else f"wrong: state by {error:.1e}"


@pytest.mark.parametrize(
    "seed",
    [1, 2, *(pytest.param(seed, marks=pytest.mark.release) for seed in range(3, 16))],
)
def test_contacts_that_are_coupled_agree_with_an_integrator_apart(seed):
    assert compare(seed) == "ok"


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
