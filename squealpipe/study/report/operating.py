"""Say what a map of operating points tells."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.text import percent
from squealpipe.units import engineering


def lines(dataset: xr.Dataset) -> Iterator[str]:
    """Yield how many points are noisy, the loudest of them, and how often each band is heard."""
    verdicts = dataset.verdict.values
    noisy = np.isin(verdicts, (Verdict.squeals, Verdict.hammers))
    total = verdicts.size
    if not noisy.any():
        yield f"Quiet at all {total} operating points that were settled."
    else:
        hammers = int((verdicts == Verdict.hammers).sum())
        yield (
            f"Noisy at {int(noisy.sum())} of {total} operating points "
            f"({percent(float(noisy.mean()))}); at {hammers} of them contact is lost again and "
            "again."
        )
        level = np.where(noisy, dataset.velocity_rms.values, -np.inf)
        place = np.unravel_index(int(level.argmax()), level.shape)
        point = dataset.isel(dict(zip(dataset.verdict.dims, place, strict=True)))
        yield (
            f"Loudest: {engineering(float(point.velocity_rms), 'm s-1')} rms at "
            f"{engineering(float(point.frequency), 'Hz')}, at {float(point.pressure):.3g} times "
            f"the preload, speed {float(point.speed):.3g}, friction {float(point.mu):.3g}."
        )
        for band, share in zip(
            dataset.band.values, dataset.occurrence.values, strict=True
        ):
            if share > 0:
                yield f"  third octave at {engineering(float(band), 'Hz')}: {percent(float(share))}"
    if "hits" in dataset:
        yield (
            f"Measured: {int(dataset.hits)} noises predicted within "
            f"{percent(float(dataset.frequency_band))} of their frequency, {int(dataset.misses)} "
            f"not; {int(dataset.false_alarms)} false alarms, {int(dataset.quiet_agreed)} points "
            "quiet in both."
        )
    unknown = int((verdicts == Verdict.undetermined).sum())
    if unknown:
        yield f"Undetermined at {unknown} points: not settled in time, or no steady sliding."
