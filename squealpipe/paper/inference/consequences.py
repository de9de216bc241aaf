"""Statements on the linear models that do not enter the inference, judged at parameter sets."""

import numpy as np

from squealpipe.brake.models import a2, a3
from squealpipe.brake.models.contact_system import contact_system
from squealpipe.paper.inference.candidates import Candidates
from squealpipe.paper.inference.unstable_cells import Unstable
from squealpipe.parameters import Parameters

CONSEQUENCES: dict[str, str] = {
    "S3": "a cell flutters in which both modes have nearly one shape",
    "F6b": "no unstable cell has a positive reaction force",
    "F8c": "in contact, ω1 is largest on α1 + α2 = nπ/2, n odd",
    "F8c_separated": "separated, ω1 is largest on α1 + α2 = nπ/2, n odd",
}
"""Key (the id in the claims table, where one check settles the statement) → what is checked."""


def judge_consequences(candidates: Candidates) -> dict[str, np.ndarray]:
    """Return whether each consequence holds at each parameter set: key → booleans."""
    cells = candidates.unstable_cells()
    first = np.searchsorted(cells.owner, np.arange(candidates.size + 1))
    verdicts = [
        _linear(params, Unstable(*(column[begin:end] for column in cells)))
        for params, begin, end in zip(
            candidates.sets, first[:-1], first[1:], strict=True
        )
    ]
    return {
        key: np.array([verdict[key] for verdict in verdicts], bool)
        for key in CONSEQUENCES
    }


def _linear(params: Parameters, cells: Unstable) -> dict[str, bool]:
    system = contact_system(params, cells.alpha1, cells.alpha2)
    reaction = a2.reaction_force(system.stiffness, params.drag, a2.actuation(params))
    return {
        "S3": bool(cells.couples.any()),
        "F6b": not (reaction > 0).any(),
        "F8c": first_is_largest_on_lines(params, params.k3),
        "F8c_separated": first_is_largest_on_lines(params, 0.0),
    }


def first_is_largest_on_lines(params: Parameters, k3: float) -> bool:
    """Return whether the largest real ω1 lies on α1 + α2 = nπ/2, n odd.

    The trace is the same at all angles, so ω1² grows as |Z − c| falls towards the radius of the
    disc of flutter. Those lines are the inner edge |Z| = |k1 − k2| of all reachable Z.
    """
    centre, radius = a3.flutter_circle(params, k3)
    hole, offset = abs(params.k1 - params.k2), abs(centre)
    on_lines = max(radius, abs(offset - hole))
    anywhere = max(radius, offset - params.k1 - params.k2, hole - offset)
    return bool(on_lines <= anywhere * (1.0 + 1e-12))
