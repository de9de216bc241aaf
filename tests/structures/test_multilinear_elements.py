"""Mass and stiffness of distorted elements, against scikit-fem and motions of a rigid body."""

import numpy as np
import pytest
from skfem import (
    Basis,
    BilinearForm,
    ElementHex1,
    ElementQuad1,
    ElementVector,
    MeshHex,
    MeshQuad,
)
from skfem.helpers import ddot, dot, eye, sym_grad, trace

from squealpipe.structures.multilinear_elements import mass_and_stiffness

MATERIAL = {"young": 3.0, "poisson": 0.3, "density": 2.0}


@BilinearForm
def elasticity(u, v, _):
    shear = MATERIAL["young"] / 2.6
    first = MATERIAL["young"] * 0.3 / (1.3 * 0.4)
    strain = sym_grad(u)
    stress = 2.0 * shear * strain + first * eye(trace(strain), len(strain))
    return ddot(stress, sym_grad(v))


@BilinearForm
def inertia(u, v, _):
    return MATERIAL["density"] * dot(u, v)


def distorted(mesh):
    moved = mesh.p + 0.08 * np.random.default_rng(1).uniform(-1.0, 1.0, mesh.p.shape)
    return type(mesh)(moved, mesh.t)


LINES = [np.linspace(0.0, 1.0, n) for n in (4, 3, 3)]


@pytest.mark.parametrize(
    ("mesh", "element", "order"),
    [
        (MeshQuad.init_tensor(*LINES[:2]), ElementQuad1, [0, 3, 2, 1]),
        (MeshHex.init_tensor(*LINES), ElementHex1, [3, 5, 7, 6, 0, 1, 4, 2]),
    ],
)
def test_matrices_of_distorted_elements_are_those_of_another_assembler(
    mesh, element, order
):
    # scikit-fem counts corners in an order of its own, and its meshes are mirrored
    mesh = distorted(mesh)
    nodes, elements = mesh.p.T, mesh.t.T[:, order]
    mass, stiffness = mass_and_stiffness(nodes, elements, **MATERIAL)
    basis = Basis(mesh, ElementVector(element()), intorder=3)
    for ours, form in ((mass, inertia), (stiffness, elasticity)):
        other = form.assemble(basis).toarray()
        # rounding of sums of some dozen products
        np.testing.assert_allclose(
            ours.toarray(), other, atol=1e-14 * np.abs(other).max()
        )
    turned = np.zeros(nodes.shape)
    turned[:, 0], turned[:, 1] = -nodes[:, 1], nodes[:, 0]
    assert np.abs(stiffness @ turned.ravel()).max() < 1e-13
    along = np.zeros(nodes.shape)
    along[:, 0] = 1.0
    total = MATERIAL["density"] * basis.dx.sum()
    assert along.ravel() @ mass @ along.ravel() == pytest.approx(total, rel=1e-13)
