"""Find steady sliding of a structure: which contacts stay closed, and the forces in them.

With σᵢ = sgn(speedᵢ V) and μᵢ = μ(|speedᵢ V|) the state is that of
K q = f + Σ (nᵢ + σᵢ μᵢ tᵢ) Nᵢ, Nᵢ = max(preloadᵢ − kᵢ nᵢᵀq, 0).

A contact whose law is a table is closed in one of its pieces, Nᵢ = Nᵢⱼ − kᵢⱼ nᵢᵀq.

Idea: for given closed contacts and pieces this is linear, so it is computed for contacts that are
all closed, in the pieces of their preloads, and the first contact that pulls, overlaps or is beyond
its piece is changed until none is. Such pivoting ends or comes back; where it comes back, all
combinations of up to 16 contacts are tried. With tables pivoting passes many pieces, and first does
so in a small system of the contacts alone. Several states may fit then: of up to 4096 combinations
all are tried, of more it starts again from the first and the last pieces, and where a second state
is found there is no answer. One factorization of the structure with all contacts closed serves
every set and every friction, since each differs from it by as many columns as there are contacts
(Woodbury's identity). The last correction is computed with a residual that is rounded once.
Invariant: an answer fits its own inequalities. Cost: a factorization, and a small dense system for
each set.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.matrices import sum_of_products
from squealpipe.structures.pencil import DENSE, Extended, sparse_rows


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
    most_compared: int = 4096
    """Combinations of pieces of tables up to which all are tried, to see that one alone fits."""
    at_knot: float = 1e-12
    """Share of the force at a knot of a table by which a contact may be beyond its piece."""
    one_state: float = 1e-9
    """Share of the largest force up to which two combinations are one state, at a knot."""


class NoSlidingError(ValueError):
    """There is no steady sliding."""


@dataclass(frozen=True)
class SteadySliding:
    """Steady sliding.

    Attributes:
        displacement: q, (n,), m.
        force: N of each contact, N; 0 where it is open.
        piece: of the law of each, by number; −1 where it is open.
        stiffness: of each in its piece, N/m; 0 where it is open.
        drag: σ μ of each.
        slope: μ′ of each, s/m.
        belt_speed: V, m/s.
        force_error: by how much rounding can have changed the force of each, N.
    """

    displacement: np.ndarray
    force: np.ndarray
    piece: np.ndarray
    stiffness: np.ndarray
    drag: np.ndarray
    slope: np.ndarray
    force_error: np.ndarray
    belt_speed: float

    @property
    def closed(self) -> np.ndarray:
        """Mask of the contacts that are closed."""
        return np.asarray(self.piece >= 0)


@dataclass(frozen=True)
class _Line:
    """Forces of contacts, each in one piece: N = at_rest − stiffness · nᵀq where closed.

    Attributes:
        stiffness: N/m, (contacts,); of an open one that of its first piece.
        at_rest: force where nᵀq = 0, N.
        closed: mask.
    """

    stiffness: np.ndarray
    at_rest: np.ndarray
    closed: np.ndarray

    @property
    def springs(self) -> np.ndarray:
        """Stiffness, 0 where open, N/m."""
        return np.asarray(self.stiffness * self.closed)


class _Laws:
    """Pieces of the laws of all contacts side by side, (contacts, pieces); unused ones are NaN.

    Attributes:
        counts: (contacts,) numbers of pieces.
        start: (contacts,) the pieces in which the forces are the preloads.
    """

    def __init__(self, structure: ContactStructure) -> None:
        contacts = structure.contacts
        self.counts = np.array([len(contact.lines) for contact in contacts], int)
        shape = len(contacts), int(self.counts.max(initial=1))
        self.stiffness, self.at_rest, self.low, self.high = np.full((4, *shape), np.nan)
        self.stiffness[:, 0], self.at_rest[:, 0] = (
            structure.stiffnesses,
            structure.preloads,
        )
        self.low[:, 0], self.high[:, 0] = 0.0, np.inf
        self.start = np.zeros(len(contacts), int)
        for i in structure.with_tables:
            contact, count = contacts[i], self.counts[i]
            starts, _, low, stiffness = contact.lines.T
            self.stiffness[i, :count], self.low[i, :count] = stiffness, low
            self.at_rest[i, :count] = low + stiffness * (contact.compression - starts)
            self.high[i, :count] = [*low[1:], np.inf]
            self.start[i] = np.searchsorted(low, structure.preloads[i], "right") - 1
        self.start = np.maximum(self.start, 0)
        self.has_tables = bool(structure.with_tables)

    @property
    def combinations(self) -> float:
        """Number of combinations of pieces, and open contacts."""
        return float(np.prod(self.counts + 1.0))

    def line(self, piece: np.ndarray) -> _Line:
        """Return the forces of contacts in pieces (…, contacts), −1 of open ones."""
        contact, used = np.arange(len(self.counts)), np.maximum(piece, 0)
        stiffness, at_rest = self.stiffness[contact, used], self.at_rest[contact, used]
        return _Line(stiffness, at_rest, piece >= 0)

    def next(self, piece: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """Return the piece that follows where a force is beyond its own.

        Args:
            reach: force of each contact in its piece, of open ones in the first, N.
        """
        contact, used = np.arange(len(self.counts)), np.maximum(piece, 0)
        low, high = self.low[contact, used], self.high[contact, used]
        # at a knot round-off would turn back for ever
        below = np.where(
            used > 0, reach < low * (1.0 - SlidingBalance.at_knot), ~(reach > 0)
        )
        above = reach > high * (1.0 + SlidingBalance.at_knot)
        changed = piece + above * 1 - below * 1
        return np.where(piece < 0, np.where(reach > 0, 0, -1), changed)


def steady_sliding(
    structure: ContactStructure, mu: float | np.ndarray, belt_speed: float
) -> SteadySliding:
    """The state in which all closed contacts slide along with the belt.

    Args:
        mu: coefficient of the contacts that have none of their own, or of each, (contacts,).

    Raises:
        NoSlidingError: a belt at rest; a structure that nothing holds; contacts that can be neither
            open nor closed together (as where friction jams); or with tables, in two ways.
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
    pivoting = _Pivoting(structure, _Laws(structure), drag)
    start = pivoting.laws.start
    near = pivoting.ended(start) if pivoting.laws.has_tables else None
    state = pivoting.state(start if near is None else near)
    names = [contact.name for contact in structure.contacts]
    where = f"at mu = {_range(mu)}, belt_speed = {belt_speed:g}"
    if state is None:
        reason = (
            f"the contacts {', '.join(names)} can be neither open nor closed together"
            if pivoting.laws.combinations <= 2**SlidingBalance.most_sought
            else "a search among the states of the contacts did not end"
        )
        raise NoSlidingError(
            f"no steady sliding {where}: {reason}; check preloads and load"
        )
    piece, displacement, force, force_error = state
    if (
        pivoting.laws.has_tables
        and (other := pivoting.another(piece, force)) is not None
    ):
        raise NoSlidingError(
            f"steady sliding {where} is not unique: the contacts {', '.join(names)} can have the "
            f"forces {_listed(force)} N, or {_listed(other)} N; such friction jams. Choose a "
            "smaller mu, or a law that is less stiff"
        )
    return SteadySliding(
        displacement,
        force,
        piece,
        pivoting.laws.line(piece).springs,
        drag,
        slope,
        force_error,
        belt_speed,
    )


def another_sliding(structure: ContactStructure) -> np.ndarray | None:
    """Return contact forces of another steady sliding than the one that is judged, N.

    Contacts may hold a structure near them whose stiffness is indefinite, as by centrifugal
    softening: farther away, where some are open, it balances once more, and beyond that it runs
    away. Much friction has two states, too. It is None where there is none, or where too many
    combinations of open contacts would have to be tried.

    Raises:
        NoSlidingError: there is no steady sliding.
    """
    if not structure.contacts:
        return None
    sliding = steady_sliding(structure, structure.mu, structure.belt_speed)
    at_speed = structure.at_speed(structure.belt_speed)
    pivoting = _Pivoting(at_speed, _Laws(at_speed), sliding.drag)
    return pivoting.another(sliding.piece, sliding.force)


def _listed(forces: np.ndarray) -> str:
    shown = [f"{force:g}" for force in forces[:4]]
    return ", ".join([*shown, "…"] if len(forces) > 4 else shown)


class _Pivoting:
    """Search for the pieces that fit the forces in them.

    Args:
        drag: σ μ of each contact.
    """

    def __init__(
        self, structure: ContactStructure, laws: _Laws, drag: np.ndarray
    ) -> None:
        self.structure, self.laws, self.drag = structure, laws, drag

    def state(
        self, start: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray] | None:
        """Return the pieces that are found from others, displacements, forces and their errors."""
        structure, laws = self.structure, self.laws
        piece: Any = start.copy()
        seen: set[bytes] = set()
        # contacts change one at a time, the first in order: such pivoting ends or comes back
        while piece is not None and piece.tobytes() not in seen:
            seen.add(piece.tobytes())
            line = laws.line(piece)
            displacement, force_error = _balance(structure, line, self.drag)
            reach = line.at_rest - line.stiffness * (structure.normals.T @ displacement)
            following = laws.next(piece, reach)
            wrong = np.flatnonzero(piece != following)
            if not wrong.size:
                force = np.where(line.closed, reach, 0.0)
                return piece, displacement, force, force_error
            piece[wrong[0]] = following[wrong[0]]
            # with much friction pivoting may pass the state by
            if piece.tobytes() in seen:
                fitting = self._sought(2**SlidingBalance.most_sought, first=True)
                piece = fitting[0][0] if fitting else None
        return None

    def another(self, piece: np.ndarray, force: np.ndarray) -> np.ndarray | None:
        """Return the forces of another state than one in these pieces, if one is found."""
        laws, same = self.laws, SlidingBalance.one_state * float(force.max(initial=0.0))
        if laws.combinations <= SlidingBalance.most_compared:
            fitting = [each for _, each in self._sought(SlidingBalance.most_compared)]
        else:
            ends = [self.ended(each) for each in (0 * laws.counts, laws.counts - 1)]
            others = [
                each for each in ends if each is not None and (each != piece).any()
            ]
            states = map(self.state, others)
            fitting = [state[2] for state in states if state is not None]
        return next((each for each in fitting if abs(each - force).max() > same), None)

    def ended(self, start: np.ndarray) -> np.ndarray | None:
        """Return the pieces in which pivoting from others ends, by the contacts alone."""
        if self._of_contacts is None:
            return None
        by_load, by_force, by_springs = self._of_contacts
        piece, seen = start.copy(), set()
        while piece.tobytes() not in seen:
            seen.add(piece.tobytes())
            line = self.laws.line(piece)
            right = by_load + by_force @ (line.closed * line.at_rest)
            try:
                nearing = np.linalg.solve(by_springs + by_force * line.springs, right)
            except np.linalg.LinAlgError:  # nothing holds the structure then
                return None
            following = self.laws.next(piece, line.at_rest - line.stiffness * nearing)
            wrong = np.flatnonzero(piece != following)
            if not wrong.size:
                return piece
            piece[wrong[0]] = following[wrong[0]]
        return None

    @cached_property
    def _of_contacts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
        """Matrices of nᵢᵀq by the load, by forces of contacts and by their springs, which hold it.

        None where the structure is singular although springs are at all contacts.
        """
        structure = self.structure
        try:
            held = _held(structure)
        except RuntimeError:
            return None
        normals = structure.normals
        return (
            normals.T @ held.factors.solve(structure.load),
            normals.T @ (held.of_normals + held.of_tangentials * self.drag),
            np.eye(len(self.drag))
            - (normals.T @ held.of_normals) * structure.stiffnesses,
        )

    def _sought(
        self, most: int, *, first: bool = False
    ) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return pieces that fit, and forces in them, of all combinations; none of too many.

        With springs kᵢ at all contacts uᵢ = nᵢᵀq is linear in u itself and in the forces of the
        closed contacts, so that each combination is a small system.

        Args:
            first: whether one is enough.
        """
        laws = self.laws
        if laws.combinations > most or self._of_contacts is None:
            return []
        by_load, by_force, by_springs = self._of_contacts
        radix = np.concatenate([[1], np.cumprod(laws.counts + 1)]).astype(int)
        pieces = np.arange(radix[-1])[:, None] // radix[:-1] % (laws.counts + 1) - 1
        # most of them closed first
        order = np.argsort(-(pieces >= 0).sum(axis=1), kind="stable")
        found: list[tuple[np.ndarray, np.ndarray]] = []
        for chunk in np.array_split(pieces[order], max(len(order) // 4096, 1)):
            line = laws.line(chunk)
            matrices = by_springs + by_force * line.springs[:, None, :]
            right = by_load + (line.closed * line.at_rest) @ by_force.T
            regular = np.linalg.det(matrices) != 0
            nearing = np.linalg.solve(matrices[regular], right[regular][:, :, None])
            reach = line.at_rest[regular] - line.stiffness[regular] * nearing[:, :, 0]
            tried = chunk[regular]
            fits = (tried == laws.next(tried, reach)).all(axis=1)
            forces = np.where(tried >= 0, reach, 0.0)
            found += zip(tried[fits], forces[fits], strict=True)
            if found and first:
                break
        return found


def _range(values: Any) -> str:
    if not np.size(values):
        return "none"
    low, high = np.min(values), np.max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def changes(
    sliding: Callable[[float], SteadySliding], low: float, high: float
) -> list[tuple[float, float]]:
    """Return where contacts open, close or change their piece from one friction to another.

    Args:
        sliding: steady sliding at a friction.

    Returns:
        The last friction with the contacts of before and the first with others, for each change
        that is needed to come from the contacts closed at ``low`` to those at ``high``.

    Raises:
        NoSlidingError: there is no steady sliding on the way.
    """

    def closed_at(mu: float) -> np.ndarray:
        return sliding(mu).piece

    passed: list[tuple[float, float]] = []
    closed, last = closed_at(low), closed_at(high)
    while (closed != last).any() and len(passed) < SlidingBalance.most_changes:
        before, after = low, high
        while after - before > SlidingBalance.located:
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
        held = structure.stiffness + contact_stiffness(
            structure, structure.stiffnesses, structure.normals
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
        self, line: _Line, drag: np.ndarray
    ) -> Callable[[np.ndarray], np.ndarray]:
        """x of (K + Σ k (n + σ μ t) nᵀ over closed contacts) x = b as a function of b.

        Raises:
            RuntimeError: that matrix is singular.
        """
        structure = self.structure
        springs, normals = structure.stiffnesses, structure.normals
        # the matrix is the held one plus Σ k a nᵀ, with a = σ μ t closed and −n open; in a piece
        # of another stiffness s both by its share s / k
        share = line.springs / springs
        change = self.of_tangentials * (drag * share) + self.of_normals * (share - 1.0)
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
    held = _held_states.get(structure)
    if held is None:
        held = _held_states[structure] = _Held(structure)
    return held


def _solver(
    structure: ContactStructure, line: _Line, drag: np.ndarray, matrix: Any
) -> Callable[[np.ndarray], np.ndarray]:
    """Solutions with the stiffness of these contacts.

    Args:
        matrix: that of the structure and its closed contacts.

    Raises:
        RuntimeError: it is singular.
    """
    if structure.size > DENSE and structure.contacts:
        return _held(structure).solver(line, drag)
    # the rows of Kᵀ are the columns of K
    return splu(sparse_rows(matrix.T).T).solve  # type: ignore[no-any-return]


_held_states: WeakKeyDictionary[ContactStructure, _Held] = WeakKeyDictionary()
"""Factors of large structures, kept as long as these live."""
_wide_matrices: WeakKeyDictionary[ContactStructure, list[Extended]] = (
    WeakKeyDictionary()
)
"""Matrices of the residuals in extended precision, which no friction changes, kept as long."""


def _balance(
    structure: ContactStructure, line: _Line, drag: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """q of K q + Σ k (n + σ μ t) nᵀ q = f + Σ (n + σ μ t) preload over closed contacts.

    Returns:
        q, and by how much rounding can have changed the force of each contact.
    """
    closed, springs = line.closed, line.stiffness
    acting = acting_directions(structure, closed, drag)
    matrix = structure.stiffness + contact_stiffness(structure, line.springs, acting)
    force = structure.load + acting @ (line.at_rest * closed)
    if not force.any():
        return np.zeros(structure.size), np.zeros(len(closed))
    try:
        solve = _solver(structure, line, drag, matrix)
        solution = solve(force)
        # a structure that its contacts alone hold, and barely, loses digits, which residuals in
        # extended precision bring back
        unbalanced = _unbalanced(structure, line, drag)
        change = solution
        for _ in range(SlidingBalance.refinements):
            change = solve(unbalanced(solution))
            solution = solution + change
        missed = np.abs(unbalanced(solution))
        # each row has its own scale, since a penalty or a rigid link makes single rows larger by
        # any factor; load and preloads may cancel each other but for round-off
        carried = abs(matrix) @ np.abs(solution) + np.abs(structure.load)
        carried += np.abs(acting) @ np.abs(line.at_rest * closed)
        forces, changes_of_forces = (
            np.abs(springs * (structure.normals.T @ each)).max(initial=0.0)
            for each in (solution, change)
        )
        pressed = max(forces, np.abs(structure.preloads).max(initial=0.0))
        unsettled = changes_of_forces > SlidingBalance.unsettled * pressed
        is_unbalanced = not (missed <= 1e3 * SlidingBalance.singular * carried).all()
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
    carried = springs * (np.abs(structure.normals).T @ np.abs(solution))
    left_over = springs * np.abs(structure.normals.T @ change)
    # friction that is rounded moves the state
    drawn = solve(structure.tangentials * closed)
    reach = np.abs(line.at_rest) + carried
    by_drag = springs[:, None] * np.abs(structure.normals.T @ drawn)
    pulled = SlidingBalance.rounding_of_friction * rounding * np.abs(drag) * reach
    return solution, rounding * reach + left_over + by_drag @ pulled


def _unbalanced(
    structure: ContactStructure, line: _Line, drag: np.ndarray
) -> Callable[[np.ndarray], np.ndarray]:
    """f + Σ (n + σ μ t) N − K q over closed contacts as a function of q, rounded once."""
    wide = _wide_matrices.get(structure)
    if wide is None:
        given = (structure.stiffness, structure.normals, structure.tangentials)
        wide = [Extended(each) for each in (*given, structure.normals.T)]
        _wide_matrices[structure] = wide
    stiffness, pressing, pulling, nearing = wide
    load, preloads, stiffnesses, drags = (
        each.astype(np.longdouble)
        for each in (structure.load, line.at_rest, line.stiffness, drag)
    )

    def unbalanced(displacement: np.ndarray) -> np.ndarray:
        forces = preloads - stiffnesses * nearing.product(displacement)
        forces = forces * line.closed
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
    structure: ContactStructure, springs: np.ndarray, acting: np.ndarray
) -> Any:
    """Σ k (n + σ μ t) nᵀ, sparse, with the stiffness of each contact, 0 of open ones."""
    return sum_of_products(acting, structure.normals * springs)
