"""Shape functions of facets and integrals with them."""

import numpy as np
import pytest

from squealpipe.structures.meshes.shape_functions import (
    normal_integrals,
    quadrature,
    shape,
    shares,
)

CORNERS = {3: [[0, 0], [1, 0], [0, 1]], 4: [[-1, -1], [1, -1], [1, 1], [-1, 1]]}
PLACES = {
    3: np.array(CORNERS[3], float),
    4: np.array(CORNERS[4], float),
    6: np.array([*CORNERS[3], [0.5, 0], [0.5, 0.5], [0, 0.5]]),
    8: np.array([*CORNERS[4], [0, -1], [1, 0], [0, 1], [-1, 0]], float),
}


@pytest.mark.parametrize("nodes", [3, 4, 6, 8])
def test_each_function_is_1_at_its_own_node(nodes):
    values, _ = shape(nodes, PLACES[nodes])
    np.testing.assert_allclose(values, np.eye(nodes), atol=1e-15)


@pytest.mark.parametrize("nodes", [3, 4, 6, 8])
def test_derivatives_are_those_of_differences(nodes):
    points = np.array([[0.2, 0.3], [0.1, 0.05]])
    _, slopes = shape(nodes, points)
    for axis, step in enumerate(1e-6 * np.eye(2)):
        ahead, behind = shape(nodes, points + step)[0], shape(nodes, points - step)[0]
        np.testing.assert_allclose(
            slopes[..., axis], (ahead - behind) / 2e-6, atol=1e-9
        )


def test_quadrature_of_the_triangle_integrates_monomials():
    points, weights = quadrature(3)
    xi, eta = points.T
    # ∫ ξ²η³ = 2! 3! / 7!
    assert weights @ (xi**2 * eta**3) == pytest.approx(12 / 5040, rel=1e-13)


@pytest.mark.parametrize(
    ("nodes", "expected"),
    [
        (3, [1 / 3] * 3),
        (4, [1 / 4] * 4),
        (6, [0] * 3 + [1 / 3] * 3),
        (8, [-1 / 12] * 4 + [1 / 3] * 4),
    ],
)
def test_shares_of_a_parallelogram_are_those_of_textbooks(nodes, expected):
    flat = PLACES[nodes] @ [[2.0, 0.5, 0.0], [0.3, 1.0, 0.4]]
    area = np.linalg.norm(normal_integrals(flat[None])[0])
    np.testing.assert_allclose(shares(flat[None])[0] / area, expected, atol=1e-14)


def test_shares_of_a_trapezoid_are_integrals_of_its_shape_functions():
    """Corners (0,0), (3,0), (2,1), (1,1): by hand, not a quarter of the area 2 each."""
    corners = np.array([[0, 0, 0], [3, 0, 0], [2, 1, 0], [1, 1, 0]], float)
    # J = (4 − 2 y) / 4 on the unit square, N of the lower corners has the factor 1 − y
    lower, upper = 7 / 12, 5 / 12
    np.testing.assert_allclose(
        shares(corners[None])[0], [lower, lower, upper, upper], rtol=1e-14
    )


def test_moments_of_the_shares_are_those_of_the_face():
    """The bilinear map carries positions, so that Σ share x = ∫ x dA, here by a fine grid."""
    corners = np.array([[0, 0, 0], [3, 0.2, 0], [2.5, 1, 0], [0.5, 1.4, 0]], float)
    middle = (np.arange(400) + 0.5) / 200 - 1
    grid = np.stack(np.meshgrid(middle, middle), axis=-1).reshape(-1, 2)
    values, slopes = shape(4, grid)
    places = values @ corners
    along = np.einsum("nx,pnd->pxd", corners, slopes)
    area = np.linalg.norm(np.cross(along[..., 0], along[..., 1]), axis=1) / 200**2
    np.testing.assert_allclose(
        shares(corners[None])[0] @ corners, area @ places, rtol=1e-5
    )


def test_normal_of_a_warped_facet_is_half_the_product_of_its_diagonals():
    corners = np.array([[0, 0, 0], [1, 0, 0.3], [1.2, 1, 0], [0, 0.9, 0.4]])
    product = 0.5 * np.cross(corners[2] - corners[0], corners[3] - corners[1])
    np.testing.assert_allclose(normal_integrals(corners[None])[0], product, rtol=1e-13)
