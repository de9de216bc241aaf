"""How the runs of a sweep ended, and where its NaN come from, in a few lines."""

from __future__ import annotations

import numpy as np
import xarray as xr

from squealpipe.schema import ABSENT, REMEDIES, Outcome, meanings

MOST_NAMES = 4
"""Variables that a line names."""


def lines(dataset: xr.Dataset, names: list[str]) -> list[str]:
    """Outcomes counted, then for each outcome with NaN: where it is, what is missing, the remedy.

    Nothing of a task that always has an answer, and so no outcome.

    Args:
        dataset: result of a sweep.
        names: its swept names.
    """
    if "outcome" not in dataset:
        return []
    outcome = dataset.outcome
    words = meanings(outcome)
    present = outcome.values[outcome.values != ABSENT]
    values, counts = np.unique(present, return_counts=True)
    order = np.argsort(-counts)
    stated = [f"{words[int(values[k])]} {counts[k]}" for k in order]
    unit = "runs" if outcome.ndim == len(names) else "points"
    text = [f"outcome of {present.size} {unit}: {', '.join(stated)}"]
    missing = _missing(dataset, outcome)
    remedies = {int(item): remedy for item, remedy in REMEDIES.items()}
    for value in values[order]:
        if value == Outcome.converged:  # such as the time of an event that never came
            continue
        lost = [name for name, nan in missing.items() if (nan & (outcome.values == value)).any()]
        if not lost:
            continue
        more = f" and {len(lost) - MOST_NAMES} more" if len(lost) > MOST_NAMES else ""
        text.append(
            f"NaN in {', '.join(lost[:MOST_NAMES])}{more} where the outcome is "
            f"{words[int(value)]}{_where(dataset, outcome == value, names)}: "
            f"{remedies.get(int(value), 'a stop of the system')}"
        )
    return text


def _missing(dataset: xr.Dataset, outcome: xr.DataArray) -> dict[str, np.ndarray]:
    """Variable → where it holds NaN, over the dimensions of the outcome.

    What a run does not have at all (a time beyond its end) needs no word.
    """
    found = {}
    for name, variable in dataset.data_vars.items():
        if variable.dtype.kind == "f" and set(variable.dims) == set(outcome.dims):
            nan = np.isnan(variable.transpose(*outcome.dims).values)
            if nan.any():
                found[str(name)] = nan
    return found


def _where(dataset: xr.Dataset, chosen: xr.DataArray, names: list[str]) -> str:
    """The swept values to which a set of runs is confined, or nothing if it is everywhere."""
    confined = []
    for name in names:
        others = [dim for dim in chosen.dims if dim != name]
        hit = chosen.any(others).values
        if hit.all():
            continue
        values = dataset[name].values[hit]
        span = f"{values.min():.6g} … {values.max():.6g}" if values.size > 1 else f"{values[0]:.6g}"
        confined.append(f"{name} = {span}")
    return f" ({', '.join(confined)})" if confined else ""
