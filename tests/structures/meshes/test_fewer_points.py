"""What fewer contact points of a face change, by an own assembly and by the disc brake."""

from dataclasses import replace

import numpy as np
import pytest

from squealpipe import Contact, Face, Rotation, Structure
from squealpipe.schema import Outcome
from squealpipe.structures import disc_brake
from squealpipe.structures.fewer_points import fewer_points
from tests.oracles import mesh_contacts as oracle

MU = 0.6


@pytest.fixture(scope="module")
def small():
    """A brake of a few hexahedra from the package, and its contacts from an own assembly."""
    nodes, hexahedra, faces = oracle.brake(pad_r=(0, 1))
    mass, stiffness = oracle.solid_matrices(nodes, hexahedra)
    # springs to the ground that part the pairs of equal frequencies of a round disc
    stiffness = stiffness + np.diag(np.linspace(1e7, 2e8, len(stiffness)))
    structure = Structure.from_mesh(
        mass,
        stiffness,
        mesh=(nodes, faces),
        contacts={
            "lining": Face("PAD", against="DISC", stiffness_per_area=4e11, pressure=5e5)
        },
        rotation=Rotation(axis=(0, 0, 1), speed=10.0),
        degrees_of_freedom=[(n, d) for n in nodes for d in (1, 2, 3)],
        mu=MU,
    )
    row_of = {(n, d): 3 * i + d - 1 for i, n in enumerate(nodes) for d in (1, 2, 3)}
    contacts = oracle.contacts(
        nodes,
        faces["PAD"],
        faces["DISC"],
        row_of,
        lambda place: np.cross((0, 0, 1), place),
        4e11,
        5e5,
    )
    return structure, (mass, stiffness), contacts


def test_growth_by_points_is_that_of_dense_eigenvalues_of_merged_contacts(small):
    structure, (mass, stiffness), contacts = small
    normals, tangentials, springs, preloads, _ = contacts
    found = fewer_points(structure)
    everything = len(structure.contacts)
    assert found.points.values.tolist() == [1, 2, 3, 4, everything]
    assert (found.outcome == Outcome.converged).all()
    whole = [each.origin.nodes[0] for each in structure.contacts]
    for at in (found.isel(points=i) for i in range(5)):
        groups = [
            [whole.index(node) for node in each.origin.nodes]
            for each in structure.with_points(int(at.points)).contacts
        ]
        assert int(at.contacts) == len(groups)
        share = np.zeros((len(groups), everything))
        for row, group in enumerate(groups):
            share[row, group] = preloads[group] / preloads[group].sum()
        member = share > 0
        values, forces = oracle.modes(
            mass,
            stiffness,
            normals @ share.T,
            tangentials @ share.T,
            member @ springs,
            member @ preloads,
            MU,
        )
        assert (forces > 0).all()
        growing = values[values.real > 1e-3]
        growing = growing[growing.imag > 0]
        assert int(at.unstable_modes) == len(growing)
        if not len(growing):
            assert np.isnan(at.growth_rate)
            assert np.isnan(at.frequency)
            continue
        fastest = growing[growing.real.argmax()]
        assert float(at.growth_rate) == pytest.approx(fastest.real, rel=1e-5)
        assert float(at.frequency) == pytest.approx(
            fastest.imag / (2 * np.pi), rel=1e-6
        )
    assert found.unstable_modes.max() > 0


def test_faces_of_fewer_contacts_stay_and_a_belt_at_rest_is_told(small):
    structure, _, _ = small
    second = [
        replace(each, name=f"other_{number}")
        for number, each in enumerate(structure.contacts[:2], 1)
    ]
    two_faces = structure.with_(contacts=[*structure.contacts, *second])
    found = fewer_points(two_faces)
    assert found.points.values.tolist() == [1, 2, 3, 4, 6]
    assert found.contacts.values.tolist() == [2, 4, 5, 6, 8]
    at_rest = fewer_points(structure.with_(belt_speed=0.0))
    assert (at_rest.outcome == Outcome.no_sliding_state).all()
    assert np.isnan(at_rest.growth_rate).all()


def test_without_faces_and_of_a_reduced_structure_it_is_refused(small):
    block = Structure(
        np.eye(2),
        1e6 * np.eye(2),
        contacts=[Contact("a", {1: 1.0}, {0: 1.0}, 1e6, 1.0)],
    )
    with pytest.raises(ValueError, match="no contact comes from a face of a mesh"):
        fewer_points(block)
    reduced = small[0].reduce(n_modes=12)
    with pytest.raises(ValueError, match="reduced"):
        fewer_points(reduced)


@pytest.mark.release
def test_fewer_points_of_the_disc_brake():
    """Growth rates found by hand with ``points=`` in the brake's file; 24.940579 by CalculiX."""
    found = fewer_points(disc_brake(mu=0.4), frequency_max=4000)
    assert found.points.values.tolist() == [1, 2, 3, 4, 6, 8, 12, 16, 20]
    found = found.sel(points=[1, 2, 4, 8, 16, 20])
    assert found.unstable_modes.values.tolist() == [0, 2, 0, 1, 1, 1]
    assert found.growth_rate.values == pytest.approx(
        [np.nan, 91.6, np.nan, 55.5, 41.7, 24.9], abs=0.05, nan_ok=True
    )
    assert found.frequency.values[-1] == pytest.approx(2851.938816, rel=1e-8)
