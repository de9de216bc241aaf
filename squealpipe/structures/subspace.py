"""A large structure in a subspace in which it is followed along friction.

The subspace holds the lowest modes at rest, the modes of the whole at the frictions asked for, from
the right and from the left, and what the load and forces at the contacts do statically. So steady
sliding, with all that opens and closes, is that of the whole at every friction, and modes are at
those frictions; in between they are near.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg as la

from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.modes import modes_at_rest
from squealpipe.structures.pencil import LowRank
from squealpipe.structures.sliding import static_answers
from squealpipe.structures.spectrum import Spectrum
from squealpipe.structures.speed_terms import SpeedTerms


def in_coordinates(
    whole: ContactStructure,
    stiffness: np.ndarray,
    damping: np.ndarray,
    directions: tuple[np.ndarray, np.ndarray, np.ndarray],
    load: np.ndarray | None,
    speed_terms: SpeedTerms,
) -> ContactStructure:
    """A structure in coordinates of which the mass is 1.

    Args:
        stiffness, damping: there, without speed terms.
        directions: normal, tangential and transversal ones there, (m, contacts) each.
        load: there; None balances the preload.
        speed_terms: there.
    """
    normals, tangentials, transversals = directions
    contacts = [
        replace(
            contact,
            normal=normals[:, index],
            tangential=tangentials[:, index],
            across=transversals[:, index] if contact.transverse_damping else None,
        )
        for index, contact in enumerate(whole.contacts)
    ]
    return type(whole)(
        **{
            **whole.arguments,
            "mass": np.eye(len(stiffness)),
            "stiffness": stiffness,
            "damping": damping,
            "modal_damping": 0.0,
            "contacts": contacts,
            "load": load,
            "speed_terms": speed_terms,
            "mesh": None,
            "names": None,
        }
    )


def subspace(
    whole: ContactStructure, spectra: Sequence[Spectrum], number: int
) -> np.ndarray:
    """A basis V (n, m) with VᵀMV = 1 in which the stiffness at rest is diagonal.

    Args:
        spectra: of the whole.
        number: of modes at rest.
    """
    basis = modes_at_rest(whole, number)[1]
    pairs = [pair for each in spectra for pair in each.pairs]
    of_modes = [
        part
        for pair in pairs
        for vector in (pair.right, pair.left)
        for part in (vector.real, vector.imag)
    ]
    groups = [np.array(of_modes).reshape(-1, whole.size).T, static_answers(whole)]
    for group in groups:
        basis = np.hstack([basis, added(whole, basis, group)])
    at_rest = basis.T @ (whole.stiffness_at_rest @ basis)
    return np.asarray(basis @ la.eigh(0.5 * (at_rest + at_rest.T))[1])


def with_answers(
    whole: ContactStructure, basis: np.ndarray, forces: np.ndarray
) -> np.ndarray:
    """Return a basis with what forces (n, k) do statically added to it, with VᵀMV = 1."""
    return np.hstack([basis, added(whole, basis, static_answers(whole, forces))])


def added(
    whole: ContactStructure, basis: np.ndarray, vectors: np.ndarray
) -> np.ndarray:
    """Return the part of vectors beyond a basis, orthonormal by mass to it and among themselves."""
    # twice, since the first time leaves round-off of what was taken away
    # Share of a vector's square that others leave of it, below which it adds nothing
    dependent_square = 1e-12
    for _ in range(2):
        sizes = np.sqrt(np.einsum("ij,ij->j", vectors, whole.mass @ vectors))
        vectors = vectors[:, sizes > 0] / sizes[sizes > 0]
        vectors = vectors - basis @ (basis.T @ (whole.mass @ vectors))
        squares, turns = la.eigh(vectors.T @ (whole.mass @ vectors))
        kept = squares > dependent_square
        vectors = (vectors @ turns[:, kept]) / np.sqrt(squares[kept])
    return np.asarray(vectors)


def projected(
    whole: ContactStructure, modal: LowRank | None, basis: np.ndarray
) -> ContactStructure:
    """The structure in a subspace.

    Args:
        modal: damping of single modes of the whole.
    """
    at_rest = basis.T @ (whole.stiffness_at_rest @ basis)
    stiffness = basis.T @ (whole.given_stiffness @ basis)
    # round-off would couple the modes at rest
    own = np.sqrt(np.abs(np.diag(at_rest)))
    round_off = 1e-9 * np.outer(own, own) + 1e-14 * own.max() ** 2
    is_other = ~np.eye(len(own), dtype=bool)
    stiffness -= np.where(is_other & (np.abs(at_rest) < round_off), at_rest, 0.0)
    damping = basis.T @ (whole.given_damping @ basis)
    if modal is not None:
        columns = basis.T @ modal.columns
        damping = damping + (columns * modal.weights) @ columns.T
    normals, tangentials, transversals = (
        basis.T @ each
        for each in (whole.normals, whole.tangentials, whole.transversals)
    )
    return in_coordinates(
        whole,
        stiffness,
        damping,
        (normals, tangentials, transversals),
        None if whole.given_load is None else basis.T @ whole.load,
        whole.speed_terms.mapped(lambda each: basis.T @ (each @ basis)),
    )
