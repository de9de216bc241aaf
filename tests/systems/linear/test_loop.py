"""The loop of linear structures against matrix exponentials, and SciPy."""

import numpy as np
import pytest
import scipy.linalg as la
from scipy.integrate import solve_ivp

from squealpipe import Contact, Structure
from squealpipe.systems.linear.batch import numbers_of_runs
from squealpipe.systems.linear.loop import functions
from squealpipe.systems.linear.numbering import OF_CONTACT
from squealpipe.systems.linear.plan import plan
from squealpipe.systems.taylor.lanes import invoke
from tests.oracles.many_contacts import compare


def many_contacts(contacts, size, seed=0):
    """A structure with full matrices, belts in both directions, and states to start from."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(size, size)) / np.sqrt(size)
    normal, along = rng.normal(size=(2, contacts, size)) / np.sqrt(size)
    made = [
        Contact(
            f"c{i}",
            normal[i],
            along[i],
            rng.uniform(0.5, 2.0) / contacts**0.5,
            rng.uniform(0.3, 1.0),
            float(rng.choice([-1.0, 1.0])),
        )
        for i in range(contacts)
    ]
    structure = Structure(
        np.eye(size) + 0.1 * root @ root.T,
        np.eye(size) + root @ root.T,
        0.01 * np.eye(size),
        contacts=made,
        mu=0.4,
        mu_static=0.5,
        belt_speed=0.5,
    )
    return structure, 0.3 * rng.normal(size=size), 0.3 * rng.normal(size=size)


def named(system, q, v):
    return dict(zip(system.states, [*q, *v], strict=True))


@pytest.mark.parametrize(
    ("contacts", "size", "most"),
    [
        (12, 15, 6),
        pytest.param(60, 70, 20, marks=pytest.mark.release),
        pytest.param(100, 120, 20, marks=pytest.mark.release),
    ],
)
def test_many_contacts_agree_with_an_integrator_apart(contacts, size, most):
    assert compare(*many_contacts(contacts, size), most) == "ok"


def test_a_motion_without_events_is_a_matrix_exponential():
    # unsymmetric stiffness and full damping, friction in slip throughout
    rng = np.random.default_rng(3)
    size = 5
    stiffness = 4.0 * np.eye(size) + 0.3 * rng.normal(size=(size, size))
    damping = 0.1 * np.eye(size) + 0.02 * rng.normal(size=(size, size))
    n, t = np.eye(size)[0], np.eye(size)[1]
    contact = Contact("c", n, t, stiffness=2.0, preload=50.0)
    structure = Structure(
        np.eye(size), stiffness, damping, contacts=[contact], mu=0.3, belt_speed=90.0
    )
    q, v = rng.normal(size=(2, size))
    system = structure.system()
    run = system.simulate(7.0, start=named(system, q, v), times=[7.0])
    assert run.sizes["event"] == 0
    push = n + 0.3 * t  # the contact acts along it by its normal force 50 − 2 nᵀq
    matrix = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-(stiffness + 2.0 * np.outer(push, n)), -damping],
        ]
    )
    load = np.concatenate([np.zeros(size), 50.0 * (push - n)])
    rest = la.solve(matrix, -load)
    truth = rest + la.expm(7.0 * matrix) @ (np.concatenate([q, v]) - rest)
    final = np.array([float(run[name][-1]) for name in system.states])
    assert final == pytest.approx(truth, rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("law", ["exponential", "hyperbolic"])
def test_friction_that_falls_with_speed_agrees_with_scipy(law):
    stiffness = np.array([[3.0, -1.0], [-1.0, 2.0]])
    contact = Contact("c", {0: 1.0}, {1: 1.0}, stiffness=1.5, preload=2.0)
    structure = Structure(
        np.eye(2), stiffness, contacts=[contact], mu=0.3, mu_static=0.6,
        friction_law=law, friction_speed=0.4, belt_speed=-3.0,
    )  # fmt: skip
    system = structure.system()
    start = dict(zip(system.states, [0.1, -0.2, 0.3, 0.4], strict=True))
    run = system.simulate(6.0, start=start, times=[6.0])
    assert run.sizes["event"] == 0

    def rates(_, z):
        slip = -3.0 - z[3]
        fall = np.exp(-abs(slip) / 0.4)
        if law == "hyperbolic":
            fall = 0.4 / (0.4 + abs(slip))
        force = 2.0 - 1.5 * z[0]
        friction = (0.3 + 0.3 * fall) * force * np.sign(slip)
        pull = -stiffness @ z[:2] + [force - 2.0, friction]
        return [*z[2:], *pull]

    truth = solve_ivp(
        rates, (0.0, 6.0), [0.1, -0.2, 0.3, 0.4], "DOP853", rtol=1e-12, atol=1e-13
    )
    final = np.array([float(run[name][-1]) for name in system.states])
    assert final == pytest.approx(truth.y[:, -1], abs=1e-10)


@pytest.mark.parametrize("dependent", [0, 2])
def test_friction_in_stick_is_of_the_least_norm(dependent):
    structure, *_ = many_contacts(6, 8, seed=2)
    contacts = list(structure.contacts)
    for i in range(dependent):  # two directions that follow from those of the others
        mixed = contacts[2].tangential * (1.0 + i) - 0.5 * contacts[3].tangential
        old = contacts[i]
        contacts[i] = Contact(
            old.name, old.normal, mixed, old.stiffness, old.preload, old.speed
        )
    system = structure.with_(contacts=contacts).system()
    table = plan(system.matrices, system.numbering, functions())
    values = {name: np.array([x]) for name, x in system.parameters.items()}
    first = 4 + OF_CONTACT * 6
    rows = np.zeros((first + 6 * system.numbering.width, 16))
    address = table.pointer.value
    rows[:first, 0] = numbers_of_runs(
        system.matrices, system.coefficients, values, np.ones(1), address
    )[0]
    stick = [system.numbering.regime(i, "stick") for i in range(6)]
    rows[first:, 0] = system.numbering.constants_of_regimes[stick].ravel()
    invoke(functions()["settle"], rows.ctypes.data)
    truth = np.linalg.pinv(system.matrices.mobility, rcond=1e-12, hermitian=True)
    assert table.arrays["counts"][1] == dependent
    assert table.arrays["held"] == pytest.approx(truth, rel=1e-9, abs=1e-9)


def test_what_is_beyond_the_caps_says_what_it_would_take():
    contacts = [
        Contact(f"c{i}", {0: 1.0}, {1: 1.0}, stiffness=1.0, preload=1.0)
        for i in range(513)
    ]
    structure = Structure(np.eye(2), np.eye(2), contacts=contacts)
    with pytest.raises(ValueError, match=r"513 contacts: a system can have 512.* GB"):
        structure.system()
