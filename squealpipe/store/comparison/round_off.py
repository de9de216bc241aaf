"""Variables whose digits round-off decides: what of them two datasets must share."""

from dataclasses import replace

import numpy as np
import xarray as xr
from scipy.stats import ks_2samp

from squealpipe.schema import Outcome, Variable
from squealpipe.schema.agreement import ComparedAs, RoundOff
from squealpipe.store.comparison.differences import (
    SMALLEST_CHANCE,
    Agreement,
    VariableDifference,
    difference,
)

UNIT = 1e-14
"""Error over the size of a motion at which growth begins: fifty units of round-off."""


def judge(name: str, a: xr.Dataset, b: xr.Dataset, entry: Variable) -> VariableDifference:
    """Compare one variable of two aligned datasets, as its line in the schema says."""
    how = entry.round_off
    if how is None or how.compared in (ComparedAs.magnitude, ComparedAs.sample):
        return difference(name, a[name], b[name], entry)
    entry = replace(entry, round_off=None)
    stated = how.by in a.variables and how.by in b.variables
    if how.compared is ComparedAs.beyond_horizon and stated and a[name].dims == a[how.by].dims:
        return _beyond_horizon(name, a, b, entry, how)
    if how.compared is ComparedAs.grown and stated:
        size = max(
            (float(np.abs(side[name]).max()) for side in (a, b) if side[name].size), default=0.0
        )
        growth = max(float(a[how.by]), float(b[how.by]), 1.0)
        entry = replace(entry, atol=entry.atol + UNIT * growth * size)
    found = difference(name, a[name], b[name], entry)
    allowed = {ComparedAs.unjudged: 1.0, ComparedAs.most: how.share}.get(how.compared, 0.0)
    if found.verdict == Agreement.different and found.differing <= allowed * found.compared:
        return replace(found, verdict=Agreement.within_tolerance, reason=how.reason)
    return found


def _beyond_horizon(
    name: str, a: xr.Dataset, b: xr.Dataset, entry: Variable, how: RoundOff
) -> VariableDifference:
    """Cells that are predictable on both sides one by one, the others as one sample."""
    lost = sum(side[how.by].values == Outcome.beyond_horizon for side in (a, b)) > 0
    left, right = a[name].values, b[name].values
    found = difference(name, a[name], b[name].copy(data=np.where(lost, left, right)), entry)
    samples = [np.nan_to_num(side[lost].astype(float), nan=np.inf) for side in (left, right)]
    if np.array_equal(*samples):
        return found
    chance = float(ks_2samp(*samples, method="asymp").pvalue)
    verdict = Agreement.different if chance <= SMALLEST_CHANCE else Agreement.within_tolerance
    stated = (
        f"{int((samples[0] != samples[1]).sum())} of {lost.sum()} values beyond the predictability "
        f"horizon differ; chance that both are of one distribution {chance:.2g}"
    )
    return replace(
        found,
        verdict=max(found.verdict, verdict),
        compared_as=how.compared.value,
        reason="; ".join(filter(None, (found.reason, stated))),
    )
