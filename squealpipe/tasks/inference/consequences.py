"""Statements of the paper that did not enter the inference, judged at inferred parameters.

Whatever can be said of all angles is said in the plane of Z (see :mod:`squealpipe.models.a3`):
flutter fills one disc there, so a search along its rim finds unstable cells however few of them a
grid over the angles would hit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from squealpipe.codes import LinearRegime
from squealpipe.models import a2, a3
from squealpipe.models.contact_system import contact_system
from squealpipe.models.damped import damped_system, is_undamped, stability
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome
from squealpipe.schema.inference import DAMPED_GRID
from squealpipe.schema.linear import merge
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.tasks.inference.constraints import parameter_sets

HORIZON = 200.0
"""Horizon of the runs, in units of √(m/k1)."""
RIM = 192
"""Points around the disc of flutter."""
INSIDE = 1.0 - 1e-6
"""Their distance from its centre, in radii: unstable, and at the edge where contact lasts."""
DIVERGENT = 24
"""Points along each arc that bounds divergence."""
ANGLES, CLEAR = (12, 24, 48), 0.6
"""Midpoints an axis of the maps of runs: finer while |share − ½| is below ``CLEAR`` spacings."""

CONSEQUENCES: dict[str, str] = {
    "S3": "eigenvalues merge somewhere on the angle map",
    "F6b": "no unstable cell has a positive reaction force",
    "F6b_printed": "no unstable cell fulfils Eq. (11) as printed",
    "F7a": "A1 separates in more than half of the angle map",
    "F7_black": "no unstable cell keeps contact: the black region of Fig. 7 is empty",
    "F8c": "in contact, ω1 is largest on α1 + α2 = nπ/2, n odd",
    "F8c_separated": "separated, ω1 is largest on α1 + α2 = nπ/2, n odd",
}
"""Key (the id in the claims table, where one check settles the statement) → what is checked."""


class Unstable(NamedTuple):
    """Unstable cells: angles, rad, and whether it is by modes that couple."""

    alpha1: np.ndarray
    alpha2: np.ndarray
    couples: np.ndarray


def judge_consequences(
    fields: Mapping[str, np.ndarray], *, tol: float, workers: int | None = None
) -> dict[str, np.ndarray]:
    """Whether each consequence holds at each parameter set.

    Args:
        fields: names of ``Parameters`` → 1-D arrays of one length.
        tol: tolerance of the integrator.
        workers: processes, as in ``run_ensemble``.

    Returns:
        Key of ``CONSEQUENCES`` → booleans of that length.
    """
    sets = parameter_sets(fields)
    if not sets:
        return {key: np.zeros(0, bool) for key in CONSEQUENCES}
    cells = [unstable_cells(params) for params in sets]
    linear = [_linear(params, *where) for params, where in zip(sets, cells, strict=True)]
    found = {key: np.array([verdict[key] for verdict in linear], bool) for key in linear[0]}
    found["F7a"] = separating_share(fields, tol=tol, workers=workers) > 0.5
    found["F7_black"] = ~_some_keep_contact(fields, cells, tol, workers)
    return {key: found[key] for key in CONSEQUENCES}


def unstable_cells(params: Parameters, *, rim: int = RIM, inside: float = INSIDE) -> Unstable:
    """Cells along the edge of every region in which A3 is unstable; there may be none.

    Dashpots, and friction that depends on speed, leave no such edge in closed form: there, all
    unstable cells of a grid.
    """
    alpha1, alpha2 = (
        _along_edges(params, rim, inside) if is_undamped(params) else _midpoints(DAMPED_GRID)
    )
    regime, couples = _regime(params, alpha1, alpha2)
    unstable = regime > LinearRegime.stable
    return Unstable(alpha1[unstable], alpha2[unstable], couples[unstable])


def _midpoints(number: int) -> tuple[np.ndarray, np.ndarray]:
    """Angles of the cells of a map with ``number`` of them per axis, rad."""
    axis = (np.arange(number) + 0.5) * (np.pi / number)
    alpha1, alpha2 = np.meshgrid(axis, axis, indexing="ij")
    return alpha1.ravel(), alpha2.ravel()


def _along_edges(params: Parameters, rim: int, inside: float) -> tuple[np.ndarray, np.ndarray]:
    """Angles, rad, that are unstable if any are, undamped.

    Flutter is searched at ``rim`` directions, just inside of its disc in the plane of Z. For
    divergence, outside of a circle that ends at |Z| = k1 + k2, the search goes along the middle
    between the two.
    """
    farthest, nearest = params.k1 + params.k2, abs(params.k1 - params.k2)
    centre, radius = a3.flutter_circle(params, params.k3)
    turn = (np.arange(rim) + 0.5) * (2.0 * np.pi / rim)
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


def _regime(
    params: Parameters, alpha1: np.ndarray, alpha2: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Regime of A3, damped where the parameters are, and whether it is flutter of merged modes."""
    if is_undamped(params):
        regime = np.asarray(a3.regime(contact_system(params, alpha1, alpha2).invariants))
        return regime, regime == LinearRegime.flutter
    found = stability(damped_system(params, alpha1, alpha2))
    return found.regime, (found.regime == LinearRegime.flutter) & merge(found.frequency)


def _linear(
    params: Parameters, alpha1: np.ndarray, alpha2: np.ndarray, couples: np.ndarray
) -> dict[str, bool]:
    """What is said of linear stability, sliding and frequencies, from the unstable cells."""
    system = contact_system(params, alpha1, alpha2)
    reaction = a2.reaction_force(system.stiffness, params.drag, a2.actuation(params))
    return {
        "S3": bool(couples.any()),
        "F6b": not (reaction > 0).any(),
        "F6b_printed": not a2.possible_as_printed(system.stiffness, params.drag).any(),
        "F8c": first_is_largest_on_lines(params, params.k3),
        "F8c_separated": first_is_largest_on_lines(params, 0.0),
    }


def first_is_largest_on_lines(params: Parameters, k3: float) -> bool:
    """Whether the largest real ω1 lies on α1 + α2 = nπ/2, n odd.

    The trace is the same at all angles, so ω1² grows as |Z − c| falls towards the radius of the
    disc of flutter. Those lines are the inner edge |Z| = |k1 − k2| of all reachable Z.
    """
    centre, radius = a3.flutter_circle(params, k3)
    hole, offset = abs(params.k1 - params.k2), abs(centre)
    on_lines = max(radius, abs(offset - hole))
    anywhere = max(radius, offset - params.k1 - params.k2, hole - offset)
    return bool(on_lines <= anywhere * (1.0 + 1e-12))


def separating_share(
    fields: Mapping[str, np.ndarray],
    *,
    angles: Sequence[int] = ANGLES,
    tol: float,
    workers: int | None = None,
) -> np.ndarray:
    """Share of the angle map on which A1, from rest, loses contact within ``HORIZON``.

    Midpoint rule; a parameter set goes on to the next number of ``angles`` while its share is
    within ``CLEAR``/angles of one half.
    """
    columns = {name: np.asarray(values) for name, values in fields.items()}
    shares = np.full(len(columns["mu"]), 0.5)
    for number in angles:
        open_ = np.flatnonzero(np.abs(shares - 0.5) < CLEAR / number)
        chosen = {name: values[open_, None] for name, values in columns.items()}
        alpha1, alpha2 = _midpoints(number)
        weight = np.ones(alpha1.size)
        if springs_are_equal(columns):
            middle = np.abs(alpha1 + alpha2 - np.pi) < 1e-9
            below = middle | (alpha1 + alpha2 < np.pi)
            weight = np.where(middle, 1.0, 2.0)[below]
            alpha1, alpha2 = alpha1[below], alpha2[below]
        lost = _separates(chosen, alpha1, alpha2, tol, workers)
        shares[open_] = lost @ weight / number**2
    return shares


def springs_are_equal(fields: Mapping[str, np.ndarray | float]) -> bool:
    """Whether (α1, α2) and (π − α2, π − α1) are the same system at every parameter set."""
    return all(
        bool(np.all(np.equal(fields.get(f"{name}1", 0.0), fields.get(f"{name}2", 0.0))))
        for name in ("k", "length", "damping")
    )


def _some_keep_contact(
    fields: Mapping[str, np.ndarray],
    cells: Sequence[tuple[np.ndarray, ...]],
    tol: float,
    workers: int | None,
) -> np.ndarray:
    """Whether A1 keeps contact in some of each parameter set's cells."""
    owner = np.repeat(np.arange(len(cells)), [where[0].size for where in cells])
    alpha1, alpha2 = (np.concatenate([where[i] for where in cells]) for i in (0, 1))
    chosen = {name: np.asarray(values)[owner] for name, values in fields.items()}
    kept = ~_separates(chosen, alpha1, alpha2, tol, workers)
    return np.bincount(owner[kept], minlength=len(cells)) > 0


def _separates(
    fields: Mapping[str, np.ndarray],
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    tol: float,
    workers: int | None,
) -> np.ndarray:
    """Whether A1 loses contact from rest within ``HORIZON``."""
    shape = np.broadcast_shapes(fields["mu"].shape, alpha1.shape)
    if 0 in shape:
        return np.zeros(shape, bool)
    run = run_ensemble(
        fields,
        alpha1,
        alpha2,
        t_end=HORIZON * np.sqrt(fields["mass"] / fields["k1"]),
        stop_at_first_separation=True,
        tol=tol,
        workers=workers,
    )
    return np.asarray(run.outcome == Outcome.separated)
