"""Coordinates of a reduced structure: modes at rest, and static responses of contact forces.

Idea: the lowest modes at rest hardly have the local compliance under a contact, which decides a
flutter there. So static responses K⁻¹nᵢ of the normal forces, and if asked for K⁻¹tᵢ of the
tangential ones, are kept beside them, each less its part in the modes (residual attachment modes:
MacNeal 1971, Rubin 1975; Craig and Bampton 1968 keep the same space). K is symmetric, so with the
normal ones alone every nᵢᵀK⁻¹nⱼ and nᵢᵀK⁻¹tⱼ is that of the whole structure: contact forces of
steady sliding are exact, whichever contacts are closed.

Invariant: the mass is 1 and the stiffness at rest diagonal; the modes come first, and the
responses, turned among themselves, have higher frequencies than these. A response that depends on
the rest is left out. Cost: the factors that steady sliding has already, or the modes alone where
all are known, and small matrices for each number of coordinates.
"""

from functools import cached_property

import numpy as np
import scipy.linalg as la

from squealpipe.structures.contact import are_parallel, dependent_contacts
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.dense import all_modes
from squealpipe.structures.linearized import pencil_about
from squealpipe.structures.modes import modes_at_rest
from squealpipe.structures.pencil import DENSE, Pencil
from squealpipe.structures.sliding import static_answers, steady_sliding
from squealpipe.structures.subspace import added, in_coordinates


class StaticSpace:
    """The lowest modes at rest with all static responses beyond them, and the structure in both.

    Args:
        n_modes: number of modes at rest.
    """

    def __init__(self, structure: ContactStructure, n_modes: int) -> None:
        self.whole, self.n_modes = structure, n_modes
        omega, modes = modes_at_rest(
            structure, None if structure.size <= DENSE else n_modes
        )
        responses = static_responses(structure, omega, modes)
        omega, modes = omega[:n_modes], modes[:, :n_modes]
        beyond = added(structure, modes, responses)
        self.basis = basis = np.hstack([modes, beyond])
        """(n, modes and responses), orthonormal by mass."""
        self.responses = basis.T @ (structure.mass @ responses)
        """Static responses in this basis, the normal ones first."""
        at_rest = basis.T @ (structure.stiffness_at_rest @ basis)
        # round-off of the modes would couple them
        self.at_rest = la.block_diag(np.diag(omega**2), at_rest[n_modes:, n_modes:])
        self.stiffness = basis.T @ (structure.given_stiffness @ basis)
        self.stiffness += self.at_rest - at_rest
        self.damping = basis.T @ (structure.given_damping @ basis)
        self.speed_terms = structure.speed_terms.mapped(
            lambda each: basis.T @ (each @ basis)
        )
        self.directions = tuple(
            basis.T @ each
            for each in (
                structure.normals,
                structure.tangentials,
                structure.transversals,
            )
        )
        self.load = basis.T @ structure.load

    def beyond(self, n_modes: int, directions: int) -> np.ndarray:
        """Return what static responses add to so many modes, orthonormal, in this basis.

        Args:
            directions: of each contact: 0 none, 1 the normal one, 2 both.
        """
        responses = self.responses[:, : directions * len(self.whole.contacts)]
        lengths = np.linalg.norm(responses, axis=0)
        rest: np.ndarray = responses[:, lengths > 0] / lengths[lengths > 0]
        rest[:n_modes] = 0.0
        if not rest.size:
            return rest
        vectors, sizes, _ = la.svd(rest, full_matrices=False)
        # share of a response that the others leave of it, below which it is round-off
        return np.asarray(vectors[:, sizes > 1e-6])


def static_responses(
    structure: ContactStructure, omega: np.ndarray, modes: np.ndarray
) -> np.ndarray:
    """Return displacements by unit forces at the closed contacts, normal ones first.

    Args:
        omega, modes: at rest, all or the lowest.

    Returns:
        (n, 2 contacts); (n, 0) of a large structure that nothing holds.
    """
    if modes.shape[1] < structure.size:
        answers = static_answers(structure)[:, 1:]
        is_held = answers.shape[1] == 2 * len(structure.contacts)
        return answers if is_held else answers[:, :0]
    forces = np.hstack([structure.normals, structure.tangentials])
    # rigid bodies have no static response, and are among the modes anyway
    elastic = omega > 1e-6 * np.median(omega)
    return np.asarray(
        modes[:, elastic] @ ((modes[:, elastic].T @ forces).T / omega[elastic] ** 2).T
    )


class Coordinates:
    """Coordinates of some modes at rest and static responses, and the structure in them.

    Args:
        number: number of coordinates.
        directions: static responses of each contact: 0 none, 1 the normal one, 2 both.
    """

    def __init__(self, space: StaticSpace, number: int, directions: int) -> None:
        self.space, self.number, self.directions = space, number, directions
        count = directions * len(space.whole.contacts)
        self.n_modes = max(number - count, 0)
        """Number of modes at rest; the other coordinates are static responses."""
        responses = space.beyond(self.n_modes, directions)
        # dependent responses leave room for further modes
        while self.n_modes + responses.shape[1] < number:
            self.n_modes += 1
            responses = space.beyond(self.n_modes, directions)
        responses = responses[:, : number - self.n_modes]
        self.turn, squares = responses, np.empty(0)
        if responses.size:
            squares, turn = la.eigh(responses.T @ space.at_rest @ responses)
            self.turn = responses @ turn
            # signs that depend neither on the machine nor on further modes in the space: the first
            # of the largest parts in the responses is positive
            parts = space.responses.T @ self.turn
            sizes = np.abs(parts)
            first = (sizes >= (1.0 - 1e-6) * sizes.max(axis=0)).argmax(axis=0)
            self.turn *= np.sign(parts[first, np.arange(len(squares))])
        modes = np.eye(len(space.at_rest), self.n_modes)
        self.turn = np.hstack([modes, self.turn[:, : number - self.n_modes]])
        """(space, number): coordinates → coordinates of the space."""
        own = np.diag(space.at_rest)[: self.n_modes]
        self.omega = np.sqrt(np.concatenate([own, np.maximum(squares, 0.0)]))
        """Frequencies at rest, rad/s, ascending."""

    @property
    def modes(self) -> np.ndarray:
        """Displacements of the structure at unit amplitude of each coordinate, (n, number)."""
        return np.asarray(self.space.basis @ self.turn)

    @cached_property
    def tangentials(self) -> np.ndarray:
        """Tangential directions of the contacts, (number, contacts)."""
        return np.asarray(self.turn.T @ self.space.directions[1])

    def parallel_contact(self) -> str | None:
        """Name the first contact whose normal and tangent are parallel here; None if none are."""
        normals = self.turn.T @ self.space.directions[0]
        for index, contact in enumerate(self.space.whole.contacts):
            normal, along = normals[:, index], self.tangentials[:, index]
            if not normal.any() or not along.any() or are_parallel(normal, along):
                return contact.name
        return None

    def dependent(self) -> list[str]:
        """Name the contacts whose sliding directions are dependent in these coordinates."""
        return dependent_contacts(self.space.whole.contacts, self.tangentials)

    def _projected(self, matrix: np.ndarray) -> np.ndarray:
        return np.asarray(self.turn.T @ (matrix @ self.turn))

    @cached_property
    def reduced(self) -> ContactStructure:
        """Structure in these coordinates."""
        space = self.space
        whole = space.whole
        stiffness = self._projected(space.stiffness)
        stiffness += np.diag(self.omega**2) - self._projected(space.at_rest)
        ratios = whole.modal_damping
        if ratios.ndim:  # one for each of the lowest, and none for others
            ratios = np.pad(ratios, (0, self.number))[: self.number]
        return in_coordinates(
            whole,
            stiffness,
            self._projected(space.damping) + np.diag(2.0 * ratios * self.omega),
            tuple(self.turn.T @ direction for direction in space.directions),
            None if whole.given_load is None else self.turn.T @ space.load,
            space.speed_terms.mapped(self._projected),
        )

    def values(self) -> np.ndarray:
        """Return the eigenvalues of the reduced structure about its own steady sliding, 1/s."""
        pairs = all_modes(self._pencil())
        return np.array([pair.value for pair in pairs])

    def small_motions(self) -> tuple[np.ndarray, np.ndarray]:
        """Return stiffness and damping about steady sliding, (number, number); the mass is 1.

        Raises:
            NoSlidingError: there is no steady sliding in these coordinates.
        """
        _, damping, stiffness = self._pencil().dense
        return stiffness, damping

    def _pencil(self) -> Pencil:
        state = steady_sliding(self.reduced, self.reduced.mu, self.reduced.belt_speed)
        return pencil_about(self.reduced, state, None)
