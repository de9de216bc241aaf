"""Where modes turn unstable, against eigenvalues of matrices put together here."""

from itertools import product

import numpy as np
import pytest

from squealpipe import Contact, Structure
from squealpipe.structures.following import successors
from squealpipe.structures.schema.structures import Onset
from squealpipe.structures.spectrum import Limits, Solver


def undamped(seed):
    """M, K, contacts' n, t, k, preload and direction of the belt, of a random structure."""
    generator = np.random.default_rng([55, seed])
    size = int(generator.integers(2, 9))
    mass, stiffness = (
        generator.standard_normal((size, size)) / np.sqrt(size) for _ in range(2)
    )
    generator.random()
    number = int(generator.integers(1, max(2, size // 2 + 1)))
    normal, tangential = (generator.standard_normal((number, size)) for _ in range(2))
    springs, preload = (
        generator.uniform(0.5, 8, number),
        generator.uniform(3, 6, number),
    )
    belt = generator.choice([-1.0, 1.0]) * generator.uniform(0.5, 3)
    speeds = generator.choice([1.0, -1.0, 2.0], number)
    return (
        mass @ mass.T + 0.5 * np.eye(size),
        10 * stiffness @ stiffness.T + np.eye(size),
        normal,
        tangential,
        springs,
        preload,
        np.sign(speeds * belt),
    )


def growing(case, mu):
    """How many of s² = −λ grow about the state that fits, of all open and closed ones."""
    mass, stiffness, normal, tangential, springs, preload, side = case
    for closed in product([1.0, 0.0], repeat=len(springs)):
        acting = ((normal + mu * (side * tangential.T).T).T * closed).T
        matrix = stiffness + (acting.T * springs) @ normal
        q = np.linalg.solve(matrix, (acting - normal).T @ preload)
        if np.array_equal(preload - springs * (normal @ q) > 0, np.array(closed) > 0):
            squares = np.linalg.eigvals(np.linalg.solve(mass, matrix))
            return int((squares.imag > 0).sum() + (squares.real < 0).sum())
    raise AssertionError("no steady sliding")


# a contact opens at 1.372 and frees a mode that grows; modes are stable again from 0.70008 to
# 0.70809 alone; two that merge part from 0.46029 to 0.46487, where one merges with a third; one
# that has merged with two others in turn grows still where a contact opens
@pytest.mark.parametrize(("seed", "located"), [(17, 4), (70, 4), (77, 5), (42, 7)])
def test_a_critical_friction_that_is_stated_is_one(seed, located):
    case = undamped(seed)
    mass, stiffness, *_, side = case
    contacts = [
        Contact(f"c{number}", *each, speed)
        for number, (each, speed) in enumerate(
            zip(zip(*case[2:6], strict=True), side, strict=True)
        )
    ]
    modes = Structure(mass, stiffness, contacts=contacts).complex_modes(
        mu=np.linspace(0, 1.5, 16)
    )
    critical = modes.critical_mu.values[np.isfinite(modes.critical_mu)]
    assert len(critical) == located
    assert Onset.not_followed not in modes.onset
    for mu in critical:
        assert growing(case, mu * (1 - 1e-9)) < growing(case, mu * (1 + 1e-9))


@pytest.mark.parametrize("nearer", [3, 4])
def test_merged_modes_stay_together_whichever_is_nearer_to_one_that_passes(nearer):
    # of seed 77 above; both are equally near to the still mode that follows, up to round-off
    mass, stiffness, *contact, _, side = undamped(77)
    contacts = [
        Contact(name, *each, speed)
        for name, each, speed in zip(
            "ab", zip(*contact, strict=True), side, strict=True
        )
    ]
    spectra = Solver(Structure(mass, stiffness, contacts=contacts), Limits(), 1.0)
    merged, later = spectra.at(0.45), spectra.at(0.5)
    pair = merged.pairs[nearer]
    towards = later.pairs[4].right * np.vdot(later.pairs[4].right, pair.right)
    merged.pairs[nearer] = pair._replace(right=pair.right + 1e-9 * towards)
    places, _ = successors(merged, later)
    np.testing.assert_allclose(
        later.values[places[3:5]].real, [-0.249, 0.249], atol=1e-3
    )


def test_a_mode_that_damping_lets_grow_alone_and_the_other_name_each_other():
    contact = Contact("c", {1: -1.0}, {0: 1.0}, stiffness=4 / 3, preload=1.0)
    hoffmann = np.array([[2.0, -1.0], [-1.0, 2 / 3]])
    modes = Structure(
        np.eye(2), hoffmann, 0.02 * np.eye(2), contacts=[contact], belt_speed=-1.0
    ).complex_modes(mu=[0.0, 0.5, 0.9])
    assert np.isfinite(modes.critical_mu).sum() == 1
    assert list(modes.merges_with.values) == [2, 1]


@pytest.mark.parametrize("beside", [-1e-13, 0.0, 1e-13])
def test_the_critical_friction_itself_may_be_among_those_asked_for(beside):
    # K + k(n + μt)nᵀ = [[10, 10μ − 3], [−3, 18]]: both of its eigenvalues are 14 at μ = 5/6
    contact = Contact("c", {1: 1.0}, {0: 1.0}, stiffness=10.0, preload=1.0)
    structure = Structure(np.eye(2), [[10.0, -3.0], [-3.0, 8.0]], contacts=[contact])
    critical = np.nextafter(5 / 6, 1) + beside
    modes = structure.complex_modes(mu=[0.0, critical, 1.0])
    assert (modes.onset == Onset.located).all()
    assert modes.critical_mu.values == pytest.approx(np.full(2, 5 / 6), abs=1e-11)


# between both frictions the contacts can be neither open nor closed: an error, or said to be
# unstable throughout
@pytest.mark.parametrize(
    ("stiffness", "normals", "tangentials", "springs", "preloads"),
    [
        ([[10, -3], [-3, 2]], [[-1, 2], [0, -1]], [[-1, -2], [2, 2]], [5, 3], [3, 3]),
        ([[1, -1], [-1, 10]], [[1, -1], [-1, -2]], [[-2, 0], [2, 1]], [2, 4], [4, 1]),
    ],
)
def test_a_mode_beyond_frictions_that_jam_is_not_followed_through_them(
    stiffness, normals, tangentials, springs, preloads
):
    contacts = [
        Contact(*each)
        for each in zip("ab", normals, tangentials, springs, preloads, strict=True)
    ]
    structure = Structure(
        np.eye(2), stiffness, modal_damping=0.01, contacts=contacts, mu=1.0
    )
    assert not structure.complex_modes(mu=[0.0]).unstable.any()
    modes = structure.complex_modes()
    assert modes.unstable.values.tolist() == [True, False, False]
    assert modes.onset[0] == Onset.not_followed
    assert np.isnan(modes.critical_mu).all()
