"""A reduced structure against eigenvalues of the whole, assembled here and solved by SciPy."""

import numpy as np
import pytest
import scipy.linalg as la

from squealpipe import Contact, Structure
from squealpipe.structures import elastic_pad


def chain(links, *, mu=0.5, offset=0.0):
    """A mirror-symmetric chain of masses in a plane with a contact at each end.

    Args:
        offset: of the stiffness at one end, over itself: 0 keeps the mirror.
    """
    line = 1e8 * (2 * np.eye(links) - np.eye(links, k=1) - np.eye(links, k=-1))
    line += 1e6 * np.eye(links)
    line[0, 0] *= 1.0 + offset
    stiffness = np.zeros((2 * links, 2 * links))
    stiffness[::2, ::2], stiffness[1::2, 1::2] = line, 0.5 * line
    contacts = [
        Contact("left", {1: 1.0}, {0: 1.0}, 1e7, 100.0),
        Contact("right", {2 * links - 1: 1.0}, {2 * links - 2: 1.0}, 1e7, 100.0),
    ]
    return Structure(
        0.1 * np.eye(2 * links), stiffness, contacts=contacts, mu=mu, modal_damping=0.01
    )


def rigid_pad():
    """A rigid pad on an elastic back that rests on its leading and its trailing edge."""
    contacts = [
        Contact("leading", {1: 1.0, 2: 0.03}, {0: 1.0, 2: 0.01}, 2e7, 300.0),
        Contact("trailing", {1: 1.0, 2: -0.03}, {0: 1.0, 2: 0.01}, 2e7, 300.0),
    ]
    return Structure(
        np.diag([0.3, 0.3, 1e-4]),
        np.diag([3e7, 4e7, 1e4]),
        contacts=contacts,
        mu=0.6,
        modal_damping=0.005,
    )


def eigenvalues(structure, damping):
    """Of M s² + C s + K + Σ k (n + μ t) nᵀ with all contacts closed, from dense arrays.

    Args:
        damping: ratio of the modes of (M, K + Σ k n nᵀ).
    """
    mass, stiffness = structure.mass.toarray(), structure.stiffness.toarray()
    at_rest, rubbing = stiffness.copy(), stiffness.copy()
    for each in structure.contacts:
        n = each.direction("normal", structure.size)
        t = each.direction("tangential", structure.size)
        at_rest += each.stiffness * np.outer(n, n)
        rubbing += each.stiffness * np.outer(n + structure.mu * t, n)
    squares, shapes = la.eigh(at_rest, mass)
    to_modes = mass @ shapes
    damper = to_modes @ np.diag(2 * damping * np.sqrt(squares)) @ to_modes.T
    zero, one = np.zeros_like(mass), np.eye(len(mass))
    values = la.eigvals(
        np.block([[zero, one], [-la.solve(mass, rubbing), -la.solve(mass, damper)]])
    )
    return values[values.imag >= 0]


def test_contacts_on_one_tangent_have_complex_modes_and_are_refused_in_runs_alone():
    pad = rigid_pad()
    found = pad.complex_modes()
    ours = found.growth_rate.values + 2j * np.pi * found.frequency.values
    truth = eigenvalues(pad, 0.005)
    assert np.sort_complex(ours) == pytest.approx(np.sort_complex(truth), rel=1e-9)
    with pytest.raises(ValueError, match="dependent in the structure itself"):
        pad.system()


@pytest.mark.parametrize("links", [3, 20])
def test_a_mirror_symmetric_structure_is_reduced_by_itself(links):
    reduced = chain(links).reduce()
    assert reduced.record["agrees"]
    reduced.system()  # both contacts can stick
    assert np.linalg.matrix_rank(reduced.tangentials, tol=1e-6) == 2


def test_directions_dependent_in_the_modes_kept_name_the_number_that_suffices():
    whole = chain(20)
    few = whole.reduce(n_modes=2)
    assert few.complex_modes().sizes["mode"] == 2
    with pytest.raises(
        ValueError, match=r"contacts left and right cannot all stick"
    ) as error:
        few.system()
    enough = int(str(error.value).partition("n_modes=")[2].partition(" ")[0])
    whole.reduce(n_modes=enough).system()
    with pytest.raises(ValueError, match="dependent in the"):
        whole.reduce(n_modes=enough - 1).system()


def pad_of(seed):
    """A pad of other shape and friction; 48 to 240 degrees of freedom."""
    rng = np.random.default_rng(seed)
    elements = (int(rng.integers(5, 20)), int(rng.integers(3, 6)))
    return elastic_pad(
        length=float(rng.uniform(0.03, 0.12)),
        height=float(rng.uniform(0.008, 0.03)),
        elements=elements,
        contacts=int(rng.integers(1, min(elements[0] + 1, 6) + 1)),
        young=float(10 ** rng.uniform(9.3, 11.0)),
        contact_stiffness=float(10 ** rng.uniform(8.0, 9.5)),
        mu=float(rng.uniform(0.2, 0.9)),
        belt_speed=float(rng.uniform(0.5, 8.0)),
        modal_damping=float(10 ** rng.uniform(-3.3, -1.8)),
    )
