"""Boundaries of a large structure, searched in a few modes, against its own eigenvalues."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg as la

from squealpipe.structures import elastic_pad
from squealpipe.structures.assess.assess import _linear_intervals
from squealpipe.structures.assess.cures import cures_of
from squealpipe.structures.assess.designs import Design
from squealpipe.structures.assess.modifications import read_modification

DAMPING = 0.01
WEIGHT = {"added_mass": {90: 0.05}}


def growth(pad, count=60):
    """Largest growth rate in so many modes with all contacts closed, by dense algebra, 1/s."""
    mass, given = pad.mass.toarray(), pad.stiffness.toarray()
    closed = (pad.normals + pad.mu * pad.tangentials) * pad.stiffnesses
    at_rest = given + (pad.normals * pad.stiffnesses) @ pad.normals.T
    squares, modes = la.eigh(at_rest, mass)
    omega, modes = np.sqrt(squares[:count]), modes[:, :count]
    stiffness = modes.T @ (given + closed @ pad.normals.T) @ modes
    damping = np.diag(2.0 * DAMPING * omega)
    first = np.block(
        [[np.zeros((count, count)), np.eye(count)], [-stiffness, -damping]]
    )
    return la.eigvals(first).real.max()


@pytest.mark.release
def test_boundaries_in_twelve_modes_are_those_of_the_whole_within_one_per_cent():
    pad = elastic_pad(elements=(12, 3), modal_damping=DAMPING)
    design = Design.of(pad.reduce(n_modes=12))
    cures, _ = cures_of(design, {"weight": WEIGHT})

    def with_stiffness(factor):
        return pad.with_(
            contacts=[
                replace(each, stiffness=factor * each.stiffness)
                for each in pad.contacts
            ]
        )

    for name, of_whole in (
        ("mu", lambda mu: pad.with_(mu=mu)),
        ("contact_stiffness", with_stiffness),
    ):
        (interval,) = _linear_intervals(cures[name], np.inf)
        signs = [growth(of_whole(interval.high * side)) > 0 for side in (0.99, 1.01)]
        assert signs == [False, True], name
    # the modes of the heavier pad, not those of the pad with the weight on them
    weight = read_modification("weight", WEIGHT, pad, 1.0)
    heavy, light = growth(weight.of(pad, 0.05), 12), growth(pad, 12)
    assert abs(heavy - light) > 0.05 * light
    assert np.isclose(cures["weight"].apply(0.05).margin, heavy, rtol=1e-3)
