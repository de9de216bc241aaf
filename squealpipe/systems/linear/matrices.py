"""Matrices and contacts that the loop runs: no names, no units, no structure."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Self

import numpy as np


class FrictionNumbers(NamedTuple):
    """Friction laws by number."""

    coulomb: int = 0
    exponential: int = 1
    hyperbolic: int = 2
    table: int = 3


friction_number = FrictionNumbers()

PIECE_FIELDS = ("mu_start", "mu_end", "mu_c0", "mu_c1", "mu_c2", "mu_c3")
"""Constants of one piece of a table of friction."""
PRESS_FIELDS = ("press_start", "press_end", "press_c0", "press_c1")
"""Constants of one piece of a table of contact: compressions, m, force at the first, N, and N/m."""


class RegimeConstants(NamedTuple):
    """Constants of a regime; those of a piece of a table follow."""

    is_closed: int = 0
    direction: int = 1
    is_stuck: int = 2
    first_of_piece: int = 3


regime_constant = RegimeConstants()

FIRST_OF_PRESS = regime_constant.first_of_piece + len(PIECE_FIELDS)
"""Place of the constants of a piece of a table of contact, where some contact has one."""


class Caps(NamedTuple):
    """Sizes up to which structures are run.

    A run of the largest takes about 0.3 GB and some 15 ms a step; beyond, modes of a
    reduction should be left out or contacts merged.
    """

    modes: int = 512
    contacts: int = 512


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactMatrices:
    """q̈ = f − K q − C q̇ + Σ (M⁻¹nᵢ Pᵢ + M⁻¹tᵢ Tᵢ), divided by the mass; n states of c contacts.

    Attributes:
        stiffness: M⁻¹ (K + Σ kᵢ nᵢnᵢᵀ), (n, n), or its diagonal (n,): with all contacts closed.
        damping: M⁻¹ C, (n, n) or (n,).
        load: M⁻¹ f, (n,), where the parameter ``preload`` is 1.
        balanced: whether the load grows with that parameter.
        normals, tangentials: (n, c).
        pushes, drags: M⁻¹ n and M⁻¹ t, (n, c).
        springs, preloads, speeds: (c,) stiffness, N/m, preload, N, and belt speed over that of the
            parameter. Of a table ``springs`` is the stiffness that ``stiffness`` has of it.
        laws: (c,) friction law, by number.
        pieces: of each contact, (pieces, 6) of its table of friction, :data:`PIECE_FIELDS`; one row
            of zeros without.
        presses: of each contact, (pieces, 4) of its table of contact, :data:`PRESS_FIELDS`, whose
            forces rise; one row without: the force is preload − stiffness · nᵀq.
        hidden: friction force that round-off hides, N.
        shapes: (outputs, n) further outputs: displacements as combinations of the states.
        tangential_springs: (c,) stiffness of the spring in series with the slider, N/m; 0: none.
        by_speed: of each part of ``stiffness`` or ``damping`` that is proportional to a power of
            the belt's speed: which of both, the part at the speed ``reference``, (n, n), and its
            power.
        speed: belt speed at which ``stiffness`` and ``damping`` hold.
    """

    stiffness: np.ndarray
    damping: np.ndarray
    load: np.ndarray
    balanced: bool
    normals: np.ndarray
    tangentials: np.ndarray
    pushes: np.ndarray
    drags: np.ndarray
    springs: np.ndarray
    preloads: np.ndarray
    speeds: np.ndarray
    laws: np.ndarray
    pieces: Sequence[np.ndarray]
    presses: Sequence[np.ndarray]
    hidden: float
    shapes: np.ndarray
    tangential_springs: np.ndarray
    by_speed: Sequence[tuple[str, np.ndarray, int]] = ()
    reference: float = 1.0
    speed: float = 1.0

    def at(self, speed: Any) -> Self:
        """Return the matrices of another belt speed, which may be complex.

        Raises:
            ValueError: a speed of 0 where a part has a negative power.
        """
        if not self.by_speed or speed == self.speed:
            return self
        changed: dict[str, Any] = {
            name: full_matrix(getattr(self, name)) for name in ("stiffness", "damping")
        }
        for name, part, power in self.by_speed:
            if speed == 0 and power < 0:
                raise ValueError(
                    f"belt_speed = 0: a speed term of power {power} has no value there; choose "
                    "another speed"
                )
            there, here = (
                (each / self.reference) ** power for each in (speed, self.speed)
            )
            changed[name] = changed[name] + (there - here) * part
        return replace(self, **changed, speed=speed)

    @property
    def n_modes(self) -> int:
        """Number of displacements n."""
        return len(self.load)

    @property
    def n_contacts(self) -> int:
        """Number of contacts c."""
        return len(self.springs)

    @property
    def sliders(self) -> np.ndarray:
        """Numbers of the contacts with a tangential spring: the stretch of each is a state."""
        return np.flatnonzero(self.tangential_springs)

    @property
    def with_tables(self) -> np.ndarray:
        """Numbers of the contacts whose force is a table of the compression."""
        return np.flatnonzero([len(rows) > 1 for rows in self.presses])

    def compressions(self, preload: Any) -> list[Any]:
        """Return the compression of each contact where nᵀq = 0, m; 0 where its force is no table.

        Args:
            preload: factor of all preloads, which may be an array or complex.
        """
        found: list[Any] = [0.0 * preload] * self.n_contacts
        for i in self.with_tables:
            starts, _, forces, slopes = self.presses[i].T
            force = self.preloads[i] * preload
            after = np.searchsorted(forces, np.real(force), side="right")
            piece = np.maximum(after - 1, 0)
            found[i] = starts[piece] + (force - forces[piece]) / slopes[piece]
        return found

    def lines(self, constants: np.ndarray, preload: Any) -> tuple[Any, Any]:
        """Return the stiffness of each contact in its regime, and its force where nᵀq = 0.

        Args:
            constants: of the regimes, (…, c, constants).
            preload: factor of all preloads, which may be complex.
        """
        shape = constants.shape[:-1]
        stiffness = np.broadcast_to(self.springs, shape).copy()
        force = np.broadcast_to(self.preloads * preload, shape).copy()
        at_rest = self.compressions(preload)
        for i in self.with_tables:
            start, _, c0, c1 = np.moveaxis(constants[..., i, FIRST_OF_PRESS:], -1, 0)
            stiffness[..., i], force[..., i] = c1, c0 + c1 * (at_rest[i] - start)
        return stiffness, force

    @property
    def curved(self) -> bool:
        """True if the friction of some contact depends on the sliding speed."""
        return bool((self.laws != friction_number.coulomb).any())

    @property
    def mobility(self) -> np.ndarray:
        """TᵀM⁻¹T, (c, c)."""
        return np.asarray(self.tangentials.T @ self.drags)


def diagonal_if_it_is(matrix: np.ndarray) -> np.ndarray:
    """Return the diagonal of a matrix that has nothing else, or the matrix."""
    diagonal = np.diag(matrix)
    return diagonal.copy() if (matrix == np.diag(diagonal)).all() else matrix


def full_matrix(matrix: np.ndarray) -> np.ndarray:
    """Return a matrix that may be given by its diagonal."""
    return np.diag(matrix) if matrix.ndim == 1 else matrix
