"""Arrays that compiled code reads of one set of matrices, and where it works, by one address.

A plan is a record of addresses and sizes; its own address stands bit for bit in the first parameter
of each run, so that functions that are called with the address of a run's parameters find it.
Columns of matrices that products run along, and of the work, are padded with zeros to whole rows of
vectors, which are aligned.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from squealpipe.systems.compiled import inline_views, views
from squealpipe.systems.linear.matrices import ContactMatrices
from squealpipe.systems.linear.numbering import OF_CONTACT, Numbering
from squealpipe.systems.taylor.lanes import (
    MOST_TERMS,
    Workspace,
    aligned,
    record_viewer,
    view,
)
from squealpipe.systems.taylor.memory import table_viewer
from squealpipe.systems.taylor.simd import LANES


class ParameterRows(NamedTuple):
    """Rows of the parameters of a run.

    Attributes:
        plan: address of the plan.
        belt, preload: belt speed, and the factor of all preloads.
        coefficients: first of the numbers of the contacts, behind which the unit of time is last.
    """

    plan: int = 0
    belt: int = 1
    preload: int = 2
    coefficients: int = 3


parameter_row = ParameterRows()

WORK = 13
"""Rows of work by contact."""


class ModeRows(NamedTuple):
    """Rows of the work by displacement.

    Attributes:
        base: accelerations without stick.
        scale, rate: sizes of terms.
        place, speed: an order of the states.
    """

    base: int = 0
    scale: int = 1
    rate: int = 2
    place: int = 3
    speed: int = 4


mode_row = ModeRows()

SPECIAL = 4
"""Place among the counts of whether something happens in the last step."""
# by array: type of its elements, and its shape by sizes; of the last four addresses are taken alone
ARRAYS: dict[str, tuple[Any, ...]] = {
    "pull_back": ("f8", "stiffness_rows", "modes"),
    "drag_back": ("f8", "damping_rows", "modes"),
    "load": ("f8", "n"),
    "normals": ("f8", "n", "contacts"),
    "tangentials": ("f8", "n", "contacts"),
    "push_rows": ("f8", "c", "modes"),
    "drag_rows": ("f8", "c", "modes"),
    "tangent_rows": ("f8", "c", "n"),
    "mobility": ("f8", "c", "c"),
    "springs": ("f8", "contacts"),
    "preloads": ("f8", "contacts"),
    "speeds": ("f8", "contacts"),
    "laws": ("i8", "c"),
    "shapes": ("f8", "n_shapes", "n"),
    "table": ("f8", "n_regimes", "width"),
    "first": ("i8", 2, "c+1"),
    "switches": ("i8", "n_switches", 3),
    "by_contact": ("f8", WORK, "contacts"),
    "by_mode": ("f8", 5, "modes"),
    "law_series": ("f8", 4, MOST_TERMS, "c"),
    "held": ("f8", "c", "c"),
    "factor": ("f8", 3, "c", "c"),
    "stuck": ("i8", "c"),
    "counts": ("i8", 5),
    "lists": ("i8", 2, "c"),
    "hidden": ("f8", 1),
    "press_counts": ("i8", "c"),
    "with_tables": ("i8", "n_tables"),
    "sliders": ("i8", "c"),
    "with_sliders": ("i8", "n_sliders"),
    "tangential_springs": ("f8", "c"),
    "normal_rows": ("f8", "c", "n"),
    "starts": (),
    "numbers": (),
    "opened": (),
    "scratch": (),
}
"""Arrays of a plan; see :class:`.matrices.ContactMatrices`.

- pull_back, drag_back: −M⁻¹(K + …)ᵀ and −M⁻¹Cᵀ, or their diagonals, in rows of ``modes``
- table: (regimes, constants), contact after contact
- first: the first regime of each contact, and its first kind of event
- switches: what, contact, target
- by_contact, by_mode: work
- law_series: orders of the coefficient of friction and of what it is made of
- held: (T_SᵀM⁻¹T_S)⁺ of the contacts S that stick, in its first rows and columns
- stuck: these contacts
- counts: how many they are; how many of their directions follow from the others; numbers of
  contacts in the lists; whether something happens in the last step
- lists: contacts that push by what the stiffness does not hold, and those that slip
- press_counts: number of pieces of each contact's table of contact, or 1
- with_tables, with_sliders: contacts whose force is a table, and that have a tangential spring
- sliders: place of the stretch of each contact's tangential spring; −1 without one
"""
SIZES = (
    "n", "c", "width", "n_sorts", "n_tables", "n_shapes", "n_regimes", "n_switches", "n_states",
    "full_stiffness", "full_damping", "balanced", "curved", "n_jobs", "n_sliders",
    "stiffness_rows", "damping_rows", "modes", "contacts", "settle", "forces",
)  # fmt: skip
PLAN_TABLE = np.dtype([(name, "i8") for name in (*ARRAYS, *SIZES)])
"""Addresses and sizes: ``n_sorts`` surfaces a contact, ``n_states`` displacements, velocities and
stretches, ``modes`` and ``contacts`` with what they are padded by; ``settle`` and ``forces`` of
functions that compiled code calls."""
record_at: Any = record_viewer(PLAN_TABLE)
plan_at: Any = table_viewer("plan", PLAN_TABLE, ARRAYS)


@views
def n_parameters(k: Any) -> int:
    """Return the number of parameters, which the constants of the regimes follow."""
    return int(parameter_row.coefficients + OF_CONTACT * k.c + 1)


@inline_views
def plan_of(parameters: int) -> Any:
    """Return the plan of a lane, by the address of its parameters."""
    return plan_at(view(parameters, (1,), np.int64)[0])


@views
def numbers_of(k: Any, parameters: int) -> Any:
    """Return the parameters and constants of a lane, in the first column."""
    rows = n_parameters(k) + k.c * k.width
    return view(parameters, (rows, LANES), np.float64)


def _padded(matrix: np.ndarray) -> np.ndarray:
    """Return an aligned matrix, or one row, whose columns are padded with zeros."""
    given = np.atleast_2d(matrix)
    rows, columns = given.shape
    padded = aligned(rows * -(-columns // LANES), LANES).reshape(rows, -1)
    padded[:, :columns] = given
    return padded


def plan(
    matrices: ContactMatrices,
    numbering: Numbering,
    called: Mapping[str, int],
    starts: np.ndarray | None = None,
    numbers: np.ndarray | None = None,
) -> Workspace:
    """Return the plan of some matrices; it keeps its arrays.

    Args:
        called: addresses of :func:`.loop.functions`.
        starts: (runs, parameters and states) from which to look for first regimes.
        numbers: (runs, contacts) for these, −1 where they are to be found.
    """
    n, c = matrices.n_modes, matrices.n_contacts
    places = np.full(c, -1)
    places[matrices.sliders] = 2 * n + np.arange(len(matrices.sliders))
    switches = [(each.what, each.contact, each.target) for each in numbering.switches]
    arrays = {
        name: np.ascontiguousarray(getattr(matrices, name), float)
        for name in ("load", "mobility", "tangential_springs")
    }
    arrays |= {
        name: _padded(getattr(matrices, name))
        for name in ("springs", "preloads", "speeds")
    }
    arrays |= {
        "pull_back": _padded(-matrices.stiffness.T),
        "drag_back": _padded(-matrices.damping.T),
        "normals": _padded(matrices.normals),
        "tangentials": _padded(matrices.tangentials),
        "push_rows": _padded(matrices.pushes.T),
        "drag_rows": _padded(matrices.drags.T),
        "tangent_rows": np.ascontiguousarray(matrices.tangentials.T),
        "normal_rows": np.ascontiguousarray(matrices.normals.T),
        "laws": np.ascontiguousarray(matrices.laws, np.int64),
        "shapes": np.ascontiguousarray(matrices.shapes, float),
        "table": numbering.constants_of_regimes,
        "first": np.array([numbering.first_regime, numbering.first_kind], np.int64),
        "switches": np.array(switches, np.int64),
        "by_contact": _padded(np.zeros((WORK, c))),
        "by_mode": _padded(np.zeros((5, n))),
        "law_series": np.zeros((4, MOST_TERMS, c) if matrices.curved else 1),
        "held": np.zeros((c, c)),
        "factor": np.zeros((3, c, c)),
        "stuck": np.zeros(c, np.int64),
        "counts": np.array([-1, 0, 0, 0, 0], np.int64),
        "lists": np.zeros((2, c), np.int64),
        "hidden": np.array([matrices.hidden]),
        "opened": np.zeros(c, np.int64),
        "press_counts": np.array([len(rows) for rows in matrices.presses], np.int64),
        "with_tables": matrices.with_tables,
        "sliders": places,
        "with_sliders": matrices.sliders,
        "scratch": np.zeros((len(numbering.parameters) + c * numbering.width, LANES)),
        "starts": np.zeros(1) if starts is None else np.ascontiguousarray(starts),
        "numbers": np.zeros(1, np.int64) if numbers is None else numbers,
    }
    sizes = {
        "n": n,
        "c": c,
        "width": numbering.width,
        "n_sorts": numbering.surfaces_of_a_contact,
        "n_tables": len(matrices.with_tables),
        "n_sliders": len(matrices.sliders),
        "n_shapes": len(matrices.shapes),
        "n_regimes": len(numbering.component_of),
        "n_switches": len(switches),
        "n_states": 2 * n + len(matrices.sliders),
        "full_stiffness": int(matrices.stiffness.ndim == 2),
        "full_damping": int(matrices.damping.ndim == 2),
        "balanced": int(matrices.balanced),
        "curved": int(matrices.curved),
        "n_jobs": 0 if starts is None else len(starts),
        "stiffness_rows": len(arrays["pull_back"]),
        "damping_rows": len(arrays["drag_back"]),
        "modes": arrays["by_mode"].shape[1],
        "contacts": arrays["by_contact"].shape[1],
        "settle": called["settle"],
        "forces": called["forces"],
    }
    # a view of nothing has no address
    arrays = {
        name: each if each.size else np.zeros(1, each.dtype)
        for name, each in arrays.items()
    }
    return Workspace(PLAN_TABLE, arrays, sizes)
