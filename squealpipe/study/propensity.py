"""Scatter of parameters, for pads and structures: how often which verdict, and what decides."""

from __future__ import annotations  # help shows Angle, not its checks

from collections.abc import Mapping
from typing import Any

import xarray as xr

from squealpipe.brake.propensity.propensity import propensity as propensity_of_pad
from squealpipe.structures.assess.propensity import structure_propensity
from squealpipe.study.subjects import is_structure, refuse_missing
from squealpipe.validation import (
    Angle,
    Number,
    Positive,
    Seed,
    Tolerance,
    Whole,
    Workers,
    checked,
)


@checked
def propensity(
    params: Any,
    alpha1: Angle | None = None,
    alpha2: Angle | None = None,
    *,
    distributions: Mapping[str, Any] | None = None,
    relative_std: Mapping[str, Any] | None = None,
    samples: Whole | None = None,
    t_end: Positive | None = None,
    spring_correlation: Number = 0.0,
    seed: Seed | None = None,
    tol: Tolerance = 1e-9,
    workers: Workers = None,
) -> xr.Dataset:
    """Estimate how often a brake of scattered parameters is noisy, and which parameter decides.

    Of a pad on two springs it is told how often flutter, contact loss, irregular hammering and
    whirl occur within ``t_end``; of a structure, how often a push of steady sliding ends quiet, in
    squeal or in hammering, each sample run until it has settled.

    Args:
        params: a pad (:class:`squealpipe.Parameters`, where they are not distributed), with both
            angles, or a :class:`squealpipe.Structure`, without.
        alpha1, alpha2: angles of a pad, rad; they may be distributed too.
        distributions: of a pad, name → {"distribution": "uniform", "low", "high"}, {"normal",
            "mean", "std"} (cut off at 4 std) or {"lognormal", "median", "log_std"}.
        relative_std: of a structure, name → standard deviation over the value, like ``{"mu": 0.1,
            "contact_stiffness_lining": 0.2}``: ``mu``, ``contact_stiffness``, ``preload``, each
            also with ``_`` and a face or contact behind, ``modal_damping`` and ``belt_speed``. Each
            is multiplied by an independent lognormal factor of mean 1.
        samples: size of the sample, a power of 2 of at least 64; needed for a pad, 256 for a
            structure. The indices take samples·(inputs + 2) runs, and of a pad 4 times as many
            points for flutter, which needs none.
        t_end: end of each run of a pad, s.
        spring_correlation: of k1 and k2 of a pad (Gaussian copula). Sobol indices assume
            independent inputs and are not given with it.
        seed: of the scrambled Sobol sequence; 1 for a pad, 0 for a structure.
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.

    Returns:
        Dataset ``propensity`` over quantity and input, of a structure ``structure_propensity`` over
        verdict and input: shares with 95 % intervals (of a structure and of rare cases Wilson's;
        else Student's t over 8 replicates) and first-order and total Sobol indices with theirs. An
        index is NaN, with outcome ``unresolved``, where its half-width is above 0.05 (of a
        structure 0.15) or fewer than 30 samples differ. Of a pad also the share of growing parts of
        the sample, and the half-width of the widest total by the size of the base sample.

    Raises:
        ValueError: an argument; a structure without steady sliding or contacts, or too large.
    """
    needed: dict[str, Any] = {
        "alpha1": alpha1,
        "alpha2": alpha2,
        "distributions": distributions,
        "t_end": t_end,
    }
    correlation = {"spring_correlation": spring_correlation or None}
    scatter: dict[str, Any] = {"relative_std": relative_std}
    if is_structure(params, of_pads=needed | correlation, of_structures=scatter):
        refuse_missing("propensity", "structure", scatter)
        spread = structure_propensity(
            params,
            **scatter,
            samples=256 if samples is None else samples,
            seed=0 if seed is None else seed,
            tol=tol,
            workers=workers,
        )
        spread.attrs["made_by"] = "squealpipe.propensity"
        return spread
    needed["samples"] = samples
    refuse_missing("propensity", "pad", needed)
    return propensity_of_pad(
        params,
        **needed,
        spring_correlation=spring_correlation,
        seed=1 if seed is None else seed,
        tol=tol,
        workers=workers,
    )
