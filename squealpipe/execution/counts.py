"""How the runs of a sweep ended, in a few lines."""

import numpy as np
import xarray as xr

from squealpipe.schema import ABSENT, REMEDIES, Outcome, meanings


def lines(dataset: xr.Dataset, names: list[str]) -> list[str]:
    """Outcomes counted, then the remedy of each that is not converged.

    Nothing of a task that always has an answer, and so no outcome.
    """
    if "outcome" not in dataset:
        return []
    words = meanings(dataset.outcome)
    present = dataset.outcome.values[dataset.outcome.values != ABSENT]
    values, counts = np.unique(present, return_counts=True)
    order = np.argsort(-counts)
    stated = [f"{words[int(values[k])]} {counts[k]}" for k in order]
    unit = "runs" if dataset.outcome.ndim == len(names) else "points"
    remedies = {int(item): remedy for item, remedy in REMEDIES.items()}
    return [
        f"outcome of {present.size} {unit}: {', '.join(stated)}",
        *(
            f"{words[int(value)]}: {remedies.get(int(value), 'a stop of the system')}"
            for value in values[order]
            if value != Outcome.converged
        ),
    ]
