"""Complex modes of structures against published numbers, closed forms and other eigensolvers."""

import json
import os
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
import scipy.io
import scipy.linalg
import scipy.sparse as sp
from scipy.sparse.linalg import LinearOperator, eigs, splu

from squealpipe import Contact, Structure
from squealpipe.brake.linear.maps import stability_map
from squealpipe.parameters import Parameters
from squealpipe.structures import elastic_pad
from squealpipe.structures.complex_modes import _numbers
from squealpipe.structures.modes import modal_damping_of
from squealpipe.structures.pencil import Pencil
from squealpipe.structures.schema.structures import Onset
from squealpipe.structures.sliding import NoSlidingError, steady_sliding

EIGENVALUES = Path(__file__).with_name("eigenvalues_of_30_digits.json")
FIX = os.environ.get("SQUEALPIPE_FIX")
"""Writes the frozen eigenvalues anew: SQUEALPIPE_FIX=1 python -m pytest -m release -n 0 FILE."""
BRAKE = Path(
    os.environ.get(
        "SQUEALPIPE_BRAKE_MATRICES",
        Path(__file__).resolve().parents[3] / "shared/data/brake_squeal",
    )
)


def unstable(modes):
    """Growth rates, 1/s, and frequencies, Hz, of the unstable modes."""
    chosen = modes.unstable.values
    return modes.growth_rate.values[chosen], modes.frequency.values[chosen]


def hoffmann(mu, **further):
    """Hoffmann et al. (2002): y pressed on the belt, so N = −y of what differs from sliding."""
    contact = Contact(
        "c", normal={1: -1.0}, tangential={0: 1.0}, stiffness=4 / 3, preload=1.0
    )
    stiffness = np.array([[2.0, -1.0], [-1.0, 2 / 3]])
    return Structure(np.eye(2), stiffness, contacts=[contact], mu=mu, **further)


def test_hoffmanns_modes_merge_at_three_quarters_of_friction_with_frequency_root_two():
    modes = hoffmann(0.9, belt_speed=-1.0).complex_modes()
    assert modes.critical_mu.values == pytest.approx([0.75, 0.75], abs=1e-10)
    assert list(modes.merges_with.values) == [2, 1]
    at_onset = hoffmann(0.75, belt_speed=-1.0).complex_modes()
    # merged frequencies depend on round-off by its root
    assert 2 * np.pi * at_onset.frequency.values == pytest.approx(
        [2**0.5] * 2, abs=1e-7
    )
    assert not at_onset.unstable.any()
    # a belt the other way does not couple the modes
    assert not hoffmann(0.9, belt_speed=1.0).complex_modes().unstable.any()


def test_the_mass_on_two_springs_has_the_stability_of_a3():
    alpha1, alpha2 = 0.4, 1.9
    p = Parameters(
        mass=2.0, k1=3.0, k2=1.5, k3=0.8, mu=0.4, damping1=0.03, damping2=0.01
    )
    c1, s1, c2, s2 = np.cos(alpha1), np.sin(alpha1), np.cos(alpha2), np.sin(alpha2)

    def pair(first, second):
        one, other = np.array([c1, s1]), np.array([-c2, s2])
        return first * np.outer(one, one) + second * np.outer(other, other)

    contact = Contact(
        "k3", normal={1: 1.0}, tangential={0: 1.0}, stiffness=p.k3, preload=p.k3
    )
    structure = Structure(
        p.mass * np.eye(2),
        pair(p.k1, p.k2),
        pair(p.damping1, p.damping2),
        contacts=[contact],
        mu=p.mu,
        belt_speed=p.belt_speed,
        load=0,
    )
    modes = structure.complex_modes()
    a3 = stability_map(p, [alpha1], [alpha2])
    assert modes.growth_rate.max() == pytest.approx(a3.growth_rate.item(), rel=1e-10)
    assert 2 * np.pi * modes.frequency.values == pytest.approx(
        a3.frequency.values.ravel(), rel=1e-10
    )


@pytest.mark.release
def test_the_elastic_pad_has_the_published_modes():
    pad = elastic_pad()
    assert pad.size == 350
    modes = pad.complex_modes(frequency_max=60e3)
    growth, frequency = unstable(modes)
    assert growth == pytest.approx([2333.26, 3458.64], abs=0.005)
    assert frequency == pytest.approx([9744.40, 41694.48], abs=0.005)
    critical = modes.critical_mu.values[modes.unstable.values]
    assert critical[0] == pytest.approx(0.370483, abs=5e-7)
    less = pad.complex_modes(mu=0.3, frequency_max=60e3)
    assert unstable(less)[0] == pytest.approx([1954.78], abs=0.005)
    assert unstable(less)[1] == pytest.approx([41692.56], abs=0.005)
    # one mode alone is at the critical friction: growth vanishes below and does not above
    for share, grows in ((1 - 1e-9, 1), (1 + 1e-9, 2)):
        near = pad.complex_modes(mu=[critical[0] * share], frequency_max=60e3)
        assert int(near.unstable.sum()) == grows


def test_one_contact_keeps_the_two_modes_that_its_directions_need():
    assert elastic_pad(contacts=1).reduce().record["n_modes"] == 2
    with pytest.raises(ValueError, match="from 2 "):
        elastic_pad(contacts=1).reduce(n_modes=1)


@pytest.mark.release
def test_a_reduced_pad_states_errors_that_are_true():
    pad = elastic_pad()
    reduced = pad.reduce(frequency_max=60e3)
    assert reduced.record["n_modes"] == 11
    assert pad.reduce(n_modes=24, frequency_max=60e3).record["growth_rate_error"] > 0.01
    fourteen = pad.reduce(n_modes=14, frequency_max=60e3)
    growth, frequency = unstable(fourteen.complex_modes(frequency_max=60e3))
    assert growth == pytest.approx([2326.63, 3456.75], abs=0.01)
    assert frequency == pytest.approx([9685.60, 41696.53], abs=0.01)
    whole = unstable(pad.complex_modes(frequency_max=60e3))
    assert fourteen.record["frequency_error"] == pytest.approx(
        np.abs(frequency / whole[1] - 1).max(), rel=1e-6
    )
    assert fourteen.record["growth_rate_error"] == pytest.approx(
        np.abs(growth / whole[0] - 1).max(), rel=1e-6
    )
    # amplitudes become displacements: the same static deformation under the mean of both loads
    assert fourteen.modes.T @ pad.mass @ fourteen.modes == pytest.approx(
        np.eye(14), abs=1e-10
    )
    assert fourteen.modes.T @ pad.normals == pytest.approx(fourteen.normals)


def random_structure(generator):
    """2 to 40 degrees of freedom with dashpots, gyroscopic, circulatory or falling parts."""
    size = 2 + int(39 * generator.random() ** 3)  # most are small: 30 digits cost

    def square():
        return generator.standard_normal((size, size)) / np.sqrt(size)

    def with_each(part):
        return part if generator.random() < 0.5 else 0.0

    mass, stiffness = square(), square()
    mass = mass @ mass.T + 0.3 * np.eye(size)
    stiffness = 10.0 * stiffness @ stiffness.T + with_each(np.eye(size))
    gyroscopic, circulatory, dashpots = square(), square(), square()
    damping = with_each(0.05 * dashpots @ dashpots.T) + with_each(
        gyroscopic - gyroscopic.T
    )
    stiffness = stiffness + with_each(0.3 * (circulatory - circulatory.T))
    contacts = [
        Contact(
            f"c{number}",
            generator.standard_normal(size),
            generator.standard_normal(size),
            stiffness=generator.uniform(0.5, 5.0),
            preload=generator.uniform(0.5, 2.0),
            speed=generator.choice([-1.0, 0.5, 2.0]),
        )
        for number in range(int(generator.integers(0, size // 2 + 1)))
    ]
    law = "exponential" if generator.random() < 0.5 else "coulomb"
    return Structure(
        mass,
        stiffness,
        damping + np.zeros((size, size)),
        contacts=contacts,
        mu=generator.uniform(0.1, 0.6),
        mu_static=0.8,
        friction_law=law,
        friction_speed=1.5,
    )


def slides(structure):
    try:
        steady_sliding(structure, structure.mu, structure.belt_speed)
    except NoSlidingError:
        return False
    return True


def precise_pencil(structure, closed):
    """M, C and K of the pencil as the issue prints it, (n, n) each, of mpmath's numbers."""
    acting, gaps = [], []
    mass, damping, stiffness = (
        mpmath.matrix(each.toarray().tolist())
        for each in (structure.mass, structure.damping, structure.stiffness)
    )
    load = mpmath.matrix(structure.load.tolist())
    for is_closed, n, t, contact in zip(
        closed,
        structure.normals.T,
        structure.tangentials.T,
        structure.contacts,
        strict=True,
    ):
        if not is_closed:
            continue
        direction = mpmath.sign(contact.speed * structure.belt_speed)
        speed = abs(mpmath.mpf(contact.speed) * structure.belt_speed)
        mu, slope = mpmath.mpf(structure.mu), mpmath.mpf(0)
        if structure.friction.friction_law == "exponential":
            fall = (structure.friction.static_mu - mu) * mpmath.exp(-speed / 1.5)
            mu, slope = mu + fall, -fall / 1.5
        n, t = (mpmath.matrix(each.tolist()) for each in (n, t))
        acting.append(n + direction * mu * t)
        gaps.append((contact, n, t, slope))
        stiffness += contact.stiffness * (acting[-1] * n.T)
        load += contact.preload * acting[-1]
    sliding = mpmath.lu_solve(stiffness, load)
    for contact, n, t, slope in gaps:
        force = contact.preload - contact.stiffness * (n.T * sliding)[0]
        damping += force * slope * (t * t.T)
    return mass, damping, stiffness


def precise_eigenvalues(pencil):
    """Eigenvalues in 30 digits, real ones and Im s > 0, ascending by Im s.

    LAPACK's pairs (s, v) are improved by Newton's steps: residuals are of 30 digits, and a matrix
    of doubles makes an error at least 1e-9 times as large at each step.
    """
    rows = [each.tolist() for each in pencil]
    mass, damping, stiffness = (np.array(each, float) for each in rows)
    size = len(mass)
    linear = np.zeros((2 * size, 2 * size))
    linear[:size, size:] = np.eye(size)
    linear[size:, :size] = -np.linalg.solve(mass, stiffness)
    linear[size:, size:] = -np.linalg.solve(mass, damping)
    starts, vectors = np.linalg.eig(linear)
    values = []
    for start, vector in zip(starts, vectors.T, strict=True):
        if start.imag < 0:
            continue
        at = vector[:size, None]
        dynamic = start**2 * mass + start * damping + stiffness
        slope = (2.0 * start * mass + damping) @ at
        border = np.block([[dynamic, slope], [at.conj().T, np.zeros((1, 1))]])
        s, v = mpmath.mpmathify(start), [mpmath.mpmathify(each) for each in at[:, 0]]
        for _ in range(4):
            parts = [[mpmath.fdot(row, v) for row in each] for each in rows]
            missed = [(s * m + c) * s + k for m, c, k in zip(*parts, strict=True)]
            change = np.linalg.solve(border, [*map(complex, missed), 0.0])
            v = [x - d for x, d in zip(v, change[:-1].tolist(), strict=True)]
            s -= complex(change[-1])
        assert abs(change[-1]) < 1e-26 * abs(s)
        values.append(mpmath.chop(s, 1e-24 * abs(s)))  # without damping none grows
    return sorted(values, key=lambda s: (s.imag, s.real))


def sliding_structure(seed):
    """A random structure that slides steadily: one of 140 does not."""
    generator = np.random.default_rng([46, seed])
    structure = random_structure(generator)
    while not slides(structure):
        structure = random_structure(generator)
    return structure


def frozen_eigenvalues():
    """Eigenvalues of these structures in 30 digits, rounded to doubles, by seed."""
    return json.loads(EIGENVALUES.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    "seed",
    [*range(5), *(pytest.param(n, marks=pytest.mark.release) for n in range(5, 10))],
)
def test_random_structures_have_the_eigenvalues_of_30_digits(seed):
    structure = sliding_structure(seed)
    modes = structure.complex_modes()
    ours = modes.growth_rate.values + 2j * np.pi * modes.frequency.values
    # a real eigenvalue stands once in both, a pair with its upper half
    truth = np.array(frozen_eigenvalues()[str(seed)]) @ [1.0, 1.0j]
    assert len(ours) == len(truth)
    for value, error in zip(ours, modes.growth_rate_error.values, strict=True):
        nearest = truth[np.abs(truth - value).argmin()]
        assert abs(value.real - nearest.real) <= max(1e-6 * abs(nearest.real), 1e-8)
        assert abs(value.imag - nearest.imag) <= 1e-8 * abs(value)
        # what is stated is a bound; the growth rate itself is rounded
        assert abs(value.real - nearest.real) <= error + 2e-16 * abs(value)
    assert (modes.residual < 1e-12).all()


@pytest.mark.release
@pytest.mark.parametrize("seed", range(10))
def test_the_frozen_eigenvalues_are_those_of_30_digits(seed):
    structure = sliding_structure(seed)
    modes = structure.complex_modes()
    closed = modes.normal_force.values > 0 if structure.contacts else ()
    with mpmath.workdps(30):
        pencil = precise_pencil(structure, closed)
        values = precise_eigenvalues(pencil)
        # none is missing and none there twice, by traces of the linear system and of its square
        every = values + [mpmath.conj(s) for s in values if s.imag > 0]
        inverse = pencil[0] ** -1
        rates, squares = inverse * pencil[1], inverse * pencil[2]
        trace, of_square = (
            mpmath.fsum(each[place, place] for place in range(structure.size))
            for each in (rates, rates**2 - 2 * squares)
        )
        assert len(every) == 2 * structure.size
        assert abs(mpmath.fsum(every) + trace) < 1e-24 * abs(values[-1])
        assert abs(mpmath.fsum(s**2 for s in every) - of_square) < 1e-24 * abs(
            of_square
        )
    truth = [[float(v.real), float(v.imag)] for v in values]
    if FIX:
        frozen = frozen_eigenvalues() | {str(seed): truth}
        EIGENVALUES.write_text(json.dumps(frozen, indent=0) + "\n", encoding="utf-8")
    np.testing.assert_allclose(
        frozen_eigenvalues()[str(seed)], truth, rtol=1e-15, atol=0
    )


@pytest.mark.parametrize("preload", [1e3, 1e6])
def test_the_stated_error_of_growth_bounds_that_of_a_force_which_all_but_vanishes(
    preload,
):
    """Preload and load all but cancel: the falling law then damps with few digits.

    Those that the larger preload leaves cost more than what rounding does to the eigenvalues.
    """
    stiffness, support, mass = 3.0, 7.0, 2.0
    # N = preload − k q₁ with (support + k) q₁ = f + preload
    load = preload * support / stiffness * (1.0 - 1e-9 / 3.0)
    contact = Contact("c", {0: 1.0}, {1: 1.0}, stiffness, preload)
    structure = Structure(
        mass * np.eye(2),
        support * np.eye(2),
        contacts=[contact],
        load=[load, 0.0],
        mu=0.1,
        mu_static=0.7,
        friction_law="exponential",
        belt_speed=1.0,
        friction_speed=0.5,
    )
    q = (Fraction(load) + Fraction(preload)) / Fraction(support + stiffness)
    force = Fraction(preload) - Fraction(stiffness) * q
    with mpmath.workdps(30):
        slope = -(mpmath.mpf(0.7) - mpmath.mpf(0.1)) / 0.5 * mpmath.exp(-2)
        damping = mpmath.mpf(force.numerator) / force.denominator * slope
        truth = float(-damping / (2 * mass))
    modes = structure.complex_modes(mu=[0.1])
    grown = int(modes.growth_rate.argmax(...)["mode"])
    error = abs(modes.growth_rate.values[0, grown] - truth)
    assert error > 1e-12 * truth
    assert error <= modes.growth_rate_error.values[0, grown] < 1e-3 * truth


needs_matrices = pytest.mark.skipif(
    not (BRAKE / "BMLL00.mat").is_file(),
    reason="matrices of BrakeSqueal0.1 are not there; SQUEALPIPE_BRAKE_MATRICES names their folder",
)


def brake(speed):
    """M, C, K of BrakeSqueal0.1 at a speed, rad/s; the formula of its own code, not NLEVP's."""
    files = [
        "BMLL00",
        "BDLL00",
        "BYLL00",
        "BDIWLL00",
        "BHLL00",
        "BKLL00",
        "BKQLL00",
        "BWLL00",
    ]
    parts = []
    for name in files:
        content = scipy.io.loadmat(BRAKE / f"{name}.mat", spmatrix=False)
        parts.append(next(value for key, value in content.items() if key[0] != "_"))
    mass, d1, dg, dr, d4, k1, kr, kg = map(sp.csc_array, parts)
    damping = d1 + dg * speed + dr * (1 / speed - 1) + d4 / (3200 * np.pi)
    return mass, damping, k1 + kr + kg * (speed**2 - 1)


@needs_matrices
@pytest.mark.release
def test_the_public_brake_has_its_unstable_modes():
    mass, damping, stiffness = brake(4 * np.pi)
    structure = Structure(mass, stiffness, damping)
    growth, frequency = unstable(
        structure.complex_modes(frequency_max=42000 / (2 * np.pi))
    )
    truth = {
        4932.238867: 5.47417370,
        5130.604865: 9.587160e-5,
        17399.587753: 74.83064247,
        26257.963487: 119.17648927,
        36380.522879: 0.57378727,
    }
    assert 2 * np.pi * frequency == pytest.approx(list(truth), rel=1e-10)
    assert growth == pytest.approx(list(truth.values()), rel=1e-7, abs=1e-9)


@needs_matrices
@pytest.mark.release
@pytest.mark.parametrize("speed", [2.0, 50.0])
def test_the_public_brakes_modes_agree_with_another_linearization(speed):
    """Arnoldi on the second companion form, another shift an eigenvalue, without refinement."""
    mass, damping, stiffness = brake(speed)
    modes = Structure(mass, stiffness, damping).complex_modes(
        frequency_max=42000 / (2 * np.pi)
    )
    growth, frequency = unstable(modes)
    size = mass.shape[0]
    truth = {}
    for center in 1j * np.arange(1000.0, 42500.0, 3000.0):
        factors = splu(sp.csc_array(mass * center**2 + damping * center + stiffness))

        def apply(x, center=center, factors=factors):
            # x = (s M v + C v, v): (A − cB) y = B x of [[0, −K], [1, −C]], [[1, 0], [0, M]]
            first, second = x[:size], x[size:]
            v = -factors.solve(first + center * (mass @ second))
            return np.concatenate([(-stiffness @ v - first) / center, v])

        operator = LinearOperator((2 * size, 2 * size), apply, dtype=complex)
        values = center + 1 / eigs(operator, k=12, tol=0, return_eigenvectors=False)
        for value in values:
            if value.real > 1e-7 and 0 < value.imag < 42000:
                near = [
                    known for known in truth if abs(known - value) < 1e-6 * abs(value)
                ]
                distance = abs(value - center)
                for known in near:
                    if truth[known] <= distance:
                        break
                    del truth[known]
                else:
                    truth[value] = distance
    found = sorted(truth, key=lambda value: value.imag)
    assert 2 * np.pi * frequency == pytest.approx([v.imag for v in found], rel=1e-8)
    assert growth == pytest.approx([v.real for v in found], rel=1e-6, abs=1e-6)


@pytest.mark.release
def test_growth_at_a_sparse_structures_band_is_that_of_dense_algebra(monkeypatch):
    pad = elastic_pad(elements=(60, 9), modal_damping=0.01)
    assert pad.size > 1000
    shifts, factorized = [], Pencil.factorized

    def counted(pencil, s):
        shifts.append(s)
        return factorized(pencil, s)

    monkeypatch.setattr(Pencil, "factorized", counted)
    modes = pad.complex_modes(frequency_max=30e3, mu=[0.5], critical=False)
    assert len(shifts) == 2  # what modes cost: one for each search, and none to polish
    # damping of the modes up to 30 kHz alone, as an (n, n) matrix
    part = modal_damping_of(pad, None, 2 * np.pi * 30e3)
    damping = part.columns @ np.diag(part.weights) @ part.columns.T
    size = pad.size
    acting = pad.normals + 0.5 * pad.tangentials
    stiffness = pad.stiffness.toarray() + acting * pad.stiffnesses @ pad.normals.T
    linear = np.zeros((2 * size, 2 * size))
    unit = 1e5  # rad/s: both halves of the vector are of one size
    linear[:size, size:] = unit * np.eye(size)
    inverse = np.linalg.inv(pad.mass.toarray())
    linear[size:, :size] = -inverse @ stiffness / unit
    linear[size:, size:] = -inverse @ damping
    truth = np.linalg.eigvals(linear)
    top = 2 * np.pi * 30e3
    truth = truth[
        (truth.imag >= 0) & (truth.imag <= top) & (np.abs(truth.real) <= top / 4)
    ]
    truth = truth[np.argsort(truth.imag)]
    assert 2 * np.pi * modes.frequency.values.ravel() == pytest.approx(
        truth.imag, rel=1e-8
    )
    assert modes.growth_rate.values.ravel() == pytest.approx(
        truth.real, rel=1e-4, abs=1e-2
    )


def test_a_pad_has_one_critical_friction_for_both_directions_of_the_belt():
    pad = elastic_pad(elements=(6, 2))
    modes = pad.complex_modes(
        mu=np.linspace(0, 0.8, 5), belt_speed=[-2.0, 2.0], frequency_max=60e3
    )
    one, other = (modes.isel(belt_speed=i) for i in (0, 1))
    assert np.isfinite(one.critical_mu).sum() == 4
    assert one.critical_mu.values == pytest.approx(
        other.critical_mu.values, abs=1e-10, nan_ok=True
    )
    assert one.growth_rate.values == pytest.approx(other.growth_rate.values, abs=1e-6)


def test_steady_sliding_is_met_where_one_contact_after_the_other_would_come_back():
    """The first contact is open: a state that pivoting from all closed ones passes by."""
    contacts = [
        Contact("a", {0: 1.0}, {1: 3.0, 2: 3.0}, stiffness=5.0, preload=2.0),
        Contact("b", {1: 1.0}, {0: 3.0, 1: -3.0}, stiffness=3.0, preload=3.0),
    ]
    stiffness, load = np.diag([4.0, 5.0, 5.0]), np.array([0.0, -2.0, -2.0])
    modes = Structure(
        np.eye(3), stiffness, contacts=contacts, mu=0.8, load=load
    ).complex_modes(mu=[0.8])
    acting = np.array([2.4, 1.0 - 2.4, 0.0])
    q = np.linalg.solve(
        stiffness + 3.0 * np.outer(acting, [0.0, 1.0, 0.0]), load + 3.0 * acting
    )
    assert q[0] * 5.0 > 2.0
    assert modes.normal_force.values.ravel() == pytest.approx([0.0, 3.0 - 3.0 * q[1]])


def test_normal_forces_keep_their_digits_where_a_soft_contact_holds_a_stiff_structure():
    pair = 1e12 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    contact = Contact("c", {0: 1.0}, {1: 1.0}, stiffness=1.0, preload=0.0)
    structure = Structure(
        np.eye(2), pair, contacts=[contact], mu=0.5, load=[-3.0, -1.0]
    )
    # what the contact carries is the load along the motion of the whole
    force = structure.complex_modes(mu=[0.5]).normal_force.item()
    assert force == pytest.approx(4.0 / 1.5, rel=1e-10)
    between = Contact("c", {0: 1.0, 1: -1.0}, {1: 1.0}, stiffness=1.0, preload=1.0)
    with pytest.raises(NoSlidingError, match="add supports"):
        structure.with_(contacts=[between]).complex_modes()


def test_modes_that_cannot_grow_are_not_unstable_by_round_off():
    pair = np.array([[1.0, -1.0], [-1.0, 1.0]])  # nothing holds it
    free = Structure(np.eye(2), pair).complex_modes()
    assert free.frequency.values == pytest.approx([0.0, 2**0.5 / (2 * np.pi)])
    dashpot = Structure(np.eye(2), pair, 0.01 * pair).complex_modes()
    turning = Structure(
        np.eye(2), np.diag([1.0, 2.0]), [[0.0, 1.0], [-1.0, 0.0]]
    ).complex_modes()
    twins = [hoffmann(0.5, belt_speed=-1.0).stiffness.toarray()] * 2
    contacts = [
        Contact(name, {place + 1: -1.0}, {place: 1.0}, 4 / 3, 1.0)
        for name, place in (("a", 0), ("b", 2))
    ]
    two = Structure(
        np.eye(4),
        scipy.linalg.block_diag(*twins),
        contacts=contacts,
        mu=0.5,
        belt_speed=-1.0,
    )
    for modes in (free, dashpot, turning, two.complex_modes()):
        assert not modes.unstable.any()
    assert two.complex_modes(mu=[0.0, 0.9]).critical_mu.values == pytest.approx(
        [0.75] * 4
    )


def test_friction_by_number_is_named_stable_located_or_unstable_throughout():
    modes = hoffmann(0.5, belt_speed=-1.0).complex_modes(mu=[0.8, 0.9])
    assert set(modes.onset.values) == {Onset.unstable_throughout}
    modes = hoffmann(0.5, belt_speed=-1.0).complex_modes(mu=np.linspace(0, 0.7, 3))
    assert set(modes.onset.values) == {Onset.stable}
    assert np.isnan(modes.critical_mu).all()


def changed(pad, **contact):
    """The pad with one contact or all of another stiffness or preload, by factors."""
    factors = {name: np.broadcast_to(value, 3) for name, value in contact.items()}
    return pad.with_(
        contacts=[
            Contact(
                each.name,
                each.normal,
                each.tangential,
                each.stiffness * factors.get("stiffness", np.ones(3))[place],
                each.preload * factors.get("preload", np.ones(3))[place],
            )
            for place, each in enumerate(pad.contacts)
        ]
    )


def same_modes(chosen, alone):
    """Whether modes are the same, by growth and frequency whatever their numbers."""

    def ordered(modes):
        values = modes.growth_rate.values + 2j * np.pi * modes.frequency.values
        return np.sort_complex(values[np.isfinite(values)])

    assert ordered(chosen) == pytest.approx(ordered(alone), rel=1e-9)


def test_modes_over_any_factor_are_those_of_structures_that_have_it():
    pad = elastic_pad(
        elements=(3, 1), contacts=3, modal_damping=0.01, preload=300.0
    ).with_(friction_law="exponential", mu_static=0.8, friction_speed=2.0)
    limits = {"frequency_max": 60e3, "mu": [0.5]}
    modes = pad.complex_modes(
        preload=[0.5, 3.0], p2_stiffness=[0.5, 1.0, 2.0], **limits
    )
    assert modes.growth_rate.dims == ("mu", "preload", "p2_stiffness", "mode")
    assert modes.critical_mu.dims == ("preload", "p2_stiffness", "mode")
    at = {"preload": 3.0, "p2_stiffness": 2.0}
    alone = changed(pad, preload=3.0, stiffness=[1.0, 2.0, 1.0])
    same_modes(modes.sel(at), alone.complex_modes(**limits))
    # the falling law damps less under more load
    assert not np.allclose(
        modes.growth_rate.sel(preload=0.5), modes.growth_rate.sel(preload=3.0)
    )
    for name, value, other in (
        ("contact_stiffness", 2.0, changed(pad, stiffness=2.0)),
        ("modal_damping", 0.02, pad.with_(modal_damping=0.02)),
        ("mass", 1.5, pad.with_(mass=1.5 * pad.mass)),
        ("friction_speed", 0.7, pad.with_(friction_speed=0.7)),
    ):
        over = pad.complex_modes(**{name: [0.3, value]}, **limits)
        assert over[name].values.tolist() == [0.3, value]
        same_modes(over.sel({name: value}), other.complex_modes(**limits))
        single = pad.complex_modes(**{name: value}, **limits)
        assert name not in single.dims
        same_modes(single, other.complex_modes(**limits))


@pytest.mark.parametrize(
    ("factors", "words"),
    [
        ({"contact_stifness": [1.0]}, "did you mean 'contact_stiffness'"),
        ({"p9_stiffness": 2.0}, "p9_stiffness"),
        ({"preload": [-1.0, 1.0]}, "0 or greater"),
        ({"stiffness": [0.0, 1.0]}, "greater than 0"),
        ({"modal_damping": [0.1, 0.1]}, "each value once"),
        ({"mu_static": [0.1, 0.9]}, "0.5, the coefficient at"),
    ],
)
def test_a_factor_that_cannot_be_is_refused(factors, words):
    pad = elastic_pad(elements=(4, 2)).with_(friction_law="exponential")
    with pytest.raises(ValueError, match=words):
        pad.complex_modes(**factors)


@pytest.mark.parametrize("rounding", [0.0, 1e-12, -1e-12])
def test_of_modes_that_have_met_the_one_that_grows_is_first(rounding):
    """Round-off decided: the same flutter was mode 1 here and mode 2 there."""
    values = np.array([33 + 3e3j, -33 + 3e3j * (1 + rounding), 2e3j, 5e3j])
    spectrum = SimpleNamespace(values=values)
    step = SimpleNamespace(numbers=np.arange(4), spectrum=spectrum)
    solver = SimpleNamespace(selected=lambda _: np.ones(4, bool))
    way = SimpleNamespace(steps={0.5: step}, solver=solver)
    assert _numbers([way], [0.5]) == [2, 0, 1, 3]


def test_modal_damping_gives_each_mode_its_ratio_of_its_own_frequency():
    """Without friction the modes at rest stay, whatever the mass, and each decays by itself."""
    rng = np.random.default_rng(5)
    mass, stiffness = (
        factor @ factor.T + 0.5 * np.eye(6) for factor in rng.normal(size=(2, 6, 6))
    )
    ratios = np.array([0.003, 0.0, 0.4, 0.02])  # the others have none
    modes = Structure(mass, stiffness, modal_damping=ratios).complex_modes()
    omega = np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True))
    every = np.append(ratios, [0.0, 0.0])
    order = np.argsort(np.hypot(2 * np.pi * modes.frequency, modes.growth_rate).values)
    np.testing.assert_allclose(
        modes.growth_rate.values[order], -every * omega, atol=1e-9
    )
    damped = omega * np.sqrt(1.0 - every**2) / (2.0 * np.pi)
    np.testing.assert_allclose(modes.frequency.values[order], damped, rtol=1e-10)
    # a ratio is over the frequency without damping, which 0.4 makes a tenth larger
    np.testing.assert_allclose(modes.damping_ratio.values[order], every, atol=1e-9)
