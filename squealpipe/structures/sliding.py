"""Find steady sliding of a structure: which contacts stay closed, and the forces in them.

With σᵢ = sgn(speedᵢ V) and μᵢ = μ(|speedᵢ V|) the state is that of
K q = f + Σ (nᵢ + σᵢ μᵢ tᵢ) Nᵢ, Nᵢ = max(preloadᵢ − kᵢ nᵢᵀq, 0).

Idea: for given closed contacts this is linear, so it is computed for contacts that are all closed,
and the first contact that pulls, or overlaps, is changed until none does. Such pivoting ends or
comes back; where it comes back, all combinations of up to 16 contacts are tried. One factorization
of the structure with all contacts closed serves every set and every friction, since each differs
from it by as many columns as there are contacts (Woodbury's identity). The last correction is
computed with a residual that is rounded once. Invariant: an answer fits its own inequalities. Cost:
a factorization, and a small dense system for each set.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.pencil import DENSE, Extended


@dataclass(frozen=True)
class SlidingBalance:
    """Thresholds of the steady state under friction."""

    singular: float = 1e-13
    """Residual of the steady state, over the forces in it, beyond which the stiffness is
    singular."""
    refinements: int = 2
    """Corrections of the steady state by its residual."""
    unsettled: float = 1e-4
    """Share by which the last correction changes contact forces that round-off alone makes."""
    rounding_of_friction: float = 8.0
    """Units of rounding in a coefficient of friction and its slope."""
    located: float = 1e-12
    """Tolerance of a friction that is located."""
    most_changes: int = 32
    """Contacts that open or close between two frictions, at most."""
    most_sought: int = 16
    """Contacts up to which all combinations of open and closed ones are tried."""


BALANCE = SlidingBalance()


class NoSlidingError(ValueError):
    """There is no steady sliding."""


@dataclass(frozen=True)
class SteadySliding:
    """Steady sliding.

    Attributes:
        displacement: q, (n,), m.
        force: N of each contact, N; 0 where it is open.
        closed: which contacts are closed.
        drag: σ μ of each.
        slope: μ′ of each, s/m.
        belt_speed: V, m/s.
        force_error: by how much rounding can have changed the force of each, N.
    """

    displacement: np.ndarray
    force: np.ndarray
    closed: np.ndarray
    drag: np.ndarray
    slope: np.ndarray
    force_error: np.ndarray
    belt_speed: float


def steady_sliding(
    structure: ContactStructure, mu: float | np.ndarray, belt_speed: float
) -> SteadySliding:
    """The state in which all closed contacts slide along with the belt.

    Args:
        mu: coefficient of the contacts that have none of their own, or of each, (contacts,).

    Raises:
        NoSlidingError: a belt at rest; a structure that nothing holds; or contacts of which none
            can be open or closed (as where friction jams).
    """
    structure = structure.at_speed(belt_speed)
    if not np.ndim(mu):
        mu = np.where(structure.has_own_mu, structure.mu_of_contacts, mu)
    speeds = structure.speeds * belt_speed
    if belt_speed == 0 and structure.contacts:
        raise NoSlidingError(
            "belt_speed = 0: contacts slide only on a belt that moves; choose another"
        )
    sizes = np.abs(speeds)
    laws = [
        law if law.mu == each else replace(law, mu=float(each))
        for law, each in zip(structure.frictions, np.asarray(mu), strict=True)
    ]
    drag = np.sign(speeds) * [
        float(law.coefficient(size)) for law, size in zip(laws, sizes, strict=True)
    ]
    slope = np.array(
        [float(law.slope(size)) for law, size in zip(laws, sizes, strict=True)]
    )
    closed: Any = np.ones(len(speeds), bool)
    seen: set[bytes] = set()
    # contacts change one at a time, the first in order: such pivoting ends or comes back
    while closed is not None and closed.tobytes() not in seen:
        seen.add(closed.tobytes())
        displacement, force_error = _balance(structure, closed, drag)
        reach = structure.preloads - structure.stiffnesses * (
            structure.normals.T @ displacement
        )
        wrong = np.flatnonzero(closed != (reach > 0))
        if not wrong.size:
            force = np.where(closed, reach, 0.0)
            return SteadySliding(
                displacement, force, closed, drag, slope, force_error, belt_speed
            )
        closed[wrong[0]] = ~closed[wrong[0]]
        # with much friction pivoting may pass the state by
        if closed.tobytes() in seen:
            closed = _sought(structure, drag)
    names = [contact.name for contact in structure.contacts]
    reason = (
        f"the contacts {', '.join(names)} can be neither open nor closed together"
        if len(names) <= BALANCE.most_sought
        else "a search among the states of the contacts did not end"
    )
    raise NoSlidingError(
        f"no steady sliding at mu = {_range(mu)}, belt_speed = {belt_speed:g}: {reason}; check "
        "preloads and load"
    )


def _range(values: Any) -> str:
    low, high = np.min(values), np.max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _sought(structure: ContactStructure, drag: np.ndarray) -> np.ndarray | None:
    """Return the closed contacts of a state that fits, of all combinations; None if none does.

    With springs kᵢ at all contacts the nearing uᵢ = nᵢᵀq is linear in u itself and in the forces
    of the closed contacts, so that each combination is a small system.
    """
    number = len(drag)
    if number > BALANCE.most_sought:
        return None
    normals, stiffnesses = structure.normals, structure.stiffnesses
    all_closed = np.ones(number, bool)
    held = structure.stiffness + contact_stiffness(structure, all_closed, normals)
    try:
        factors = splu(sp.csc_array(held))
    except RuntimeError:  # exactly singular
        return None
    by_load = normals.T @ factors.solve(structure.load)
    by_force = normals.T @ factors.solve(acting_directions(structure, all_closed, drag))
    by_springs = np.eye(number) - normals.T @ factors.solve(normals * stiffnesses)
    combinations = (np.arange(2**number)[:, None] >> np.arange(number)) % 2 == 1
    # most of them closed first
    order = np.argsort(-combinations.sum(axis=1), kind="stable")
    for chunk in np.array_split(combinations[order], max(len(order) // 4096, 1)):
        matrices = by_springs + by_force * (chunk * stiffnesses)[:, None, :]
        right = by_load + (chunk * structure.preloads) @ by_force.T
        regular = np.linalg.det(matrices) != 0
        nearing = np.linalg.solve(matrices[regular], right[regular][:, :, None])
        reach = structure.preloads - stiffnesses * nearing[:, :, 0]
        fits = (chunk[regular] == (reach > 0)).all(axis=1)
        if fits.any():
            return np.array(chunk[regular][fits][0])
    return None


def changes(
    sliding: Callable[[float], SteadySliding], low: float, high: float
) -> list[tuple[float, float]]:
    """Return where contacts open or close on the way from one friction to another.

    Args:
        sliding: steady sliding at a friction.

    Returns:
        The last friction with the contacts of before and the first with others, for each change
        that is needed to come from the contacts closed at ``low`` to those at ``high``.

    Raises:
        NoSlidingError: there is no steady sliding on the way.
    """

    def closed_at(mu: float) -> np.ndarray:
        return sliding(mu).closed

    passed: list[tuple[float, float]] = []
    closed, last = closed_at(low), closed_at(high)
    while (closed != last).any() and len(passed) < BALANCE.most_changes:
        before, after = low, high
        while after - before > BALANCE.located:
            middle = 0.5 * (before + after)
            if np.array_equal(closed_at(middle), closed):
                before = middle
            else:
                after = middle
        passed.append((before, after))
        low, closed = after, closed_at(after)
    return passed


class _Held:
    """Factors of K + Σ k n nᵀ, the structure with all its contacts closed and without friction.

    Open contacts and friction change that matrix by a product of few columns, so that one
    factorization solves every state of the contacts at every friction (Woodbury).
    """

    def __init__(self, structure: ContactStructure) -> None:
        self.structure = structure
        closed = np.ones(len(structure.contacts), bool)
        held = structure.stiffness + contact_stiffness(
            structure, closed, structure.normals
        )
        self.factors = splu(
            sp.csc_array(held),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.1,
            options={"SymmetricMode": True},
        )
        self.of_normals = self.factors.solve(structure.normals)
        self.of_tangentials = self.factors.solve(structure.tangentials)

    def solver(
        self, closed: np.ndarray, drag: np.ndarray
    ) -> Callable[[np.ndarray], np.ndarray]:
        """x of (K + Σ k (n + σ μ t) nᵀ over closed contacts) x = b as a function of b.

        Raises:
            RuntimeError: that matrix is singular.
        """
        structure = self.structure
        springs, normals = structure.stiffnesses, structure.normals
        # the matrix is the held one plus Σ k a nᵀ, with a = σ μ t closed and −n open
        change = self.of_tangentials * (drag * closed) - self.of_normals * ~closed
        small = np.eye(len(springs)) + springs[:, None] * (normals.T @ change)
        try:
            inverse = np.linalg.inv(small)
        except np.linalg.LinAlgError:
            raise RuntimeError("the stiffness is singular") from None

        def solve(right: np.ndarray) -> np.ndarray:
            solution = self.factors.solve(right)
            nearing = springs * (normals.T @ solution).T
            return solution - change @ (inverse @ nearing.T)  # type: ignore[no-any-return]

        return solve


def static_answers(
    structure: ContactStructure, forces: np.ndarray | None = None
) -> np.ndarray:
    """Displacements of a large structure with closed contacts by its load and contact forces.

    Args:
        forces: others in their place, (n, k).

    Returns:
        (n, 1 + 2 contacts): those of the load, of normal and of tangential unit forces; none where
        nothing holds the structure.
    """
    try:
        held = _held(structure)
        if forces is not None:
            answers = held.factors.solve(forces)
            return np.asarray(answers[:, np.isfinite(answers).all(axis=0)])
        answers = np.column_stack(
            [held.factors.solve(structure.load), held.of_normals, held.of_tangentials]
        )
    except RuntimeError:  # the factor is exactly singular
        return np.empty((structure.size, 0))
    return answers[:, np.isfinite(answers).all(axis=0)]


def _held(structure: ContactStructure) -> _Held:
    held = _HELD.get(structure)
    if held is None:
        held = _HELD[structure] = _Held(structure)
    return held


def _solver(
    structure: ContactStructure, closed: np.ndarray, drag: np.ndarray
) -> Callable[[np.ndarray], np.ndarray]:
    """Solutions with the stiffness of these contacts.

    Raises:
        RuntimeError: it is singular.
    """
    if structure.size > DENSE and structure.contacts:
        return _held(structure).solver(closed, drag)
    acting = acting_directions(structure, closed, drag)
    matrix = structure.stiffness + contact_stiffness(structure, closed, acting)
    return splu(sp.csc_array(matrix)).solve  # type: ignore[no-any-return]


_HELD: WeakKeyDictionary[ContactStructure, _Held] = WeakKeyDictionary()
"""Factors of large structures, kept as long as these live."""


def _balance(
    structure: ContactStructure, closed: np.ndarray, drag: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """q of K q + Σ k (n + σ μ t) nᵀ q = f + Σ (n + σ μ t) preload over closed contacts.

    Returns:
        q, and by how much rounding can have changed the force of each contact.
    """
    acting = acting_directions(structure, closed, drag)
    matrix = structure.stiffness + contact_stiffness(structure, closed, acting)
    force = structure.load + acting @ (structure.preloads * closed)
    if not force.any():
        return np.zeros(structure.size), np.zeros(len(closed))
    try:
        solve = _solver(structure, closed, drag)
        solution = solve(force)
        # a structure that its contacts alone hold, and barely, loses digits, which residuals in
        # extended precision bring back
        unbalanced = _unbalanced(structure, closed, drag)
        change = solution
        for _ in range(BALANCE.refinements):
            change = solve(unbalanced(solution))
            solution = solution + change
        missed = np.abs(unbalanced(solution))
        # each row has its own scale, since a penalty or a rigid link makes single rows larger by
        # any factor; load and preloads may cancel each other but for round-off
        carried = abs(matrix) @ np.abs(solution) + np.abs(structure.load)
        carried += np.abs(acting) @ np.abs(structure.preloads * closed)
        forces, changes_of_forces = (
            np.abs(structure.stiffnesses * (structure.normals.T @ each)).max(
                initial=0.0
            )
            for each in (solution, change)
        )
        pressed = max(forces, np.abs(structure.preloads).max(initial=0.0))
        unsettled = changes_of_forces > BALANCE.unsettled * pressed
        is_unbalanced = not (missed <= 1e3 * BALANCE.singular * carried).all()
    except RuntimeError:  # the factor is exactly singular
        is_unbalanced = unsettled = True
    if unsettled or is_unbalanced:
        hardest = float(structure.stiffnesses.max(initial=0.0))
        bodies = float(np.abs(structure.stiffness.diagonal()).max())
        if hardest > 1e-3 / np.finfo(float).eps * bodies:
            raise NoSlidingError(
                f"contacts are as stiff as {hardest:.2g} N/m, where the structure has at most "
                f"{bodies:.2g} N/m on its diagonal: sums of both keep no digit; a contact is rigid "
                f"from {100.0 * bodies:.2g} N/m on"
            )
        raise NoSlidingError(
            "nothing holds the structure against its load: the stiffness is singular with "
            f"{'all' if closed.all() else 'some'} contacts closed; add supports"
        )
    rounding = np.finfo(float).eps
    springs = structure.stiffnesses
    carried = springs * (np.abs(structure.normals).T @ np.abs(solution))
    left_over = springs * np.abs(structure.normals.T @ change)
    # friction that is rounded moves the state
    drawn = solve(structure.tangentials * closed)
    reach = np.abs(structure.preloads) + carried
    by_drag = springs[:, None] * np.abs(structure.normals.T @ drawn)
    pulled = BALANCE.rounding_of_friction * rounding * np.abs(drag) * reach
    return solution, rounding * reach + left_over + by_drag @ pulled


def _unbalanced(
    structure: ContactStructure, closed: np.ndarray, drag: np.ndarray
) -> Callable[[np.ndarray], np.ndarray]:
    """f + Σ (n + σ μ t) N − K q over closed contacts as a function of q, rounded once."""
    stiffness, nearing = (
        Extended(each) for each in (structure.stiffness, structure.normals.T)
    )
    load, preloads, stiffnesses, drags = (
        each.astype(np.longdouble)
        for each in (structure.load, structure.preloads, structure.stiffnesses, drag)
    )
    pressing, pulling = (
        Extended(each) for each in (structure.normals, structure.tangentials)
    )

    def unbalanced(displacement: np.ndarray) -> np.ndarray:
        forces = (preloads - stiffnesses * nearing.product(displacement)) * closed
        rest = load + pressing.product(forces) + pulling.product(drags * forces)
        rest = rest - stiffness.product(displacement)
        return rest.astype(float)  # type: ignore[no-any-return]

    return unbalanced


def acting_directions(
    structure: ContactStructure, closed: np.ndarray, drag: np.ndarray
) -> Any:
    """n + σ μ t of closed contacts, 0 of open ones, (n, contacts)."""
    return (structure.normals + structure.tangentials * drag) * closed


def contact_stiffness(
    structure: ContactStructure, closed: np.ndarray, acting: np.ndarray
) -> Any:
    """Σ k (n + σ μ t) nᵀ, sparse."""
    normals = sp.csr_array(structure.normals * (structure.stiffnesses * closed))
    return sp.csr_array(acting) @ normals.T
