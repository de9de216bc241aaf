"""Mass and stiffness of bilinear quadrilaterals in plane strain and of trilinear hexahedra.

Each element is a square or cube that its nodes map into place; both integrals take two Gauss points
along each axis, which are exact for parallelograms (Hughes, The Finite Element Method, 1987, ch.
3). All elements are computed side by side, so that thousands of them take a fraction of a second.
"""

import itertools

import numpy as np
import scipy.sparse as sp

CORNERS = {
    2: np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]),
    3: np.array(
        [(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    ),
}
"""Number of axes → corners of the square or cube, in the order of Abaqus and CalculiX."""


def mass_and_stiffness(
    nodes: np.ndarray,
    elements: np.ndarray,
    *,
    young: float,
    poisson: float,
    density: float,
    depth: float = 1.0,
) -> tuple[sp.csr_array, sp.csr_array]:
    """Return consistent mass and stiffness of a body of one material, any consistent units.

    Args:
        nodes: (nodes, axes) positions of all nodes.
        elements: (elements, 2^axes) numbers of nodes from 0, the corners as in :data:`CORNERS`.
        depth: out of the plane, of two axes.

    Returns:
        Two matrices (nodes · axes, nodes · axes): the axes of one node after another.
    """
    axes = nodes.shape[1]
    corners, places = CORNERS[axes], nodes[elements]
    shear = young / (2.0 * (1.0 + poisson))
    volume = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    shape = len(elements), len(corners), axes
    mass, stiffness = np.zeros((2, *shape, *shape[1:]))
    for point in itertools.product((-(3.0**-0.5), 3.0**-0.5), repeat=axes):
        factors = 0.5 * (1.0 + corners * point)
        shapes = factors.prod(axis=1)
        slopes = 0.5 * corners * shapes[:, None] / factors
        mapping = np.einsum("eai,aj->eij", places, slopes)
        gradients = np.einsum("aj,eji->eai", slopes, np.linalg.inv(mapping))
        weights = depth * np.linalg.det(mapping)
        both = np.einsum("e,eai,ebj->eaibj", weights, gradients, gradients)
        stiffness += volume * both + shear * both.swapaxes(2, 4)
        alike = shear * np.einsum("eaibi->eab", both)
        inertia = density * np.einsum("e,a,b->eab", weights, shapes, shapes)
        for axis in range(axes):
            stiffness[:, :, axis, :, axis] += alike
            mass[:, :, axis, :, axis] += inertia
    places_in_matrix = elements[:, :, None] * axes + np.arange(axes)
    rows = np.broadcast_to(places_in_matrix[..., None, None], mass.shape).ravel()
    columns = np.broadcast_to(places_in_matrix[:, None, None], mass.shape).ravel()
    made = (
        sp.csr_array((each.ravel(), (rows, columns)), shape=(nodes.size, nodes.size))
        for each in (mass, stiffness)
    )
    return next(made), next(made)
