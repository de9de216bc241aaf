"""A block of trilinear hexahedra on springs, with contact points on its lower face."""

import numpy as np
import scipy.sparse as sp
from skfem import Basis, BilinearForm, ElementHex1, ElementVector, MeshHex
from skfem.helpers import ddot, dot, eye, sym_grad, trace

from squealpipe import Contact, Structure

YOUNG, POISSON, DENSITY = 2e10, 0.3, 2500.0  # Pa, 1, kg/m³
SIZE = 0.12, 0.05, 0.02  # m
SUPPORT = 3e8, 3e8, 5e8  # of the upper face along x, y and z, N/m


def elastic_block(elements, contacts, mu=0.5, **further):
    """A block as a structure; nodes on the lower face, equally far apart by number, are contacts.

    Args:
        elements: along x (the belt), y and z.
        contacts: how many.
    """
    shear = YOUNG / (2 * (1 + POISSON))
    first = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))

    @BilinearForm
    def elasticity(u, v, _):
        strain = sym_grad(u)
        return ddot(2 * shear * strain + first * eye(trace(strain), 3), sym_grad(v))

    @BilinearForm
    def inertia(u, v, _):
        return DENSITY * dot(u, v)

    lines = [np.linspace(0, a, n + 1) for a, n in zip(SIZE, elements, strict=True)]
    mesh = MeshHex.init_tensor(*lines)
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=3)
    stiffness = sp.csr_array(elasticity.assemble(basis))
    upper, lower = (np.flatnonzero(np.isclose(mesh.p[2], z)) for z in (SIZE[2], 0.0))
    springs = np.zeros(basis.N)
    for ways, total in zip(basis.nodal_dofs, SUPPORT, strict=True):
        springs[ways[upper]] = total / len(upper)
    chosen = lower[np.linspace(0, len(lower) - 1, contacts).astype(int)]
    points = [
        Contact(
            f"p{number}",
            {int(basis.nodal_dofs[2, node]): 1.0},
            {int(basis.nodal_dofs[0, node]): 1.0},
            stiffness=8e8 / contacts,
            preload=800.0 / contacts,
        )
        for number, node in enumerate(chosen, 1)
    ]
    return Structure(
        sp.csr_array(inertia.assemble(basis)),
        stiffness + sp.diags_array(springs),
        contacts=points,
        mu=mu,
        **further,
    )
