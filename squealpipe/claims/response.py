"""Statements on the time histories of model A1 (Figs. 2–5)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from squealpipe.claims.backbones import branch
from squealpipe.claims.evidence import Finding, MissingDataError, Run, finding
from squealpipe.claims.maps import cell, share
from squealpipe.schema.claims import Verdict

ROUND_OFF = 1e-10
"""Difference of normalized contact forces that two identical runs may show."""

LITTLE = 0.1
"""Difference of extremes, in preloads, that a reader of the paper's Fig. 2 would call minimal."""

SAME_TREND = 0.1
"""Relative difference of frequencies up to which two descriptions show the same trend."""

SATURATED = 1.02
"""Ratio of the late to the earlier size of a whirl below which it has stopped growing."""

GROWTH = 2.0
"""Ratio of late to early amplitude from which a response is called growing."""


def scene(run: Run, name: str) -> xr.Dataset:
    """The A1 motion of a scene of the paper."""
    return run[f"simulate/{name}"]


def events(motion: xr.Dataset, kind: str) -> np.ndarray:
    """Times of the events of a kind, in the run's unit of time."""
    meanings = motion.event_kind.attrs["flag_meanings"].split()
    value = motion.event_kind.attrs["flag_values"][meanings.index(kind)]
    return np.asarray(motion.event_time.values[motion.event_kind.values == value])


def contact_is_kept(name: str) -> Callable[[Run], Finding]:
    """F2a–F2c: the lowest contact force of the run, and no separation event."""

    def check(run: Run) -> Finding:
        motion = scene(run, name)
        lowest = float(motion.normalized_contact_force.min())
        lost = events(motion, "separation").size
        return finding(
            lowest,
            ">",
            0,
            f"The lowest contact force is {lowest:.4g} of the preload; {lost} separations up to "
            f"t = {float(motion.time[-1]):g}.",
            also=lost == 0,
        )

    return check


def contact_is_lost(name: str) -> Callable[[Run], Finding]:
    """F2d: number of separations."""

    def check(run: Run) -> Finding:
        motion = scene(run, name)
        lost = events(motion, "separation")
        if not lost.size:
            return finding(0, ">", 0, "Contact is never lost.")
        return finding(
            lost.size,
            ">",
            0,
            f"{lost.size} separations up to t = {float(motion.time[-1]):g}, the first at "
            f"{lost[0]:.4g}; the contact force then peaks at "
            f"{float(motion.normalized_contact_force.max()):.3g} of the preload.",
        )

    return check


def responses_differ_little(run: Run) -> Finding:
    """F2e: extremes of the contact force of the three scenes that keep contact."""
    motions = [scene(run, name).normalized_contact_force for name in ("F2a", "F2b", "F2c")]
    lowest = [float(force.min()) for force in motions]
    highest = [float(force.max()) for force in motions]
    spread = max(np.ptp(lowest), np.ptp(highest))
    return finding(
        spread,
        "≤",
        LITTLE,
        f"The lowest forces are {_listed(lowest)} of the preload, the highest {_listed(highest)}.",
    )


def unstable_response_grows(run: Run) -> Finding:
    """F3: largest |x| early and late, and where it ends in the long run."""
    motion = scene(run, "F3")
    early, late = _early_and_late(motion)
    whirl = run["whirl"].sel(belt_speed=run.parameters.belt_speed, method="nearest")
    size, before = (
        float(whirl[name] / run.parameters.preload) for name in ("amplitude", "amplitude_before")
    )
    saturates = size < SATURATED * before
    unit = run.parameters.time_unit
    return finding(
        late / early,
        ">",
        GROWTH,
        f"|x| grows from {early:.3g} to {late:.3g} l_pre by t = {float(motion.time[-1]) / unit:g}, "
        + ("and saturates" if saturates else "and still grows")
        + f": {size:.3g} l_pre in the last fifth of a run to {float(whirl.t_end) / unit:g} at "
        f"V = {float(whirl.belt_speed):.3g}.",
        passed=Verdict.holds_only_as_printed if saturates else Verdict.holds,
    )


def runs_are_identical(run: Run) -> Finding:
    """F5a: largest difference of the normalized contact forces at (π, π) and (0, 0)."""
    first, second = (scene(run, name).normalized_contact_force for name in ("F5a", "F5b"))
    difference = float(np.abs(first.values - second.values).max())
    return finding(
        difference,
        "≤",
        ROUND_OFF,
        f"The contact forces differ by at most {difference:.1g} of the preload.",
    )


def mass_jumps(run: Run) -> Finding:
    """F5b: repeated flights at (π, π), and their height."""
    motion = scene(run, "F5a")
    flights = events(motion, "separation").size
    height = float(motion.y.max() / run.parameters.preload)
    return finding(
        flights,
        "≥",
        2,
        f"{flights} flights up to t = {float(motion.time[-1]):g}, up to y = {height:.3g} l_pre; "
        "the springs lie along x and have no vertical stiffness to first order.",
    )


def hammering_occurs(run: Run) -> Finding:
    """S1: losses of contact, returns, and how widespread they are over the angles."""
    motion = scene(run, "F2d")
    lost, found = events(motion, "separation").size, events(motion, "contact").size
    peak = float(motion.normalized_contact_force.max())
    hammering = run["hammering_map"]
    strikes = hammering.impact_rate > 0
    forces = hammering.peak_contact_force.values[strikes.values]
    return finding(
        found,
        "≥",
        2,
        f"At (0.83π, 0.83π) contact is lost {lost} times and regained {found} times; each return "
        f"is a pulse from zero force, at most {peak:.3g} of the preload. Over all angles the mass "
        f"strikes the belt again in {100 * share(strikes):.3g} % of the cells, with peaks of "
        f"{np.median(forces):.3g} (median) to {forces.max(initial=0.0):.3g} of the preload.",
        also=lost > 0 and bool(strikes.any()),
    )


def limit_cycle_is_bounded(run: Run) -> Finding:
    """F4: largest |x| against the springs' length, and whether it grows within the run."""
    motion = scene(run, "F4")
    early, late = _early_and_late(motion)
    largest = float(np.abs(motion.x.values).max() / run.parameters.length1)
    lifetimes = run["transient"].shown_lifetime.values / run.parameters.time_unit
    ended = lifetimes[np.isfinite(lifetimes)]
    horizon = float(run["transient"].t_end) / run.parameters.time_unit
    evidence = (
        f"|x| stays below {largest:.3g} L up to t = {float(motion.time[-1]):g} "
        f"({early:.3g} l_pre at first, {late:.3g} l_pre at last). "
    ) + (
        f"Beyond, {ended.size} of {lifetimes.size} runs from starts a billionth of l_pre apart end "
        f"in the whirl before t = {horizon:g}, after {ended.min():.3g} to {ended.max():.3g} "
        f"(median {np.median(ended):.3g})."
        if ended.size
        else f"None of {lifetimes.size} runs leaves it before t = {horizon:g}."
    )
    return finding(
        largest,
        "<",
        2.0,
        evidence,
        also=late < GROWTH * early,
        passed=Verdict.holds_only_as_printed if ended.size else Verdict.holds,
    )


def time_and_frequency_agree(run: Run) -> Finding:
    """C3: frequency of the contact force in A1 against the backbone's at the same scenes."""
    differences, lines = [], []
    for name, twin in (("F2a", "F10"), ("F2b", "F11"), ("F2c", "F12")):
        measured = _frequency(scene(run, name))
        predicted = float(branch(run, twin, 2).omega[0])
        differences.append(abs(measured / predicted - 1))
        lines.append(f"{measured:.4g} and {predicted:.4g}")
    loses = events(scene(run, "F2d"), "separation").size > 0
    reaches = float(branch(run, "F13", 1).y_peak.max()) > run.parameters.preload
    return finding(
        max(differences),
        "≤",
        SAME_TREND,
        f"Frequency of the contact force in A1 and ω2 of A4: {'; '.join(lines)} (Figs. 2a–c and "
        "10–12). Both lose contact only in the fourth configuration (Figs. 2d and 13).",
        also=loses and reaches,
    )


def linearly_stable_but_not(run: Run) -> Finding:
    """F6d: growth rate of A3 at (0.4π, 0.6π) against the growth of A1's response there."""
    rate = float(cell(run["stability_map"], 0.4, 0.6).growth_rate) * run.parameters.time_unit
    early, late = _early_and_late(scene(run, "F3"))
    return finding(
        rate,
        "≤",
        1e-9,
        f"A3's largest growth rate there is {rate:.1g}; in A1 |x| grows from {early:.3g} to "
        f"{late:.3g} l_pre.",
        also=late > GROWTH * early,
    )


def _frequency(motion: xr.Dataset) -> float:
    """Mean angular frequency of the contact force, from its crossings of the mean, upwards."""
    force = motion.normalized_contact_force.values
    above = force > force.mean()
    rising = np.flatnonzero(~above[:-1] & above[1:])
    if rising.size < 2:
        raise MissingDataError("the contact force completes no oscillation")
    share_of_step = (force.mean() - force[rising]) / (force[rising + 1] - force[rising])
    instants = motion.time.values[rising] + share_of_step * np.diff(motion.time.values)[rising]
    return float(2 * np.pi * (rising.size - 1) / (instants[-1] - instants[0]))


def _early_and_late(motion: xr.Dataset) -> tuple[float, float]:
    """Largest |x| in the first and in the last fifth of a run, in units of l_pre."""
    if motion.sizes["time"] < 10:
        raise MissingDataError("the run holds fewer than ten instants")
    fifth = motion.sizes["time"] // 5
    size = np.abs(motion.x.values)
    return float(size[:fifth].max()), float(size[-fifth:].max())


def _listed(values: list[float]) -> str:
    return ", ".join(f"{value:.3g}" for value in values)
