"""Arrays that compiled code reads of one set of matrices, and where it works, by one address.

A plan is a record of addresses and sizes; its own address stands bit for bit in the first parameter
of each run, so that functions that are called with the address of a run's parameters find it.
Columns of matrices that products run along, and of the work, are padded with zeros to whole rows of
vectors, which are aligned.
"""

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
ARRAYS = (
    "pull_back", "drag_back", "load", "normals", "tangentials", "push_rows", "drag_rows",
    "tangent_rows", "mobility", "springs", "preloads", "speeds", "laws", "shapes", "table",
    "first", "switches", "by_contact", "by_mode", "law_series", "held", "factor", "stuck", "counts",
    "lists", "hidden", "starts", "numbers", "opened", "scratch", "press_counts", "with_tables",
    "sliders", "with_sliders", "tangential_springs", "normal_rows",
)  # fmt: skip
SIZES = (
    "n", "c", "width", "n_sorts", "n_tables", "n_shapes", "n_regimes", "n_switches",
    "full_stiffness", "full_damping", "balanced", "curved", "n_jobs", "settle", "n_sliders",
)  # fmt: skip
PLAN_TABLE = np.dtype([(name, "i8") for name in (*ARRAYS, *SIZES)])
record_at: Any = record_viewer(PLAN_TABLE)


class Plan(NamedTuple):
    """Arrays of a plan and its sizes; see :class:`.matrices.ContactMatrices`.

    Attributes:
        pull_back, drag_back: −M⁻¹(K + …)ᵀ and −M⁻¹Cᵀ, (n, n), or the diagonals (1, n).
        push_rows, drag_rows, tangent_rows: (c, n).
        n_sorts: number of surfaces of a contact.
        n_tables: number of contacts whose force is a table.
        table: (regimes, constants), contact after contact.
        first: (2, c + 1) the first regime of each contact, and its first kind of event.
        switches: (switches, 3) what, contact, target.
        by_contact, by_mode: work, (WORK, c) and (5, n).
        law_series: (4, terms, c) orders of the coefficient of friction and of what it is made of.
        held: (c, c) (T_SᵀM⁻¹T_S)⁺ of the contacts S that stick, in its first rows and columns.
        stuck: (c,) these contacts.
        counts: how many they are; how many of their directions follow from the others; numbers of
            contacts in the lists; whether something happens in the last step.
        lists: (2, c) contacts that push by what the stiffness does not hold, and those that slip.
        press_counts: (c,) number of pieces of each contact's table of contact, or 1.
        with_tables: (n_tables,) contacts whose force is a table.
        n_states: number of displacements, velocities and stretches.
        sliders: (c,) place of the stretch of each contact's tangential spring; −1 without one.
        with_sliders: (n_sliders,) contacts that have one.
        normal_rows: (c, n).
    """

    n: Any
    c: Any
    width: Any
    n_sorts: Any
    n_tables: Any
    n_sliders: Any
    n_states: Any
    n_shapes: Any
    n_regimes: Any
    full_stiffness: Any
    full_damping: Any
    balanced: Any
    curved: Any
    pull_back: Any
    drag_back: Any
    load: Any
    normals: Any
    tangentials: Any
    push_rows: Any
    drag_rows: Any
    tangent_rows: Any
    mobility: Any
    springs: Any
    preloads: Any
    speeds: Any
    laws: Any
    shapes: Any
    table: Any
    first: Any
    switches: Any
    by_contact: Any
    by_mode: Any
    law_series: Any
    held: Any
    factor: Any
    stuck: Any
    counts: Any
    lists: Any
    hidden: Any
    press_counts: Any
    with_tables: Any
    sliders: Any
    with_sliders: Any
    tangential_springs: Any
    normal_rows: Any


@inline_views
def plan_at(address: int) -> Any:
    """Return the plan at an address."""
    t = record_at(address)
    n, c = t.n, t.c
    stiffness, damping = n if t.full_stiffness else 1, n if t.full_damping else 1
    of_modes, of_contacts = -(-n // LANES) * LANES, -(-c // LANES) * LANES
    return Plan(
        n=n,
        c=c,
        width=t.width,
        n_sorts=t.n_sorts,
        n_tables=t.n_tables,
        n_sliders=t.n_sliders,
        n_states=2 * n + t.n_sliders,
        n_shapes=t.n_shapes,
        n_regimes=t.n_regimes,
        full_stiffness=t.full_stiffness,
        full_damping=t.full_damping,
        balanced=t.balanced,
        curved=t.curved,
        pull_back=view(t.pull_back, (stiffness, of_modes), np.float64),
        drag_back=view(t.drag_back, (damping, of_modes), np.float64),
        load=view(t.load, (n,), np.float64),
        normals=view(t.normals, (n, of_contacts), np.float64),
        tangentials=view(t.tangentials, (n, of_contacts), np.float64),
        push_rows=view(t.push_rows, (c, of_modes), np.float64),
        drag_rows=view(t.drag_rows, (c, of_modes), np.float64),
        tangent_rows=view(t.tangent_rows, (c, n), np.float64),
        mobility=view(t.mobility, (c, c), np.float64),
        springs=view(t.springs, (of_contacts,), np.float64),
        preloads=view(t.preloads, (of_contacts,), np.float64),
        speeds=view(t.speeds, (of_contacts,), np.float64),
        laws=view(t.laws, (c,), np.int64),
        shapes=view(t.shapes, (t.n_shapes, n), np.float64),
        table=view(t.table, (t.n_regimes, t.width), np.float64),
        first=view(t.first, (2, c + 1), np.int64),
        switches=view(t.switches, (t.n_switches, 3), np.int64),
        by_contact=view(t.by_contact, (WORK, of_contacts), np.float64),
        by_mode=view(t.by_mode, (5, of_modes), np.float64),
        law_series=view(t.law_series, (4, MOST_TERMS, c), np.float64),
        held=view(t.held, (c, c), np.float64),
        factor=view(t.factor, (3, c, c), np.float64),
        stuck=view(t.stuck, (c,), np.int64),
        counts=view(t.counts, (5,), np.int64),
        lists=view(t.lists, (2, c), np.int64),
        hidden=view(t.hidden, (1,), np.float64),
        press_counts=view(t.press_counts, (c,), np.int64),
        with_tables=view(t.with_tables, (t.n_tables,), np.int64),
        sliders=view(t.sliders, (c,), np.int64),
        with_sliders=view(t.with_sliders, (t.n_sliders,), np.int64),
        tangential_springs=view(t.tangential_springs, (c,), np.float64),
        normal_rows=view(t.normal_rows, (c, n), np.float64),
    )


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
    starts: np.ndarray | None = None,
    numbers: np.ndarray | None = None,
    settle: int = 0,
) -> Workspace:
    """Return the plan of some matrices; it keeps its arrays.

    Args:
        starts: (runs, parameters and states) from which to look for first regimes.
        numbers: (runs, contacts) for these, −1 where they are to be found.
        settle: address of the function that is called where regimes have changed.
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
        "full_stiffness": int(matrices.stiffness.ndim == 2),
        "full_damping": int(matrices.damping.ndim == 2),
        "balanced": int(matrices.balanced),
        "curved": int(matrices.curved),
        "n_jobs": 0 if starts is None else len(starts),
        "settle": settle,
    }
    # a view of nothing has no address
    arrays = {
        name: each if each.size else np.zeros(1, each.dtype)
        for name, each in arrays.items()
    }
    return Workspace(PLAN_TABLE, arrays, sizes)
