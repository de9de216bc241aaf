"""One run in a few numbers: separation, impacts, forces, dominant frequencies."""

import math
from collections.abc import Iterator

import numpy as np
import xarray as xr

from squealpipe.brake.schema.dynamics.extremes import extremes, largest_size
from squealpipe.brake.schema.dynamics.intervals import intervals
from squealpipe.brake.schema.dynamics.runs import run_summary_schema
from squealpipe.codes import Event, Regime
from squealpipe.schema import build
from squealpipe.schema.origin import recorded
from squealpipe.systems.inputs.units import engineering
from squealpipe.vibration.sizes import is_real
from squealpipe.vibration.spectrum import (
    FEWEST,
    amplitude_spectrum,
    lasts,
    step_of,
    strongest_lines,
)


@recorded()
def summarize(run: xr.Dataset) -> xr.Dataset:
    """Summarize a run that was sampled uniformly from its start.

    Times of events and extremes are exact; the spectrum comes from the samples.

    Args:
        run: dataset ``simulation``.

    Returns:
        Dataset ``run_summary``; a force that ends for good has no dominant frequency.

    Raises:
        ValueError: fewer than ``FEWEST`` samples were reached, or they are not uniform.
    """
    time = run.time.values[np.isfinite(run.x.values)]
    if time.size < FEWEST:
        raise ValueError(
            f"the run ended after {time.size} samples; ask for more samples or a longer run"
        )
    step = step_of(time)
    end = float(run.time_reached)
    apart, stuck = (intervals(run, each) for each in (Regime.separated, Regime.stick))
    returns = np.count_nonzero(run.event_kind.values == Event.contact)
    force = run.normalized_contact_force.values[: time.size]
    _, highest = extremes(run, "normalized_contact_force")
    # the spectrum's grid is eight times finer than the resolution of the run
    padding = 8
    frequency, amplitude = amplitude_spectrum(force, step, padding=padding)
    # three dominant frequencies are named
    kept = 3 if lasts(force) else 0
    peak_frequency, peak_amplitude = strongest_lines(
        frequency, amplitude, kept, padding * float(frequency[1])
    )
    return build(
        run_summary_schema,
        {
            "first_separation_time": apart[0, 0] if len(apart) else np.nan,
            "impact_rate": returns / end,
            "separated_fraction": np.diff(apart).sum() / end,
            "stick_fraction": np.diff(stuck).sum() / end,
            "peak_contact_force": np.fmax(
                highest[: time.size].max(), run.return_peak_contact_force
            ),
            "return_peak_contact_force": float(run.return_peak_contact_force),
            "impact_speed": float(run.impact_speed),
            "largest_x": largest_size(run, "x")[: time.size].max(),
            "largest_y": largest_size(run, "y")[: time.size].max(),
            "force_spectrum": amplitude,
            "dominant_frequency": peak_frequency,
            "dominant_amplitude": peak_amplitude,
            "outcome": int(run.outcome),
        },
        {"frequency": frequency, "peak": np.arange(1, peak_frequency.size + 1)},
    )


def summary_lines(run: xr.Dataset, summary: xr.Dataset) -> Iterator[str]:
    """The summary for people, one line per finding; a real brake's in mm, ms and Hz, too."""
    real = is_real(run)

    def shown(value: float, units: str) -> str:
        return engineering(value, units, 5) if real else f"{value:.5g} {units}"

    first = float(summary.first_separation_time)
    yield f"regime             {_regime(summary)}"
    yield "first separation   " + (
        (f"t = {shown(first, 's')}" if real else f"t = {first:.6g} s")
        if np.isfinite(first)
        else f"none until t = {float(run.time_reached):g} s"
    )
    yield f"impacts            {float(summary.impact_rate):.4g} per second"
    yield f"peak contact force {float(summary.peak_contact_force):.5g} k3 l_pre"
    if not np.isnan(summary.impact_speed):
        yield (
            f"after a return     {float(summary.return_peak_contact_force):.5g} k3 l_pre, "
            f"at impacts of up to {float(summary.impact_speed):.4g} m/s"
        )
    yield (
        f"largest motion     |x| = {shown(float(summary.largest_x), 'm')}, "
        f"|y| = {shown(float(summary.largest_y), 'm')}"
    )
    lines = summary.dominant_frequency.values
    peaks = ", ".join(f"{value:.4g}" for value in lines)
    hertz = ", ".join(engineering(value / math.tau, "Hz", 4) for value in lines)
    beside = f" ({hertz})" if real else ""
    none = "no oscillation of the contact force"
    yield f"dominant           {f'ω = {peaks} rad/s{beside}' if peaks else none}"


def _regime(summary: xr.Dataset) -> str:
    apart, stuck = float(summary.separated_fraction), float(summary.stick_fraction)
    parts = []
    if apart:
        parts.append(f"separated {apart:.1%} of the time")
    if stuck:
        parts.append(f"stuck to the belt {stuck:.1%}")
    return "; ".join(parts) if parts else "contact is kept, sliding throughout"
