"""Computations of a structure's study: complex modes over friction, and which of them squeal."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.store.mistakes import ConfigError
from squealpipe.structures.assess.assess import LongRuns, small_motions_alone
from squealpipe.structures.assess.modifications import (
    counted_from_zero,
    read_modification,
)
from squealpipe.structures.assess.operating_points import OperatingPoints
from squealpipe.structures.contact import face_of
from squealpipe.structures.fewer_points import fewer_points
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.reduction import band_needed
from squealpipe.structures.schema.squealing import SquealLimits
from squealpipe.structures.squeal.plant import band_of, in_modes
from squealpipe.structures.squeal.settled_run import (
    moving_attractors,
    resting_run,
    squealing_run,
)
from squealpipe.structures.squeal.squealing_modes import squealing_modes
from squealpipe.structures.structure import Structure
from squealpipe.structures.varied_friction import VariedFriction
from squealpipe.study.assess import assess
from squealpipe.study.operating_sweep import TASK as OPERATING_MAP
from squealpipe.study.operating_sweep import OperatingSweep


def read_structure(section: Mapping[str, Any]) -> Structure:
    """The structure of a section ``structure``.

    Raises:
        FileNotFoundError: a file is missing.
        ValueError: a file or a key that is wrong, or one that a large structure needs.
    """
    file = section["file"]
    try:
        # friction of a single face is varied as that of the structure
        structure = Structure.read(file).with_common_mu()
    except ConfigError as error:  # each of its mistakes names the file
        raise ValueError("; ".join(error.mistakes)) from error
    except (ValueError, FileNotFoundError) as error:
        told = str(error)
        if not told.startswith(file):  # some name the file, others only its key
            told = f"{file}: {told}"
        missing = isinstance(error, FileNotFoundError)
        raise (FileNotFoundError if missing else ValueError)(told) from error
    if structure.size > DENSE and section["frequency_max"] is None:
        raise ValueError(
            f"structure: {structure.size} degrees of freedom: "
            f"{band_needed(structure, section['n_modes'])}"
        )
    if not structure.contacts:
        raise ValueError(f"structure.file: {file} names no contacts: nothing rubs")
    return structure


def modifications(structure: Structure, section: Mapping[str, Any]) -> dict[str, Any]:
    """Return the modifications of a section, which are tried as cures.

    Raises:
        ValueError: one that the structure cannot have.
    """
    named = counted_from_zero(section)
    for name, content in named.items():
        # any frequency will do
        read_modification(name, content, structure, 1.0, first=1)
    return named


def operating_options(
    structure: Structure, section: Mapping[str, Any], operating: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the options of the operating map of a study, with those of the reduction.

    Raises:
        FileNotFoundError: a list or table is missing.
        ValueError: a key of the section that is wrong.
    """
    asked = {name: value for name, value in operating.items() if value is not None}
    try:
        OperatingPoints.of(structure, **asked)
    except ValueError as error:
        raise ValueError(f"operating: {error}") from error
    band = band_of(structure, section["frequency_max"])
    return asked | {"n_modes": section["n_modes"], "frequency_max": band}


def operating_sweep(
    section: Mapping[str, Any], operating: Mapping[str, Any]
) -> OperatingSweep:
    """Return the operating points of a study as a sweep."""
    options = operating_options(read_structure(section), section, operating)
    return OperatingSweep(
        task=f"{section['file']}:{OPERATING_MAP}", vary={}, fixed=options
    )


def modes_over_friction(structure: Structure, section: Mapping[str, Any]) -> xr.Dataset:
    """Complex modes of the whole structure, from no friction to twice its own.

    Where contacts have different frictions of their own, that of what is pressed most is varied.
    """
    # frictions by the degrees of freedom that are solved for each; odd numbers, so that the
    # structure's own friction is one of them
    points = next(
        (
            n
            for size, n in ((SquealLimits.most_modes, 41), (DENSE, 13))
            if structure.size <= size
        ),
        5,
    )
    # up to twice the structure's friction: where modes turn unstable is seen from both sides
    name = _most_pressed(structure) if structure.has_own_mu.all() else None
    own = structure.mu
    if name is not None:
        own = VariedFriction.named(structure, name).now(structure)
    frictions = np.linspace(0.0, 2.0 * own or 1.0, points)
    allowed = frictions[frictions <= structure.largest_mu]
    return structure.complex_modes(
        mu=allowed if name is None else {name: frictions},
        frequency_max=band_of(structure, section["frequency_max"]),
    )


def modes_with_fewer_points(
    structure: Structure, section: Mapping[str, Any]
) -> xr.Dataset:
    """Return the unstable modes of the whole structure by the number of points of each face."""
    return fewer_points(
        structure, frequency_max=band_of(structure, section["frequency_max"])
    )


def _most_pressed(structure: Structure) -> str:
    """Return the face with one friction, or else the contact, that has the largest preload."""
    preloads: dict[str, float] = {}
    frictions: dict[str, set[float]] = {}
    for contact, mu in zip(structure.contacts, structure.mu_of_contacts, strict=True):
        for name in {contact.name, face_of(contact.name) or contact.name}:
            preloads[name] = preloads.get(name, 0.0) + contact.preload
            frictions.setdefault(name, set()).add(float(mu))
    same = [name for name, values in frictions.items() if len(values) == 1]
    return max(same, key=lambda name: preloads[name])


def squealing(
    structure: Structure, section: Mapping[str, Any], workers: int
) -> xr.Dataset:
    """Return the unstable modes that squeal, of the structure reduced as its section says.

    Where runs are long, what squeals is not followed down in friction, which doubles their time.
    """
    reduced = reduced_structure(structure, section)
    return squealing_modes(
        reduced,
        **{name: section[name] for name in ("samples", "seed", "t_end")},
        onset=not structure.has_own_mu.all() and not LongRuns.has(reduced),
        workers=workers,
    )


def answered(
    structure: Structure,
    section: Mapping[str, Any],
    squeal: xr.Dataset,
    changes: Mapping[str, Any],
    workers: int,
) -> xr.Dataset:
    """Return verdict, level and what stops the noise; what eigenvalues tell if nothing is run.

    Args:
        squeal: which modes squeal.
        changes: section ``modifications``.
    """
    reduced = reduced_structure(structure, section)
    if squeal.attrs.get("not_run"):
        return small_motions_alone(reduced)
    return assess(
        reduced,
        modifications=modifications(structure, changes),
        samples=min(section["samples"], 16),  # each value that is tried has as many
        seed=section["seed"],
        workers=workers,
    )


def reduced_structure(structure: Structure, section: Mapping[str, Any]) -> Any:
    """Return the structure in the modes in which it is run."""
    return in_modes(
        structure, section["n_modes"], band_of(structure, section["frequency_max"])
    )


def settled_motion(
    structure: Structure, section: Mapping[str, Any], answer: xr.Dataset
) -> xr.Dataset:
    """Return the motion that a small push ends in over time, of no instants where it dies out."""
    reduced = reduced_structure(structure, section)
    if not moving_attractors(answer).size:
        return resting_run(reduced)
    return squealing_run(reduced, answer)
