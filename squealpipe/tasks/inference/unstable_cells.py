"""Angles at which A3 is unstable, however few of them a grid over the angles would hit.

Whatever can be said of all angles is said in the plane of Z (see :mod:`squealpipe.models.a3`):
flutter fills one disc there, so a search along its rim finds unstable cells.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from squealpipe.codes import LinearRegime
from squealpipe.models import a3
from squealpipe.models.contact_system import contact_system
from squealpipe.models.damped import damped_system, is_undamped, stability
from squealpipe.parameters import Parameters
from squealpipe.schema.inference import DAMPED_GRID
from squealpipe.schema.linear import ALIKE

RIM = 192
"""Points around the disc of flutter."""
INSIDE = 1.0 - 1e-6
"""Their distance from its centre, in radii: unstable, and at the edge where contact lasts."""
DIVERGENT = 24
"""Points along each arc that bounds divergence."""


class Unstable(NamedTuple):
    """Unstable cells: angles, rad, and whether it is by modes that couple."""

    alpha1: np.ndarray
    alpha2: np.ndarray
    couples: np.ndarray


def unstable_cells(params: Parameters, *, inside: float = INSIDE) -> Unstable:
    """Cells along the edge of every region in which A3 is unstable; there may be none.

    Dashpots, and friction that depends on speed, leave no such edge in closed form: there, all
    unstable cells of a grid.
    """
    if not is_undamped(params):
        return _on_grid(params)
    alpha1, alpha2 = _along_edges(params, inside)
    regime = np.asarray(a3.regime(contact_system(params, alpha1, alpha2).invariants))
    return _where(regime, alpha1, alpha2, regime == LinearRegime.flutter)


@lru_cache(maxsize=4)
def _on_grid(params: Parameters) -> Unstable:
    """Several statements ask for the cells of one set, which take a tenth of a second."""
    alpha1, alpha2 = midpoints(DAMPED_GRID)
    linear = stability(damped_system(params, alpha1, alpha2))
    couples = (linear.regime == LinearRegime.flutter) & (
        linear.shape_similarity >= ALIKE
    )
    return _where(linear.regime, alpha1, alpha2, couples)


def _where(
    regime: np.ndarray, alpha1: np.ndarray, alpha2: np.ndarray, couples: np.ndarray
) -> Unstable:
    unstable = regime > LinearRegime.stable
    return Unstable(alpha1[unstable], alpha2[unstable], couples[unstable])


def midpoints(number: int) -> tuple[np.ndarray, np.ndarray]:
    """Angles of the cells of a map with ``number`` of them per axis, rad."""
    axis = (np.arange(number) + 0.5) * (np.pi / number)
    alpha1, alpha2 = np.meshgrid(axis, axis, indexing="ij")
    return alpha1.ravel(), alpha2.ravel()


def springs_are_equal(fields: Mapping[str, np.ndarray | float]) -> bool:
    """Whether (α1, α2) and (π − α2, π − α1) are the same system at every parameter set."""
    return all(
        bool(np.all(np.equal(fields.get(f"{name}1", 0.0), fields.get(f"{name}2", 0.0))))
        for name in ("k", "length", "damping")
    )


def _along_edges(params: Parameters, inside: float) -> tuple[np.ndarray, np.ndarray]:
    """Angles, rad, that are unstable if any are, undamped.

    Flutter is searched at ``RIM`` directions, just inside of its disc in the plane of Z. For
    divergence, outside of a circle that ends at |Z| = k1 + k2, the search goes along the middle
    between the two.
    """
    farthest, nearest = params.k1 + params.k2, abs(params.k1 - params.k2)
    centre, radius = a3.flutter_circle(params, params.k3)
    turn = (np.arange(RIM) + 0.5) * (2.0 * np.pi / RIM)
    flutter = centre + inside * radius * np.exp(1j * turn)
    arcs = a3.circle_arcs(params, *a3.divergence_circle(params, params.k3), DIVERGENT)
    edge = np.concatenate([np.zeros(0, complex), *(arc[1:-1] for arc in arcs)])
    z = np.concatenate([flutter, edge * 0.5 * (1.0 + farthest / np.abs(edge))])
    z = z[(np.abs(z) < farthest) & (np.abs(z) > max(nearest, 1e-9 * farthest))]
    alpha1, alpha2 = a3.angles_from_plane(z, params)
    if springs_are_equal(params.as_dict()):
        # (α1, α2) and (π − α2, π − α1) have the same Z and the same motion.
        alpha1, alpha2 = alpha1[0], alpha2[0]
    return alpha1, alpha2
