"""Angles at which A3 is unstable, however few of them a grid over the angles would hit.

Whatever can be said of all angles is said in the plane of Z
(see :mod:`squealpipe.brake.models.a3`):
flutter fills one disc there, so a search along its rim finds unstable cells.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from squealpipe.brake.models import a3
from squealpipe.brake.models.contact_system import contact_system
from squealpipe.brake.models.damped import damped_system, is_undamped, unclear_stability
from squealpipe.codes import LinearRegime
from squealpipe.laws.springs import springs_alike
from squealpipe.paper.schema.inference import DAMPED_GRID, WordsInNumbers
from squealpipe.parameters import Parameters

INSIDE = 1.0 - 1e-6
"""Their distance from its centre, in radii: unstable, and at the edge where contact lasts."""
LINEAR_PARAMETERS = ("mass", "k1", "k2", "k3")


class Unstable(NamedTuple):
    """Unstable cells of some parameter sets, set after set.

    Attributes:
        owner: number of the set that each is of.
        alpha1, alpha2: rad.
        couples: whether a cell is unstable by modes that couple.
    """

    owner: np.ndarray
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
    # the linear model does not read these, but a mirror image has to share them
    shared = ("length1", "length2", "damping1", "damping2")
    fields = {
        name: np.array([getattr(params, name)])
        for name in (*LINEAR_PARAMETERS, *shared, "drag")
    }
    return unstable_along_edges(fields, inside=inside)


def joined(cells: Sequence[Unstable]) -> Unstable:
    """Return the cells of several sets, each given with those of one, as those of all."""
    owner = np.repeat(np.arange(len(cells)), [each.owner.size for each in cells])
    columns = zip(*cells, strict=True)
    next(columns)
    return Unstable(owner, *(np.concatenate(each) for each in columns))


def unstable_along_edges(
    fields: Mapping[str, np.ndarray], *, inside: float, every: int = 1
) -> Unstable:
    """Find unstable cells of many sets without dashpots, whose friction does not depend on speed.

    Args:
        fields: parameters by name, and ``drag``, (sets,).
        every: look at one in so many points along each edge.
    """
    cells: list[Unstable] = []
    # sets whose cells are looked for at once: half a megabyte an array
    at_once = 256
    for first in range(0, max(1, len(fields["mass"])), at_once):
        rows = slice(first, first + at_once)
        p = SimpleNamespace(
            **{name: fields[name][rows, None] for name in LINEAR_PARAMETERS}
        )
        p.drag = np.asarray(fields["drag"])[rows, None]
        mirrored = springs_alike({n: v[rows] for n, v in fields.items()})
        alpha1, alpha2, there = _along_edges(p, mirrored, inside, every)
        regime = np.asarray(a3.regime(contact_system(p, alpha1, alpha2).invariants))
        at = np.nonzero(there & (regime > LinearRegime.stable))
        couples = regime[at] == LinearRegime.flutter
        cells.append(Unstable(at[0] + first, alpha1[at], alpha2[at], couples))
    return Unstable(*(np.concatenate(each) for each in zip(*cells, strict=True)))


@lru_cache(maxsize=4)
def _on_grid(params: Parameters) -> Unstable:
    """Several statements ask for the cells of one set, which take a tenth of a second."""
    alpha1, alpha2 = midpoints(DAMPED_GRID)
    cells, twins = mirror_images(DAMPED_GRID, bool(springs_alike(params.as_dict())))
    unclear, linear = unclear_stability(
        damped_system(params, alpha1[cells], alpha2[cells])
    )
    couples = (linear.regime == LinearRegime.flutter) & (
        linear.shape_similarity >= WordsInNumbers.alike
    )
    kind = np.zeros((alpha1.size, 2), np.int8)
    cells = cells[unclear]
    kind[cells] = kind[twins[cells]] = np.stack([linear.regime, couples], axis=-1)
    at = np.flatnonzero(kind[:, 0] > LinearRegime.stable)
    return Unstable(
        np.zeros(at.size, int), alpha1[at], alpha2[at], kind[at, 1].astype(bool)
    )


def midpoints(number: int) -> tuple[np.ndarray, np.ndarray]:
    """Angles of the cells of a map with ``number`` of them per axis, rad."""
    axis = (np.arange(number) + 0.5) * (np.pi / number)
    alpha1, alpha2 = np.meshgrid(axis, axis, indexing="ij")
    return alpha1.ravel(), alpha2.ravel()


def mirror_images(number: int, mirrored: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return one of each two midpoints that have the same motion, and the twin of each midpoint.

    Args:
        mirrored: whether (α1, α2) and (π − α2, π − α1) have; else none but itself has.
    """
    cells = np.arange(number**2)
    if not mirrored:
        return cells, cells
    first, second = np.divmod(cells, number)
    return cells[first + second < number], cells[::-1].reshape(number, -1).T.ravel()


def _along_edges(
    p: Any, mirrored: np.ndarray, inside: float, every: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return angles, rad, among which some are unstable if any are, and which of them exist.

    Without damping, flutter is sought in 192 directions, just inside its disc in the plane of
    Z. Divergence, which lies outside a circle and within |Z| = k1 + k2, is sought midway between.

    Args:
        p: parameters, each (sets, 1).
        mirrored: whether (α1, α2) and (π − α2, π − α1), which have the same Z, also have the same
            motion, (sets,).
        every: take one in so many of these points.
    """
    farthest, nearest = p.k1 + p.k2, np.abs(p.k1 - p.k2)
    centre, radius = a3.flutter_circle(p, p.k3)
    # points around the disc of flutter
    points_on_the_rim = 192
    number = np.arange(0, points_on_the_rim, every)
    turn = (number + 0.5) * (2.0 * np.pi / points_on_the_rim)
    flutter = centre + inside * radius * np.exp(1j * turn)
    # points along each arc that bounds divergence
    arcs = a3.reached_arcs(p, *a3.divergence_circle(p, p.k3), 24)
    edge = np.concatenate([arc[:, 1:-1:every] for arc in arcs], axis=1)
    z = np.concatenate([flutter, edge * 0.5 * (1.0 + farthest / np.abs(edge))], axis=1)
    with np.errstate(invalid="ignore"):  # NaN where the circle is not reached
        there = (np.abs(z) < farthest) & (
            np.abs(z) > np.maximum(nearest, 1e-9 * farthest)
        )
    both = not mirrored.all()
    alpha1, alpha2 = a3.angles_from_plane(np.where(there, z, farthest), p, both=both)
    known = np.stack([there, there & ~mirrored[:, None]][: len(alpha1)])
    first, second, exists = (
        np.concatenate(list(each), axis=1) for each in (alpha1, alpha2, known)
    )
    return first, second, exists
