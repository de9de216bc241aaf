"""Shape functions of facets, and integrals over facets with them.

Facets have 3 or 4 nodes (linear, bilinear) or 6 or 8 (quadratic); corners come first, then the
middles of the edges. Triangles have area coordinates ξ, η ≥ 0 with ξ + η ≤ 1, quadrilaterals ξ, η
in −1…1.
"""

from functools import cache

import numpy as np


def is_triangle(nodes: int) -> bool:
    """Tell whether facets of so many nodes are triangles."""
    return nodes in (3, 6)


def shape(nodes: int, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return shape functions and their derivatives at points.

    Args:
        nodes: of the facet: 3, 4, 6 or 8.
        points: (…, 2), ξ and η.

    Returns:
        values (…, nodes) and derivatives (…, nodes, 2).
    """
    xi, eta = points[..., 0], points[..., 1]
    if nodes in (3, 6):
        area = np.stack([1.0 - xi - eta, xi, eta], axis=-1)
        slope = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
        if nodes == 3:
            return area, np.broadcast_to(slope, (*xi.shape, 3, 2)).copy()
        following = area[..., [1, 2, 0]]
        values = np.concatenate(
            [area * (2.0 * area - 1.0), 4.0 * area * following], axis=-1
        )
        corners = (4.0 * area - 1.0)[..., None] * slope
        middles = 4.0 * (
            slope * following[..., None] + area[..., None] * slope[[1, 2, 0]]
        )
        return values, np.concatenate([corners, middles], axis=-2)
    # corners of a quadrilateral
    sx, sy = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]).T
    along, across = 1.0 + xi[..., None] * sx, 1.0 + eta[..., None] * sy
    values = 0.25 * along * across
    slopes = np.stack([0.25 * sx * across, 0.25 * sy * along], axis=-1)
    if nodes == 4:
        return values, slopes
    # serendipity: the middles of the edges, which corners give up half of each
    left, right, below, above = 1.0 - xi, 1.0 + xi, 1.0 - eta, 1.0 + eta
    over_xi, over_eta = 0.5 * (1.0 - xi**2), 0.5 * (1.0 - eta**2)
    middles = np.stack(
        [over_xi * below, right * over_eta, over_xi * above, left * over_eta], axis=-1
    )
    by_xi = np.stack([-xi * below, over_eta, -xi * above, -over_eta], axis=-1)
    by_eta = np.stack([-over_xi, -right * eta, over_xi, -left * eta], axis=-1)
    of_middles = np.stack([by_xi, by_eta], axis=-1)
    before = [3, 0, 1, 2]
    values = values - 0.5 * (middles + middles[..., before])
    slopes = slopes - 0.5 * (of_middles + of_middles[..., before, :])
    return (
        np.concatenate([values, middles], axis=-1),
        np.concatenate([slopes, of_middles], axis=-2),
    )


@cache
def quadrature(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points (q, 2) and weights (q,) that integrate over the reference facet.

    Flat facets are exact with three points a direction; curved and warped ones, whose area element
    is the root of a polynomial, are converged to round-off of usual facets with eight.
    """
    places, weights = np.polynomial.legendre.leggauss(8)
    xi, eta = (each.ravel() for each in np.meshgrid(places, places, indexing="ij"))
    weight = np.outer(weights, weights).ravel()
    if not is_triangle(nodes):
        return np.column_stack([xi, eta]), weight
    # Duffy: the square collapsed onto the triangle
    u, v = 0.5 * (1.0 + xi), 0.5 * (1.0 + eta)
    return np.column_stack([u, v * (1.0 - u)]), 0.25 * weight * (1.0 - u)


def tangents(positions: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return ∂x/∂ξ and ∂x/∂η of facets at points, (facets, points, 3, 2).

    Args:
        positions: of the nodes, (facets, nodes, 3).
        points: (points, 2), the same of all facets.
    """
    _, slopes = shape(positions.shape[1], points)
    return np.asarray(np.einsum("fnx,pnd->fpxd", positions, slopes))


def shares(positions: np.ndarray) -> np.ndarray:
    """Return ∫ N dA of each node of facets, (facets, nodes).

    Args:
        positions: of the nodes, (facets, nodes, 3).
    """
    nodes = positions.shape[1]
    points, weights = quadrature(nodes)
    along = tangents(positions, points)
    area = np.linalg.norm(np.cross(along[..., 0], along[..., 1]), axis=-1)
    values, _ = shape(nodes, points)
    return np.asarray((area * weights) @ values)


def normal_integrals(positions: np.ndarray) -> np.ndarray:
    """Return ∫ n dA of facets, (facets, 3); its direction is their mean normal.

    Args:
        positions: of the nodes, (facets, nodes, 3).
    """
    points, weights = quadrature(positions.shape[1])
    along = tangents(positions, points)
    normals = np.cross(along[..., 0], along[..., 1])
    return np.asarray(np.einsum("fpx,p->fx", normals, weights))


def sizes(positions: np.ndarray) -> np.ndarray:
    """Return the longest edge of facets, (facets,).

    Args:
        positions: of the nodes, (facets, nodes, 3).
    """
    corners = positions[:, : 3 if is_triangle(positions.shape[1]) else 4]
    edges = corners - np.roll(corners, -1, axis=1)
    return np.asarray(np.linalg.norm(edges, axis=-1).max(axis=1))
