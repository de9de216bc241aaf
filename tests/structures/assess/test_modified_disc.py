"""A shim and a chamfer of the disc brake, against matrices that are put together here."""

from functools import cache

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as sla

from squealpipe.structures import disc_brake
from squealpipe.structures.assess.cures import cures_of
from squealpipe.structures.assess.designs import Design
from squealpipe.structures.assess.modifications import read_modification
from squealpipe.structures.quiet_intervals import linear_intervals
from squealpipe.structures.squeal.plant import in_modes

MU, SHIM, RATIO = 0.6, 0.05, 0.03
AT = 2853.365890
"""Frequency of the mode that grows, Hz."""


@cache
def brake():
    return disc_brake(mu=MU)


def closed_in_sliding(share_of_contact):
    """Contacts that press in steady sliding: those that would pull are opened one after another."""
    given = brake()
    springs, preloads = (
        given.stiffnesses * share_of_contact,
        own_preloads(share_of_contact),
    )
    closed = share_of_contact > 0.0
    while True:
        pushes = (given.normals + MU * given.tangentials) * closed
        stiffness = given.given_stiffness + sp.csr_array(
            pushes * springs
        ) @ sp.csr_array(given.normals.T)
        load = pushes @ preloads - given.normals @ preloads
        moved = sla.spsolve(stiffness.tocsc(), load)
        force = preloads - springs * (given.normals.T @ moved)
        if not (force[closed] < 0.0).any():
            assert (force[~closed] <= 0.0).all()
            return closed
        closed &= force >= 0.0


def own_preloads(share_of_contact):
    """Preloads of a chamfered face, which together carry the whole force."""
    preloads = brake().preloads * share_of_contact
    return preloads * brake().preloads.sum() / preloads.sum()


def own_value(near, added_mass=0.0, damping=0.0, share_of_contact=1.0):
    """Eigenvalue s of (M s² + C s + K) x = 0 next to a guess, by Newton's method."""
    given = brake()
    zero = sp.csr_array((given.size, given.size))
    mass = given.mass + (
        zero if np.isscalar(added_mass) else sp.diags_array(added_mass)
    )
    # contact pulls back along its normal, and friction along the disc's way
    pushes = (given.normals + MU * given.tangentials) * given.stiffnesses
    springs = sp.csr_array(pushes * share_of_contact) @ sp.csr_array(given.normals.T)
    stiffness = given.given_stiffness + springs
    damping = zero if np.isscalar(damping) else sp.csr_array(damping)
    s, x = near, np.random.default_rng(0).standard_normal(given.size) + 0j
    matrix = (mass * s**2 + damping * s + stiffness).astype(complex)
    inverse = sla.splu(matrix.tocsc())
    for _ in range(4):  # towards the mode next to the guess, before the guess moves
        x = inverse.solve(2.0 * s * (mass @ x) + damping @ x)
        x /= np.linalg.norm(x)
    for _ in range(6):
        matrix = (mass * s**2 + damping * s + stiffness).astype(complex)
        y = sla.splu(matrix.tocsc()).solve(2.0 * s * (mass @ x) + damping @ x)
        change = (x.conj() @ x) / (x.conj() @ y)
        s, x = s - change, y / np.linalg.norm(y)
        if abs(change) < 1e-11 * abs(s):
            break
    return s


def assert_same(structure, **own):
    """Compare the modes near the one that grows in the unchanged brake."""
    modes = structure.complex_modes(frequency_max=3000, critical=False)
    told = modes.growth_rate.values + 2j * np.pi * modes.frequency.values
    near = told[np.abs(modes.frequency.values - AT) < 300.0]
    assert near.size >= 2
    for value in near:
        truth = own_value(value * (1.0 + 1e-4j), **own)
        assert abs(value - truth) < 1e-8 * abs(truth)
    return near[near.real.argmax()]


def back():
    """Degrees of freedom and positions of the nodes at the back of the plate, 20 by 3."""
    node, _ = brake().mesh.degree_of_freedom.T
    rows = np.flatnonzero(np.isclose(brake().mesh.nodes[node, 2], 0.015))
    return rows, brake().mesh.nodes[node[rows[::3]]]


def test_the_unchanged_brake_has_the_published_mode():
    value = own_value(100.0 + 2j * np.pi * 2850.0)
    assert value == pytest.approx(98.243300 + 2j * np.pi * AT, rel=1e-8)


SHIM_ON_BACK = {"patch": {"nodes": "BACK", "mass": SHIM, "damping_ratio": RATIO}}


def own_shim(frequency):
    """Mass (n,) and damping (n, n) of the whole shim."""
    rows, places = back()
    mass = np.zeros(brake().size)
    mass[rows] = SHIM / len(places)
    # rigid motions of the shim: three shifts, three turns
    arms = places - places.mean(axis=0)
    rigid = np.vstack(
        [
            np.hstack([np.eye(3), np.cross(np.eye(3), arm).T])
            for arm in 1e2 * arms  # m are small beside 1
        ]
    )
    basis, _ = np.linalg.qr(rigid)
    bends = np.eye(len(rows)) - basis @ basis.T
    block = brake().given_stiffness.toarray()[np.ix_(rows, rows)]
    damping = sp.lil_array((brake().size, brake().size))
    damping[np.ix_(rows, rows)] = RATIO / (np.pi * frequency) * (bends @ block @ bends)
    return mass, sp.csr_array(damping)


@pytest.mark.release
def test_a_shim_adds_its_mass_to_the_back_and_damps_how_it_bends():
    rows, _ = back()
    assert len(rows) == 60
    mass, damping = own_shim(AT)
    shim = read_modification("shim", SHIM_ON_BACK, brake(), AT)
    for part in (0.5, 1.0):
        patched = shim.of(brake(), part * SHIM)
        value = assert_same(patched, added_mass=part * mass, damping=part * damping)
        assert value.real < 95.0


@pytest.mark.release
def test_a_shim_is_quiet_from_where_the_mode_of_the_whole_brake_ceases_to_grow():
    """Modes beyond the band grow in the coordinates that are run: they had put it at 4.4 g."""
    design = Design.of(in_modes(brake().with_common_mu(), None, 4000.0))
    cures, _ = cures_of(design, {"shim": SHIM_ON_BACK})
    (interval,) = linear_intervals(
        lambda amount: cures["shim"].apply(amount).structure,
        [0.0, 0.05 * SHIM, SHIM],
        0.0,
        design.band,
    )
    assert interval.high_open
    mass, damping = own_shim(design.plant.frequencies[design.plant.unstable[0]])
    near = own_value(100.0 + 2j * np.pi * AT)
    for share, grows in ((0.98, True), (1.02, False)):
        part = share * interval.low / SHIM
        for step in (0.5 * part, part):  # the mode moves: it is followed
            near = own_value(near, step * mass, step * damping)
        assert (near.real > 0.0) == grows


@pytest.mark.release
@pytest.mark.parametrize("share", [0.2, 0.11, 0.4])
def test_a_chamfer_takes_the_points_that_the_disc_meets_first(share):
    """The edge is straight: across the mean way of the disc under the lining."""
    x, y, _ = np.array([each.origin.position for each in brake().contacts]).T
    # the disc turns about z by the right hand, towards larger angles
    middle = np.radians(20.0)
    along = y * np.cos(middle) - x * np.sin(middle)
    kept = np.clip(along.argsort().argsort() + 1.0 - 20.0 * share, 0.0, 1.0)
    kept[kept < 1e-9] = 0.0
    content = {"chamfer": {"face": "lining", "share": 0.4}}
    edge = read_modification("edge", content, brake(), AT).of(brake(), share)
    assert edge.preloads == pytest.approx(own_preloads(kept)[kept > 0])
    closed = closed_in_sliding(kept)
    # some points lift off in steady sliding, and their springs are in no mode
    force = edge.complex_modes(n_modes=1, critical=False).normal_force.values
    assert ((force > 0.0) == closed[kept > 0]).all()
    assert_same(edge, share_of_contact=kept * closed)
