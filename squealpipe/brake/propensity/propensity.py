"""Estimate propensities over distributed parameters, and Sobol indices of what they depend on.

Idea: samples are scrambled Sobol sequences, in several independent replicates, so that the scatter
between replicates states the error. The events are flutter, by the linear model, and what runs of
A1 show: contact loss, irregular hammering, the whirl. First and total indices use Saltelli's
matrices: two samples, and one more for each input. Source: Saltelli et al., Comput. Phys. Commun.
181 (2010) 259-270. Invariant: an index that the sample cannot support is NaN, as are all where the
springs are correlated. Cost: (3 + inputs) runs for each of the ``samples``, one without indices;
flutter needs none, and its indices have a larger sample.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import SimpleNamespace
from typing import Annotated, Any

import numpy as np
import scipy
import xarray as xr
from annotated_types import Ge, Interval, MinLen

from squealpipe.brake.a1.ensemble import LARGEST_REACH, run_ensemble
from squealpipe.brake.dynamics.motion import as_judged, classify_motion, whirls
from squealpipe.brake.models import a3
from squealpipe.brake.models.contact_system import contact_system, with_drag
from squealpipe.brake.models.damped import damped_system, is_undamped, regime
from squealpipe.brake.models.refusals import refuse_unread
from squealpipe.brake.propensity.distributions import check_stick, distribution
from squealpipe.brake.schema.dynamics.runs import MotionFlag
from squealpipe.brake.schema.propensity import propensity_schema
from squealpipe.codes import LinearRegime
from squealpipe.inputs import ANGLES
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.parameters import DEFAULTS, Parameters
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.systems.progress import with_progress
from squealpipe.validation import (
    Angle,
    Number,
    Positive,
    Seed,
    Tolerance,
    Whole,
    Workers,
)
from squealpipe.vibration import sobol


@recorded(model="A1, A3", method="quasi-random sample; Sobol indices from replicates")
def propensity(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    distributions: Annotated[Mapping[str, Any], MinLen(1)],
    samples: Annotated[Whole, Ge(64)],
    t_end: Positive,
    spring_correlation: Annotated[Number, Interval(gt=-1, lt=1)] = 0.0,
    seed: Seed = 1,
    tol: Tolerance = 1e-9,
    workers: Workers = None,
) -> xr.Dataset:
    """Estimate how often each event occurs, and why: see :func:`squealpipe.propensity`."""
    if samples & (samples - 1):
        raise ValueError(
            f"samples = {samples!r}: a power of 2 of at least 64 is needed"
        )
    frozen = {name: distribution(name, given) for name, given in distributions.items()}
    for name in sorted(set(frozen) & set(params.in_laws)):
        raise ValueError(
            f"distributions: a law's file stands for {name}, which cannot be spread"
        )
    refuse_unread(params, list(frozen))
    check_stick(params, frozen)
    names = list(frozen)
    if spring_correlation and not {"k1", "k2"} <= set(names):
        raise ValueError(
            "spring_correlation: distributions of k1 and k2 are needed for it"
        )
    fixed = {**params.as_dict(), "alpha1": alpha1, "alpha2": alpha2}
    turns = with_progress(range(1 if spring_correlation else len(names) + 3))

    def judge(values: np.ndarray, *, runs: bool = True) -> np.ndarray:
        size = values.shape[-1]
        fields: dict[str, Any] = {**fixed, **dict(zip(names, values, strict=True))}
        first, second = (np.broadcast_to(fields.pop(name), size) for name in ANGLES)
        flutters = _flutters(fields, first, second)[None]
        if not runs:
            return flutters
        next(turns)
        events = _events(fields, first, second, t_end, tol, workers)
        return np.concatenate([flutters, events])

    points = sobol.scrambled(len(names), samples, seed)
    if spring_correlation:
        points = _correlate(
            points, names.index("k1"), names.index("k2"), spring_correlation
        )
    values = np.array([frozen[name].ppf(points[:, i]) for i, name in enumerate(names)])
    happens = judge(values)
    low, high = np.transpose([sobol.share_interval(each) for each in happens])
    # the estimate is shown for so many growing parts of the sample, so that its convergence is
    # seen
    n_sample_sizes = 6
    sizes = samples >> np.arange(n_sample_sizes)[::-1]
    # base sample of the indices of each quantity, over that of the shares: flutter needs no run
    index_samples = np.array([[4], [1], [1], [1]]) * sizes
    propensities = ("flutter", "contact_loss", "irregular_hammering", "whirl")
    blank = dict.fromkeys(
        sobol.INDICES, np.full((len(propensities), len(names)), np.nan)
    )
    table = blank | {
        "half_width_by_size": np.full((len(propensities), n_sample_sizes), np.nan)
    }
    if not spring_correlation:
        linear = sobol.judged_matrices(
            partial(judge, runs=False), frozen, index_samples[0, -1], seed + 1
        )
        by_run = sobol.judged_matrices(judge, frozen, index_samples[1, -1], seed + 1)
        table |= sobol.supported_indices(
            [linear[:, 0], *np.moveaxis(by_run[:, 1:], 1, 0)], n_sample_sizes
        )
    supported = np.isfinite(table["total_order"]).all(axis=1)
    return build(
        propensity_schema,
        {
            "share": happens.mean(axis=1),
            "share_low": low,
            "share_high": high,
            "share_by_size": np.stack(
                [happens[:, :size].mean(axis=1) for size in sizes], axis=1
            ),
            **table,
            "index_samples": index_samples,
            "judged": samples,
            "outcome": np.where(supported, Outcome.converged, Outcome.unresolved),
            "alpha1": alpha1,
            "alpha2": alpha2,
            "t_end": t_end,
        },
        {"quantity": list(propensities), "input": names, "size": sizes},
        {"spring_correlation": spring_correlation},
    )


def _correlate(
    points: np.ndarray, first: int, second: int, correlation: float
) -> np.ndarray:
    """Return a uniform sample, (size, inputs), with two columns joined by a Gaussian copula."""
    normal = scipy.stats.norm.ppf(points[:, [first, second]])
    mixed = correlation * normal[:, 0] + np.sqrt(1.0 - correlation**2) * normal[:, 1]
    joined = points.copy()
    joined[:, second] = scipy.stats.norm.cdf(mixed)
    return joined


def _events(
    fields: Mapping[str, Any],
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    t_end: float,
    tol: float,
    workers: int | None,
) -> np.ndarray:
    """Return whether contact loss, irregular hammering and the whirl occur, (3, size).

    What keeps contact does not hammer, so no perturbation is followed along it.
    """
    run = partial(
        run_ensemble, tol=tol, tracked=(LARGEST_REACH,), workers=workers, t_end=t_end
    )
    kept = run(fields, alpha1, alpha2, stop_at_first_separation=True)
    rows = np.flatnonzero((kept.outcome != Outcome.converged) | whirls(kept))
    some = {
        name: value[rows] if isinstance(value, np.ndarray) else value
        for name, value in fields.items()
    }
    judged = run(some, alpha1[rows], alpha2[rows], **as_judged(t_end))
    motion, _ = classify_motion(judged, SimpleNamespace(**some))
    events = np.zeros((3, alpha1.size), bool)
    events[:, rows] = (
        np.isfinite(judged.first_separation_time),
        motion == MotionFlag.irregular_hammering,
        motion == MotionFlag.whirl,
    )
    return events


def _flutters(
    fields: Mapping[str, Any], alpha1: np.ndarray, alpha2: np.ndarray
) -> np.ndarray:
    p = with_drag(DEFAULTS | dict(fields))
    if p.contact_law == LINEAR and np.all(is_undamped(p)):
        regimes = a3.regime(contact_system(p, alpha1, alpha2).invariants)
    else:
        regimes = regime(damped_system(p, alpha1, alpha2))
    return np.asarray(regimes == LinearRegime.flutter)
