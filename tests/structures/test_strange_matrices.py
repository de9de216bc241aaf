"""Strange everyday matrices: penalties, rigid links, no mass, other units, double roots."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse as sp

from squealpipe import Contact, Structure
from squealpipe.codes import Verdict
from squealpipe.schema import Outcome
from squealpipe.structures import elastic_pad
from squealpipe.structures.assess.assess import judge_structure
from squealpipe.structures.assess.designs import Design
from squealpipe.structures.squeal import refined_levels
from squealpipe.structures.squeal.plant import Plant

SMALL = np.array([[1e5, -3e4], [-3e4, 8e4]])
CONTACT = Contact("p", {1: 1.0}, {0: 1.0}, 1e5, 100.0)


def eigenvalues(modes):
    values = modes.growth_rate.values + 2j * np.pi * modes.frequency.values
    return values[np.lexsort((values.real.round(6), values.imag.round(6)))]


def with_fixed(penalty, **further):
    stiffness = np.zeros((3, 3))
    stiffness[:2, :2] = SMALL
    stiffness[0, 2] = stiffness[2, 0] = -2e4
    stiffness[2, 2] = penalty
    return Structure(np.eye(3), stiffness, contacts=[CONTACT], mu=1.0, **further)


@pytest.mark.parametrize("kind", [">f8", ">f4", "<f2", ">i8"])
def test_numbers_of_other_machines_and_of_half_precision_are_the_same_matrix(kind):
    """scipy has no sparse matrix of them."""
    numbers = np.array([[4.0, -1.0], [-1.0, 2.0]])
    plain, other = (
        Structure(each, 8 * each, 2 * each, contacts=[CONTACT])
        for each in (numbers, numbers.astype(kind))
    )
    for name in ("mass", "given_stiffness", "given_damping"):
        one, same = getattr(plain, name), getattr(other, name)
        np.testing.assert_array_equal(one.toarray(), same.toarray())


def test_a_matrix_with_masked_entries_is_refused():
    """What lies below a mask was taken for the entry."""
    hidden = np.ma.masked_array(SMALL, [[False, True], [True, False]])
    with pytest.raises(ValueError, match=r"^stiffness: masked entries: fill them"):
        Structure(np.eye(2), hidden, contacts=[CONTACT])


@pytest.mark.parametrize(
    ("penalty", "damping"),
    [
        (1e12, 0.0),
        (1e16, 3e-3),
        (1e36, 0.0),
        *(
            pytest.param(*each, marks=pytest.mark.release)
            for each in (
                (1e12, 3e-3),
                (1e16, 0.0),
                (1e20, 0.0),
                (1e20, 3e-3),
                (1e36, 3e-3),
            )
        ),
    ],
)
def test_a_penalty_fixes_a_degree_of_freedom_and_changes_nothing_else(penalty, damping):
    modes = with_fixed(penalty, modal_damping=damping).complex_modes()
    alone = Structure(
        np.eye(2), SMALL, contacts=[CONTACT], mu=1.0, modal_damping=damping
    ).complex_modes()
    near = 1e5 / penalty * 1e3 + 1e-9
    for name in ("frequency", "growth_rate"):
        assert modes[name].values[:2] == pytest.approx(alone[name].values, rel=near)
    assert modes.critical_mu.values[0] == pytest.approx(
        alone.critical_mu.values[0], abs=max(1e-9, 1e5 / penalty)
    )
    assert modes.unstable.values[:2].any()
    fixed = modes.attrs["fixed_degrees_of_freedom"]
    assert modes.sizes["mode"] == 3 - fixed
    assert fixed == (penalty >= 1e16)


def test_what_a_penalty_fixes_is_not_run():
    """A run in the mode of the penalty did not end, or ended in a division by zero."""
    plant = Plant(with_fixed(1e20, modal_damping=3e-3))
    alone = Plant(Structure(np.eye(2), SMALL, contacts=[CONTACT], modal_damping=3e-3))
    assert plant.size == 2
    assert plant.obstacle is None
    assert plant.structure.modes.shape == (3, 2)
    assert plant.structure.stiffness_at_rest.diagonal() == pytest.approx(
        la.eigvalsh(alone.structure.stiffness_at_rest.toarray())
    )


def test_what_penalties_fix_of_a_larger_structure_is_in_none_of_its_coordinates():
    """A level in more modes was to be that in all, those of the penalties among them."""
    pad, fixed = elastic_pad(elements=(8, 2), modal_damping=0.01), 10
    none = np.zeros(fixed)
    contacts = [
        replace(
            contact,
            normal=np.concatenate([contact.direction("normal", pad.size), none]),
            tangential=np.concatenate(
                [contact.direction("tangential", pad.size), none]
            ),
        )
        for contact in pad.contacts
    ]
    mass, stiffness = (
        sp.block_diag([matrix, value * sp.eye_array(fixed)])
        for matrix, value in ((pad.mass, 1e-3), (pad.stiffness, 1e20))
    )
    structure = Structure(mass, stiffness, contacts=contacts, modal_damping=0.01)
    design = Design.of(structure)
    assert design.whole.size <= pad.size
    refined = refined_levels.more_modes(design.reduction)
    assert refined.size == pad.size


def test_a_penalty_changes_neither_verdict_nor_level():
    given = {"contacts": [CONTACT], "mu": 1.0, "modal_damping": 3e-3}
    alone, held = (
        judge_structure(structure, samples=0, seed=0, tol=1e-12).without_cures()
        for structure in (
            Structure(np.eye(2), SMALL, **given),
            Structure(np.eye(3), la.block_diag(SMALL, 1e20), **given),
        )
    )
    assert int(alone.verdict) != Verdict.quiet
    for name in ("verdict", "frequency", "separated_fraction", "n_modes"):
        assert float(held[name]) == pytest.approx(float(alone[name]), rel=1e-6), name


def test_the_issues_fixed_degree_of_freedom_has_the_numbers_of_the_closed_form():
    modes = with_fixed(1e36).complex_modes()
    # λ² − trace λ + determinant of [[1e5, −3e4 + 1e5], [−3e4, 1.8e5]]
    trace, determinant = 2.8e5, 1.8e10 + 3e4 * 7e4
    square = (trace + np.sqrt(complex(trace**2 - 4 * determinant))) / 2
    root = 1j * np.sqrt(square)
    assert np.abs(modes.growth_rate.values) == pytest.approx(
        2 * [abs(root.real)], rel=1e-9
    )
    assert modes.frequency.values == pytest.approx(
        2 * [abs(root.imag) / (2 * np.pi)], rel=1e-12
    )
    assert modes.critical_mu.values == pytest.approx(2 * [5 / 6], abs=1e-10)


@pytest.mark.parametrize("link", [1e9, 1e12, 1e14])
def test_a_rigid_link_leaves_the_modes_that_extended_precision_has(link):
    stiffness = np.array([[1e5, 0, -1e4], [0, 8e4, -2e4], [-1e4, -2e4, 5e4]])
    stiffness[:2, :2] += link * np.array([[1.0, -1.0], [-1.0, 1.0]])
    modes = Structure(np.eye(3), stiffness).complex_modes()
    with mpmath.workdps(40):
        squares = sorted(
            mpmath.eigsy(mpmath.matrix(stiffness.tolist()), eigvals_only=True)
        )
    expected = [float(mpmath.sqrt(each) / (2 * mpmath.pi)) for each in squares]
    assert modes.frequency.values == pytest.approx(expected, rel=1e-9)
    assert (modes.outcome == Outcome.converged).all()


def test_where_a_rigid_link_has_taken_the_digits_no_mode_is_said_to_be_stable():
    stiffness = np.array([[1e5, 0.0], [0.0, 8e4]])
    stiffness += 1e22 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    modes = Structure(np.eye(2), stiffness).complex_modes()
    error = modes.growth_rate_error.values
    value = np.hypot(modes.growth_rate.values, 2 * np.pi * modes.frequency.values)
    lost = error > value
    assert lost.any()
    assert (modes.outcome.values[lost] == Outcome.rigid_mode).all()


def test_a_mass_that_is_next_to_nothing_is_condensed():
    stiffness = np.array([[1e5, -5e4, -1e4], [-5e4, 8e4, 0], [-1e4, 0, 5e4]])
    modes = Structure(np.diag([1, 1e-20, 1.0]), stiffness).complex_modes()
    condensed = (
        stiffness[::2, ::2] - np.outer(stiffness[::2, 1], stiffness[1, ::2]) / 8e4
    )
    expected = np.sqrt(np.linalg.eigvalsh(condensed)) / (2 * np.pi)
    assert modes.frequency.values == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("unit", [1e-6, 1e-3, 1e3, 1e6])
def test_rotations_in_other_units_change_nothing(unit):
    scale = np.diag([1.0, unit, 1.0])
    mass = scale @ np.array([[2.0, 0.5, 0], [0.5, 3.0, 0.2], [0, 0.2, 1.0]]) @ scale
    plain = np.array([[1e5, -5e4, -1e4], [-5e4, 8e4, 0], [-1e4, 0, 5e4]])
    modes = Structure(mass, scale @ plain @ scale).complex_modes()
    unscaled = np.linalg.inv(scale)
    same = Structure(unscaled @ mass @ unscaled, plain).complex_modes()
    assert modes.frequency.values == pytest.approx(same.frequency.values, rel=1e-11)


def test_critical_damping_is_an_answer():
    modes = Structure([[1.0]], [[100.0]], [[20.0]]).complex_modes()
    assert modes.growth_rate.values == pytest.approx([-10.0] * 2, abs=1e-6)
    assert (modes.growth_rate_error < 1e-5).all()
    assert (modes.frequency == 0).all()
    every = Structure(np.eye(2), SMALL, modal_damping=1.0).complex_modes()
    roots = np.repeat(-np.sqrt(np.linalg.eigvalsh(SMALL)), 2)
    assert np.sort(every.growth_rate.values) == pytest.approx(np.sort(roots), rel=1e-6)


def test_a_sweep_passes_critical_damping():
    swept = Structure([[1.0]], [[100.0]], [[10.0]]).complex_modes(
        damping=[1.0, 1.9, 2.0, 2.1]
    )
    first = swept.growth_rate.isel(mode=0).values
    assert first == pytest.approx([-5.0, -9.5, -10.0, first[-1]], abs=1e-6)
    assert first[-1] ** 2 + 21.0 * first[-1] + 100.0 == pytest.approx(0.0, abs=1e-9)


def test_two_free_masses_joined_by_a_dashpot_have_the_roots_of_their_difference():
    modes = Structure(np.eye(2), np.zeros((2, 2)), [[5, -5], [-5, 5]]).complex_modes()
    assert np.sort(modes.growth_rate.values) == pytest.approx([-10, 0, 0, 0], abs=1e-6)
    still = modes.growth_rate.values > -1.0
    assert (modes.outcome.values[still] == Outcome.rigid_mode).all()
    assert not modes.unstable.any()


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e4])
def test_at_exact_onset_the_stated_error_of_growth_is_that_of_a_double_root(scale):
    contact = Contact("p", {1: 1.0}, {0: 1.0}, 1e5 * scale, 100.0)
    at_onset = Structure(np.eye(2), SMALL * scale, contacts=[contact], mu=5 / 6)
    modes = at_onset.complex_modes(mu=[5 / 6])
    # [[1e5, a − 3e4], [−3e4, 1.8e5]] with a = 1e5 mu has the double square 1.4e5
    angular = np.sqrt(1.4e5 * scale)
    assert 2 * np.pi * modes.frequency.values[0] == pytest.approx(angular, rel=1e-7)
    assert (np.abs(modes.growth_rate) <= 1e-7 * angular).all()
    # it was larger than the frequency: 920 1/s at 375 rad/s
    assert (modes.growth_rate_error <= 1e-6 * angular).all()
    assert (modes.outcome == Outcome.converged).all()


def test_a_number_of_modes_does_not_cut_off_the_one_that_grows():
    flutter = Structure(np.eye(2), SMALL, contacts=[CONTACT], mu=1.0)
    modes = flutter.complex_modes(n_modes=1)
    # the two that have merged have one frequency; that which decays was kept
    assert modes.growth_rate.values == pytest.approx([29.78648005])
    assert modes.unstable.all()


def slider(damped, speed=2.0, **further):
    """A mass on springs along, across and away from the belt, each by itself without friction."""
    contact = Contact(
        "p", {2: 1.0}, {0: 1.0}, 1e5, 100.0, across={1: 1.0}, transverse_damping=damped
    )
    stiffness = np.diag([3e5, 2e5, 4e5])
    return Structure(
        2.0 * np.eye(3),
        stiffness,
        contacts=[contact],
        mu=0.4,
        belt_speed=speed,
        **further,
    )


@pytest.mark.parametrize("speed", [2.0, -0.5])
def test_friction_that_turns_with_the_velocity_damps_across_as_a_difference_of_forces_does(
    speed,
):
    modes = slider(damped=True, speed=speed).complex_modes()
    force = float(modes.normal_force.squeeze())
    # Coulomb friction in the plane is μN (w, −v)/√(w² + v²) at the velocity v across
    step = 1e-4
    rate = 0.4 * force * step / np.hypot(speed, step) / step
    across = int(np.abs(modes.frequency.values - np.sqrt(1e5) / (2 * np.pi)).argmin())
    assert modes.growth_rate.values[across] == pytest.approx(-rate / 4.0, rel=1e-6)
    others = np.delete(modes.growth_rate.values, across)
    assert others == pytest.approx(0.0, abs=1e-6)
    assert (slider(damped=False, speed=speed).complex_modes().growth_rate == 0).all()


def test_transverse_damping_needs_a_direction_across_and_is_refused_in_runs():
    with pytest.raises(ValueError, match="needs the direction across"):
        Contact("p", {1: 1.0}, {0: 1.0}, 1e5, 100.0, transverse_damping=True)
    with pytest.raises(ValueError, match="leave it out there"):
        slider(damped=True).system()


def test_penalties_of_any_size_stand_beside_each_other():
    stiffness = np.diag([0.0, 0.0, 1e20, 1e36])
    stiffness[:2, :2] = SMALL
    stiffness[2, 3] = stiffness[3, 2] = stiffness[0, 3] = stiffness[3, 0] = -2e4
    modes = Structure(np.eye(4), stiffness).complex_modes()
    expected = np.sqrt(np.linalg.eigvalsh(SMALL)) / (2 * np.pi)
    assert modes.frequency.values == pytest.approx(expected, rel=1e-12)
    assert modes.attrs["fixed_degrees_of_freedom"] == 2


@pytest.mark.parametrize("mass", [1e-9, 1e-14])
def test_a_row_without_mass_to_speak_of_on_a_dashpot_follows_late(mass):
    stiffness = np.array([[1e5, -5e4], [-5e4, 8e4]])
    modes = Structure(
        np.diag([1.0, mass]), stiffness, np.diag([0.0, 200.0])
    ).complex_modes()
    # (s² + 1e5) (200 s + 8e4) − 2.5e9 = 0 without that mass
    roots = np.roots([200.0, 8e4, 200.0 * 1e5, 8e9 - 2.5e9])
    pair = roots[roots.imag > 0][0]
    place = int(modes.frequency.values.argmax())
    assert modes.frequency.values[place] == pytest.approx(pair.imag / (2 * np.pi), 1e-6)
    assert modes.growth_rate.values[place] == pytest.approx(pair.real, rel=1e-6)


def coupled_one_way(stiffness, turn, contact):
    """Equal frequencies of two motions, of which friction couples one into the other alone.

    The double eigenvalue has one vector, and nothing grows.
    """
    first, second = turn[:, 0], turn[:, 1]
    return Structure(
        sp.eye_array(len(first)),
        stiffness,
        contacts=[
            Contact(
                "c", normal=first, tangential=second, stiffness=contact, preload=1.0
            )
        ],
        mu=0.5,
    )


@pytest.mark.parametrize("seed", [1, 7, 57, 63])
def test_a_double_frequency_that_friction_couples_one_way_does_not_grow(seed):
    """Growth of 1e-5 1/s was told, 2.4 times its stated error."""
    rng = np.random.default_rng(seed)
    size = int(rng.integers(2, 30))
    squares, contact = 10 ** rng.uniform(5, 9, size), 10 ** rng.uniform(5, 8)
    squares[1] = squares[0] + contact
    turn = la.qr(rng.normal(size=(size, size)))[0]
    stiffness = turn @ np.diag(squares) @ turn.T
    pad = coupled_one_way(0.5 * (stiffness + stiffness.T), turn, contact)
    assert not pad.complex_modes(critical=False).unstable.any()


def test_double_frequencies_of_a_large_structure_do_not_grow():
    rng = np.random.default_rng(0)
    links = 10 ** rng.uniform(6, 7, 521)
    chain = sp.diags_array(
        [links[:-1] + links[1:], -links[1:-1], -links[1:-1]], offsets=[0, 1, -1]
    )
    twins = sp.lil_array(sp.block_diag([chain, chain]))
    twins[525, 525] += 1e6  # as the contact adds to the first of both
    turn = np.zeros((1040, 2))
    turn[5, 0] = turn[525, 1] = 1.0
    modes = coupled_one_way(twins.tocsr(), turn, 1e6).complex_modes(
        n_modes=6, critical=False
    )
    assert not modes.unstable.any()
    # each frequency of the chain is there twice
    pairs = modes.frequency.values.reshape(3, 2)
    assert pairs[:, 0] == pytest.approx(pairs[:, 1], rel=1e-6)


@pytest.mark.parametrize(
    ("corner", "message"),
    [(0.2, "; a symmetric one is needed"), (0.0, "only one triangle is there")],
)
def test_a_mass_that_is_not_symmetric_is_refused(corner, message):
    with pytest.raises(ValueError, match=message):
        Structure([[2.0, 0.1], [corner, 3.0]], np.eye(2))


def test_a_mass_that_round_off_made_asymmetric_is_made_symmetric():
    mass = Structure([[2.0, 0.1], [0.1 + 1e-14, 3.0]], np.eye(2)).mass.toarray()
    assert mass[0, 1] == mass[1, 0] == pytest.approx(0.1, rel=1e-12)
