"""The answer of a dataset ``squealing_modes`` in the words of a brake's report."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from squealpipe.plotting.origin import parameter
from squealpipe.schema import Outcome
from squealpipe.schema.assess import Verdict
from squealpipe.schema.squealing import JUST_ABOVE, NO_ATTRACTOR, Kind, OnsetKind
from squealpipe.text import number
from squealpipe.units import engineering

LISTED = 8
"""Attractors and modes that are told."""


def lines(answer: xr.Dataset) -> list[str]:
    """The verdict, the modes, and what they end in."""
    return [headline(answer), *modes(answer), *attractors(answer), *onset(answer)]


def headline(answer: xr.Dataset) -> str:
    """The verdict in one sentence."""
    verdict = Verdict(int(answer.verdict))
    if verdict is Verdict.quiet:
        if bool(answer.quiet_unless_struck):
            lasting = answer.share.values[answer.motion.values != Verdict.quiet].sum()
            return (
                "Quiet unless struck: small motions die out, but a vibration that lasts exists "
                f"beside steady sliding; {_percent(lasting)} of random starts end in it."
            )
        if _lasts(answer):
            return (
                "Quiet from rest: every start that settled came back to steady sliding, but "
                "squeal that has begun at more friction lasts at this one."
            )
        return "Quiet: steady sliding is stable, and every start that settled came back to it."
    if verdict is Verdict.undetermined:
        largest = float(answer.pole_growth_rate.max())
        if not answer.sizes["mode"] and largest >= 0:
            return (
                "Undetermined: small motions about steady sliding neither grow nor die out; give "
                "the structure damping."
            )
        return (
            "Undetermined: the motion after a small push did not settle, or its kind is "
            "not clear."
        )
    first = answer.isel(attractor=_end(answer))
    at = engineering(float(first.dominant_frequency), "Hz") + _near(answer, first)
    if verdict is Verdict.squeals:
        return f"Squeals at {at}; contact is kept."
    worst = int(first.separated_fraction.values.argmax())
    loses = first.isel(contact=worst)
    force = number(float(first.peak_force.max()), 2)
    return (
        f"Hammers at {at}: contact {loses.contact.item()} is open "
        f"{_percent(float(loses.separated_fraction))} of the time, the peak force is {force} times "
        "the preload of its contact."
    )


def _end(answer: xr.Dataset) -> int:
    """The attractor that a small push ends in; NO_ATTRACTOR where it did not settle."""
    if answer.sizes["mode"]:
        return int(answer.ends_in[0])
    # a push may leave steady sliding although none of its modes is unstable
    alike = answer.motion.values == int(answer.verdict)
    return int(alike.argmax()) if alike.any() else NO_ATTRACTOR


def _near(answer: xr.Dataset, motion: xr.Dataset) -> str:
    """The unstable mode that is nearest to a motion, in words."""
    if not answer.sizes["mode"]:
        return ""
    away = np.abs(answer.frequency.values - float(motion.dominant_frequency))
    mode = answer.isel(mode=int(away.argmin()))
    at = engineering(float(mode.frequency), "Hz")
    return f", nearest to unstable mode {int(mode.mode)} ({at})"


def level(answer: xr.Dataset) -> str:
    """How loud what a small push ends in is, and where contact is lost, in one sentence."""
    if Verdict(int(answer.verdict)) is Verdict.quiet:
        return "Level: none."
    end = _end(answer)
    if end == NO_ATTRACTOR:
        return "Level: not known; the motion did not settle."
    one = answer.isel(attractor=end)
    return (
        f"Level: rms speed of vibration {engineering(float(one.velocity_rms), 'm s-1')} at the "
        f"contacts, at most {engineering(float(one.velocity_peak), 'm s-1')}; open "
        f"{_of_contacts(one)} of the time."
    )


def beside(answer: xr.Dataset) -> str | None:
    """What random starts end in other than what a small push does, in one sentence."""
    end = _end(answer)
    others = [
        one
        for place in range(answer.sizes["attractor"])
        for one in [answer.isel(attractor=place)]
        if place != end
        and int(one["count"])
        and Verdict(int(one.motion)) is not Verdict.quiet
    ]
    if not others:
        return None
    told = [
        f"{int(one['count'])} of {answer.sizes['sample']} random starts at "
        f"{engineering(float(one.dominant_frequency), 'Hz')}"
        for one in others[:LISTED]
    ]
    return f"From other starts it ends elsewhere: {'; '.join(told)}."


def modes(answer: xr.Dataset) -> Iterator[str]:
    """What becomes of each unstable mode."""
    if not answer.sizes["mode"]:
        yield "No mode of steady sliding is unstable."
    for place in range(min(answer.sizes["mode"], LISTED)):
        mode = answer.isel(mode=place)
        named = (
            f"Mode {int(mode.mode)} ({engineering(float(mode.frequency), 'Hz')}, growth rate "
            f"{number(float(mode.growth_rate))} 1/s)"
        )
        end = int(mode.ends_in)
        if end == NO_ATTRACTOR:
            yield f"{named} ends in a motion that is undetermined."
            continue
        time = float(mode.time_to_squeal)
        after = f" after {engineering(time, 's')}" if np.isfinite(time) else ""
        if bool(mode.squeals):
            yield f"{named} squeals{after}."
        elif bool(np.isfinite(answer.dominant_frequency[end])):
            at = engineering(float(answer.dominant_frequency[end]), "Hz")
            yield f"{named} does not squeal: the motion ends at {at}{after}."
        else:
            yield f"{named} dies out in the end."


def attractors(answer: xr.Dataset) -> Iterator[str]:
    """What random starts end in."""
    size = answer.sizes["sample"]
    for place in range(min(answer.sizes["attractor"], LISTED)):
        one = answer.isel(attractor=place)
        share = (
            f"{int(one['count'])} of {size} random starts ({_percent(float(one.share_low))} to "
            f"{_percent(float(one.share_high))} of all) end in"
        )
        kind = Kind(int(one.kind))
        if kind is Kind.steady_sliding:
            yield f"{share} steady sliding."
            continue
        words = {
            Kind.cycle: "a cycle",
            Kind.torus: "a quasi-periodic motion",
            Kind.irregular: "an irregular motion",
        }.get(kind, "a motion of undetermined kind")
        shift = engineering(abs(float(one.frequency_shift)), "Hz")
        side = "above" if float(one.frequency_shift) > 0 else "below"
        yield (
            f"{share} {words} at {engineering(float(one.dominant_frequency), 'Hz')}, {shift} "
            f"{side} mode {int(one.nearest_mode)}: rms speed "
            f"{engineering(float(one.velocity_rms), 'm s-1')}, peak "
            f"{engineering(float(one.velocity_peak), 'm s-1')}; open {_of_contacts(one)}."
        )
    if float(answer.share_undetermined) > 0:
        yield (
            f"{_percent(float(answer.share_undetermined))} of random starts did not settle; "
            "give a longer t_end."
        )


def onset(answer: xr.Dataset) -> Iterator[str]:
    """Where squeal begins and where it dies as friction falls, if it was followed."""
    if "onset_kind" not in answer:
        return
    critical, outcome = float(answer.onset_mu), Outcome(int(answer.onset_outcome))
    if outcome is Outcome.already_unstable:
        yield "Steady sliding is unstable even without friction."
    elif outcome is Outcome.not_reached:
        yield (
            "Up to twice this friction, as far as the limit of stick allows it, no mode turns "
            "unstable."
        )
    elif np.isnan(critical):
        yield "Where steady sliding turns unstable could not be located."
    else:
        at = engineering(float(answer.onset_frequency), "Hz")
        begins = f"Steady sliding turns unstable at mu = {number(critical, 4)} ({at})."
        yield f"{begins} {_kind(answer)}"
    for place in range(answer.sizes["track"]):
        one = answer.isel(track=place)
        if int(one.track_attractor) != JUST_ABOVE:
            motion = answer.isel(attractor=int(one.track_attractor))
            at = engineering(float(motion.dominant_frequency), "Hz")
            yield f"As friction falls, the motion at {at} {_end_of(one, critical)}."
    if _lasts(answer):
        own = parameter(answer, "mu")
        yield f"At mu = {number(own)}, too, squeal that has begun lasts."


def _lasts(answer: xr.Dataset) -> bool:
    """Whether squeal that began at more friction lasts where no mode is unstable."""
    if "onset_kind" not in answer or answer.sizes["mode"]:
        return False
    if not bool(answer.squeals_below_critical):
        return False
    own = parameter(answer, "mu")
    return bool(np.nanmin(answer.track_mu.values) <= own)


def _kind(answer: xr.Dataset) -> str:
    """What becomes of the motion that begins there."""
    match OnsetKind(int(answer.onset_kind)):
        case OnsetKind.supercritical:
            return "What squeals just above dies there (supercritical)."
        case OnsetKind.subcritical:
            one = answer.isel(track=answer.track_attractor.values == JUST_ABOVE)
            end = _end_of(one.isel(track=0), float(answer.onset_mu))
            return f"What squeals just above {end} (subcritical)."
    return "Whether what squeals just above lasts below is undetermined."


def _end_of(one: xr.Dataset, critical: float) -> str:
    """Where a motion that was followed dies."""
    dies = float(one.mu_dies)
    if not np.isfinite(dies):
        lowest = number(float(np.nanmin(one.track_mu.values)), 3)
        return f"was followed to mu = {lowest}, and its end was not reached"
    if dies >= critical:
        return "dies at the critical friction"
    below = ""
    if np.isfinite(critical):
        below = (
            f", {number(100 * (1 - dies / critical), 2)} % below the critical friction"
        )
    return f"lasts down to mu = {number(dies, 4)}{below}"


def _of_contacts(one: xr.Dataset) -> str:
    """Share of time open, by contact."""
    pairs = zip(one.contact.values, one.separated_fraction.values, strict=True)
    return ", ".join(f"{name} {_percent(float(value))}" for name, value in pairs)


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"
