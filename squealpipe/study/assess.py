"""One question for pads and structures: does it squeal, how loud, why, and what stops it."""

from __future__ import annotations  # help shows Angle, not its checks

from collections.abc import Mapping
from typing import Any

import xarray as xr

from squealpipe.brake.assess.assess import assess as assess_pad
from squealpipe.structures.assess.assess import assess_structure
from squealpipe.study.subjects import is_structure, refuse_missing
from squealpipe.validation import Angle, Natural, Seed, Tolerance, Workers, checked


@checked
def assess(
    params: Any,
    alpha1: Angle | None = None,
    alpha2: Angle | None = None,
    *,
    modifications: Mapping[str, Any] | None = None,
    samples: Natural = 16,
    seed: Seed = 0,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Tell whether a brake squeals or hammers, at what frequency, how loud, why, and what stops it.

    The answer covers two starts: steady sliding, pushed by 1 % of the static deformation in the
    direction in which small motions grow fastest, and (prefix ``sudden_``) rest under the whole
    load at once. Each is run until its motion has settled, at most 20,000 periods (of a pad
    2π √(2m/(k1 + k2)), of a structure those of the slowest mode that grows). The ``verdict`` is
    that of the first: quiet (dies out; undamped: stays below ten times the push), squeals (lasts,
    contact kept), hammers (lasts, contact lost again and again), or undetermined. Of a pad without
    steady sliding it is that of the sudden start.

    Args:
        params: a pad on two springs (:class:`squealpipe.Parameters`), with both angles; or a
            :class:`squealpipe.Structure`, without. A structure of more than 32 degrees of freedom
            is run in the fewest modes that answer (see ``Structure.reduce``).
        alpha1: angle of spring 1, counted from +x, the direction of the belt, rad.
        alpha2: angle of spring 2, counted from −x, rad.
        modifications: of a structure, name → what is tried as a cure beside mu, contact_stiffness,
            preload, modal_damping and belt_speed: ``{"weight": {"added_mass": {1: 0.1}}}`` adds up
            to 0.1 kg at a degree of freedom, ``spring`` and ``dashpot`` join two, like ``{(0, 4):
            1e6}``, or one to the ground. An integer counts degrees of freedom from 0; of a
            structure with a mesh ``"5005"`` is a node in all directions and ``"5005.3"`` one of
            them. The largest amount is that of the first entry, others go along in proportion.
            ``{"patch": {"nodes": "BACK", "mass": 0.2, "damping_ratio": 0.05}}`` is a shim on a node
            set, a face or a list of node numbers, with a mass, a damping ratio or both: its mass is
            shared equally, and it damps the deformation of its nodes, with this ratio at the
            frequency of the mode that grows fastest. ``{"chamfer": {"face": "lining", "share":
            0.2}}`` removes up to that share of a face's points from the end that meets the belt
            first; the others carry the whole force.
        samples: random starts of a structure, for other motions beside steady sliding.
        seed: seed of the random starts.
        tol: tolerance of the Taylor integrator.
        workers: processes for a structure's runs; None takes all cores.

    Returns:
        Dataset ``assess``: scalars of both starts, spectrum and path of the settled motion of the
        verdict, and over ``cure``, by ascending change: the nearest value from which it is quiet
        (of a quiet one, up to which it is), from steady sliding and from any start that was tried:
        both above, strikes or random starts, and the motions of the present value, followed. NaN:
        none between ``lowest_tried`` and ``highest_tried``. ``quiet_low`` and ``quiet_high`` over
        ``interval``: all intervals that are quiet after a push, the nearest first. Of several
        contacts velocities along and across the belt are root mean squares over all, other scalars
        those of the contact that has most; ``contact_velocity_rms`` and others tell each.
        Outcomes: converged, unresolved (undetermined), no_sliding_state.

    Raises:
        ValueError: an argument; a structure without steady sliding or contacts, or too large.
    """
    angles: dict[str, Any] = {"alpha1": alpha1, "alpha2": alpha2}
    if is_structure(
        params, of_pads=angles, of_structures={"modifications": modifications}
    ):
        answer = assess_structure(
            params,
            modifications=modifications,
            samples=samples,
            seed=seed,
            tol=tol,
            workers=workers,
        )
        answer.attrs["made_by"] = "squealpipe.assess"
        return answer
    refuse_missing("assess", "pad", angles)
    return assess_pad(params, **angles, tol=tol)
