"""The answer of a dataset ``squealing_modes`` in the words of a brake's report.

Structures are also assessed as pads are; those words are in :mod:`squealpipe.study.report.answer`.
"""

import math
from collections.abc import Iterator

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.plotting.origin import parameter
from squealpipe.schema import Outcome
from squealpipe.structures.schema.squealing import (
    JUST_ABOVE,
    NO_ATTRACTOR,
    Kind,
    OnsetKind,
)
from squealpipe.study.report.answer import (
    CARRIED,
    contact_kept,
    damping_advice,
    is_shifted,
    level_change,
)
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number, off_by, part_of_time, percent

LISTED = 8
"""Attractors and modes that are told."""


def lines(answer: xr.Dataset) -> list[str]:
    """The verdict, the modes, and what they end in."""
    changed, damped = level_in_more_modes(answer), damped_beyond(answer)
    return [
        headline(answer),
        *modes(answer),
        *missing(answer),
        *attractors(answer),
        *([changed] if changed else []),
        *onset(answer),
        *([damped] if damped else []),
    ]


def headline(answer: xr.Dataset) -> str:
    """The verdict in one sentence."""
    verdict = Verdict(int(answer.verdict))
    said, unknown = verdict.opening, Verdict.undetermined.opening
    not_run = answer.attrs.get("not_run")
    if not agrees(answer):
        so = ", so nothing was run" if not_run else ""
        return f"{unknown}: {_disagreement(answer)}{so}. {_what_would_do(answer)}"
    if not_run:
        return f"{unknown}: nothing was run, because {not_run}."
    if verdict is Verdict.quiet:
        if bool(answer.quiet_unless_struck):
            lasting = answer.share.values[answer.motion.values != Verdict.quiet].sum()
            return (
                f"{said} unless struck: small motions die out, but a vibration that lasts exists "
                f"beside steady sliding; {percent(lasting)} of random starts end in it."
                f"{_within(answer)}"
            )
        if _lasts(answer):
            return (
                f"{said} from rest: every start that settled came back to steady sliding, but "
                f"squeal that has begun at more friction lasts at this one.{_within(answer)}"
            )
        return (
            f"{said}: steady sliding is stable, and every start that settled came back to it."
            f"{_within(answer)}"
        )
    if verdict is Verdict.undetermined:
        return _undetermined(answer)
    first = answer.isel(attractor=_end(answer))
    at = _frequency_of(answer, first) + _near(answer, first)
    if verdict is Verdict.squeals:
        return f"{said} at {at}; {contact_kept(first.separated_fraction.values)}."
    worst = int(first.separated_fraction.values.argmax())
    loses = first.isel(contact=worst)
    return (
        f"{said} at {at}: contact {loses.contact.item()} is open "
        f"{part_of_time(float(loses.separated_fraction))} of the time, and {_peak_force(first)}."
    )


def _undetermined(answer: xr.Dataset) -> str:
    """Say why the verdict is not known, and what to do about it."""
    said = Verdict.undetermined.opening
    largest = float(answer.pole_growth_rate.max())
    fades = bool(answer.whole_decays)
    if not answer.sizes["mode"] and (largest >= 0 or not fades):
        return (
            f"{said}: small motions about steady sliding neither grow nor die out; give "
            "the structure damping."
        )
    if beyond := _ends_beyond(answer):
        return beyond
    if _grows_without_bound(answer, 0):
        return f"{said}: a small push grows {_nothing_limits(answer)}"
    if "sticks_for_good" in answer and bool(answer.sticks_for_good[0]):
        return f"{said}: after a small push {CARRIED}."
    return (
        f"{said}: the motion after a small push did not settle, or its kind is "
        f"not clear.{damping_advice(answer)}"
    )


def _grows_without_bound(answer: xr.Dataset, index: int) -> bool:
    """Tell whether a push along an unstable mode grew beyond all that contacts limit."""
    # answers of earlier versions do not say it
    return "grows_without_bound" in answer and bool(answer.grows_without_bound[index])


def _nothing_limits(answer: xr.Dataset) -> str:
    """Say that what a push along an unstable mode does has no bound, and what changes that."""
    mode = answer.isel(mode=int(answer.grows_without_bound.values.argmax()))
    damping, damped = float(answer.added_damping), ""
    if 0.0 < damping < np.inf:
        damped = f"modal_damping larger by {number(1.01 * damping)} stops it, "
    return without_bound(mode, damped)


def without_bound(
    mode: xr.Dataset, damped: str = "more modal_damping stops it, "
) -> str:
    """Say that a mode grows without bound, but for the verb, and what changes that.

    Args:
        damped: words for the damping that stops it.
    """
    band = math.floor(0.9 * float(mode.frequency))
    return (
        f"without bound, since no contact limits {_mode_at(mode)}; {damped}"
        f"frequency_max={band} leaves it out."
    )


def _ends_beyond(answer: xr.Dataset) -> str | None:
    """Say that a push ends beyond the band in a mode that the whole may not have, if it does."""
    end = _end(answer)
    if end == NO_ATTRACTOR or answer.mode_is_sure.all():
        return None
    at = float(answer.dominant_frequency[end])
    away = np.abs(answer.frequency.values - at)
    mode = answer.isel(mode=int(np.argmin(away)))
    if not np.isfinite(at) or bool(mode.mode_is_sure):
        return None
    reach = math.ceil(1.1 * float(mode.frequency))
    return (
        f"{Verdict.undetermined.opening}: a small push ends at {engineering(at, 'Hz')}, beyond "
        f"the band, and the errors leave open whether {_mode_at(mode)} grows: "
        f"frequency_max={reach} includes it."
    )


def _peak_force(motion: xr.Dataset) -> str:
    """The largest normal force in newtons, and over the preload where it is known."""
    # NaN of contacts that are open at rest is left out
    ratio = float(motion.peak_force.max())
    newtons = engineering(float(motion.peak_normal_force.max()), "N")
    if not np.isfinite(ratio):
        return f"the peak force is {newtons}"
    return (
        f"a contact is pressed with up to {number(ratio, 2)} times its preload, and the largest "
        f"force is {newtons}"
    )


def agrees(answer: xr.Dataset) -> bool:
    """Tell whether the modes that grow in what was run are those of the whole structure."""
    return bool(answer.same_modes_grow)


def frequency_max(answer: xr.Dataset) -> float:
    """The end of the band in which modes were compared with those of the whole, Hz."""
    limit = float(answer.frequency_max)
    return limit if np.isfinite(limit) else np.inf


def _within(answer: xr.Dataset) -> str:
    """Return a sentence on the band of modes that was examined, if it was limited."""
    limit = frequency_max(answer)
    if not np.isfinite(limit):
        return ""
    return f" Modes above {engineering(limit, 'Hz')} were not examined."


def _beyond(answer: xr.Dataset, frequency: float) -> str:
    """Mark a frequency, Hz, that is beyond the band in which modes were compared."""
    limit = frequency_max(answer)
    return f", {beyond_band(limit)}" if frequency > limit else ""


def beyond_band(limit: float) -> str:
    """Say of a frequency that it is beyond the band that ends at a limit, Hz."""
    return f"beyond the band (modes up to {engineering(limit, 'Hz')} were compared)"


def outside(answer: xr.Dataset) -> str | None:
    """Say that the motion after a small push is beyond the band, if it is."""
    end, limit = _end(answer), frequency_max(answer)
    if end == NO_ATTRACTOR or not float(answer.dominant_frequency[end]) > limit:
        return None
    return f"Its frequency is {beyond_band(limit)}."


def damped_beyond(answer: xr.Dataset) -> str | None:
    """Say that coordinates beyond the band were damped for the runs, if they were."""
    ratio = float(answer.damping_beyond_band)
    if not ratio > 0.0:
        return None
    return (
        f"Above {engineering(frequency_max(answer), 'Hz')} modes would grow in the coordinates "
        f"that were run; these were given a damping ratio of {number(ratio)} there."
    )


def _frequency_of(answer: xr.Dataset, motion: xr.Dataset) -> str:
    """Return the frequency of a motion, marked if it is beyond the band."""
    frequency = float(motion.dominant_frequency)
    return engineering(frequency, "Hz") + _beyond(answer, frequency)


def _mode_at(mode: xr.Dataset) -> str:
    """Name a mode by its frequency: numbers count other modes in each dataset."""
    return f"the mode at {engineering(float(mode.frequency), 'Hz', 4)}"


def _disagreement(answer: xr.Dataset) -> str:
    """Name the modes in which what was run and the whole structure disagree."""
    kept = f"the {int(answer.n_modes)} modes kept"
    parts = []
    if count := answer.sizes["missing"]:
        lost = answer.isel(missing=0)
        modes_ = "mode" if count == 1 else "modes"
        fastest = "" if count == 1 else ", the fastest"
        parts.append(
            f"{count} unstable {modes_} of the whole structure ({_named(lost, 'missing_')}"
            f"{fastest}) {'is' if count == 1 else 'are'} missing in {kept}"
        )
    within = answer.frequency.values <= frequency_max(answer)
    unsure = answer.isel(mode=~answer.mode_is_sure.values & within)
    if unsure.sizes["mode"]:
        several = [
            unsure.isel(mode=i) for i in range(min(unsure.sizes["mode"], LISTED))
        ]
        names = ", ".join(map(_mode_at, several))
        parts.append(f"the errors leave open whether {names} of {kept} grows")
    return "; and ".join(parts)


def _named(mode: xr.Dataset, prefix: str = "") -> str:
    """Frequency and growth rate of a mode, with their errors where they are not 0."""
    frequency, growth = (
        float(mode[f"{prefix}{name}"]) for name in ("frequency", "growth_rate")
    )
    off, apart = (
        0.0 if prefix else float(mode[f"mode_{name}_error"])
        for name in ("frequency", "growth_rate")
    )
    told = engineering(frequency, "Hz", 4), number(growth)
    # the error of a structure that was not reduced is round-off, and is not told
    if prefix or max(off / max(frequency, 1e-300), apart / abs(growth)) < 1e-6:
        return f"{told[0]}, growth rate {told[1]} 1/s"
    if not np.isfinite(apart):
        return f"{told[0]}, growth rate {told[1]} 1/s of unknown error"
    return (
        f"{told[0]} ± {engineering(off, 'Hz', 2)}, growth rate {told[1]} ± "
        f"{number(apart, 2)} 1/s"
    )


def _what_would_do(answer: xr.Dataset) -> str:
    """Say how to get a verdict."""
    enough, size = int(answer.modes_that_would_do), int(answer.degrees_of_freedom)
    # what is beyond a band decides nothing about it
    within = answer.frequency.values <= frequency_max(answer)
    apart = [
        *answer.missing_frequency.values,
        *answer.frequency.values[~answer.mode_is_sure.values & within],
    ]
    below = math.floor(min(apart))
    band = ""
    if below > 0:
        told = engineering(below, "Hz", 5)
        band = f" Up to {told} the same modes grow: frequency_max={below}."
    if not enough:
        other = band or " Look at a narrower band with a smaller frequency_max."
        return f"No number of modes that can be run would do.{other}"
    whole = " (all there are)" if enough == size else ""
    return f"{enough} modes{whole} would do: n_modes={enough}.{band}"


def missing(answer: xr.Dataset) -> Iterator[str]:
    """Unstable modes of the whole structure that are not among the modes kept."""
    for index in range(min(answer.sizes["missing"], LISTED)):
        lost = answer.isel(missing=index)
        yield f"Not in the modes kept: {_named(lost, 'missing_')} (of the whole structure)."
    if answer.sizes["missing"] > LISTED:
        yield f"{answer.sizes['missing'] - LISTED} more of these grow more slowly."


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
    return (
        f", nearest to the unstable mode at {engineering(float(mode.frequency), 'Hz')}"
    )


def level(answer: xr.Dataset) -> str:
    """Return the level of what a small push ends in, and where contact is lost, in one sentence."""
    if answer.attrs.get("not_run") or not agrees(answer):
        return "Level: not known."
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


def level_in_more_modes(answer: xr.Dataset) -> str | None:
    """Say how the level of what a small push ends in changes in more modes, if that was run."""
    end, size = _end(answer), int(answer.get("refined_n_modes", 0))
    if answer.attrs.get("not_run") or end == NO_ATTRACTOR or not size:
        return None
    one = answer.isel(attractor=end)
    if Verdict(int(one.motion)) is Verdict.quiet:
        return None
    return level_change(
        (float(one.velocity_rms), float(one.refined_velocity_rms)),
        (int(answer.n_modes), size, int(answer.degrees_of_freedom)),
        (Verdict(int(one.motion)), Verdict(int(one.refined_motion))),
    )


def beside(answer: xr.Dataset) -> str | None:
    """Name the motions that random starts end in and a small push does not, in one sentence."""
    end = _end(answer)
    others = [
        one
        for index in range(answer.sizes["attractor"])
        for one in [answer.isel(attractor=index)]
        if index != end
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
    """Return a row for each unstable mode: its growth, and the motion that it grows into."""
    if not answer.sizes["mode"]:
        kept = "" if agrees(answer) else f" in the {int(answer.n_modes)} modes kept"
        yield f"No mode of steady sliding is unstable{kept}."
    for index in range(min(answer.sizes["mode"], LISTED)):
        mode = answer.isel(mode=index)
        named = f"The mode at {_named(mode)}{_beyond(answer, float(mode.frequency))},"
        if not bool(mode.mode_is_sure):
            named += " whose sign of growth is not known,"
        if answer.attrs.get("not_run"):
            yield f"{named} is unstable."
            continue
        end = int(mode.ends_in)
        if end == NO_ATTRACTOR:
            # only the fastest of them is pushed, and only where no mode within the band grows
            if index and float(mode.frequency) > frequency_max(answer):
                yield f"{named} is unstable; it was not pushed."
            elif _grows_without_bound(answer, index):
                yield f"{named} grows without bound: no contact limits it."
            else:
                yield f"{named} ends in a motion that is undetermined."
            continue
        time = float(mode.time_to_squeal)
        within = f" within {engineering(time, 's')}" if np.isfinite(time) else ""
        if np.isfinite(answer.dominant_frequency[end]):
            yield f"{named} {_fate(answer, mode, within)}"
        else:
            yield f"{named} dies out in the end."


def _fate(answer: xr.Dataset, mode: xr.Dataset, within: str) -> str:
    """Say which vibration a push along a mode grows into, and how far that is from the mode.

    Args:
        within: words for the time that it takes.
    """
    motion = answer.isel(attractor=int(mode.ends_in))
    frequency = float(motion.dominant_frequency)
    grows = f"grows{within} into the vibration at {_frequency_of(answer, motion)}"
    shift = frequency / float(mode.frequency) - 1.0
    told = grows
    if bool(mode.squeals):
        told = f"{Verdict(int(motion.motion)).words}: it {grows}"
    if is_shifted(shift):
        told += f", {off_by(shift)} its frequency in small motions"
        told += _reason_of_shift(motion)
    if not bool(mode.squeals):
        away = np.abs(answer.frequency.values - frequency)
        nearest = answer.isel(mode=int(away.argmin()))
        at = engineering(float(nearest.frequency), "Hz", 4)
        told += f"; the nearest unstable mode is at {at}"
    return f"{told}."


def _reason_of_shift(motion: xr.Dataset) -> str:
    """Say what contacts do that they do not do in small motions."""
    done = [
        word
        for name, word in (("separated_fraction", "open"), ("stick_fraction", "stick"))
        if (motion[name] > 0.0).any()
    ]
    return f", since contacts then {' and '.join(done)}" if done else ""


def attractors(answer: xr.Dataset) -> Iterator[str]:
    """Return a row for each motion that random starts end in."""
    if answer.attrs.get("not_run"):
        return
    size = answer.sizes["sample"]
    for index in range(min(answer.sizes["attractor"], LISTED)):
        one = answer.isel(attractor=index)
        share = (
            f"{int(one['count'])} of {size} random starts ({percent(float(one.share_low))} to "
            f"{percent(float(one.share_high))} of all) end in"
        )
        attractor_kind = Kind(int(one.kind))
        if attractor_kind is Kind.steady_sliding:
            yield f"{share} steady sliding."
            continue
        words = {
            Kind.cycle: f"a {attractor_kind.words}",
            Kind.torus: f"a {attractor_kind.words} motion",
            Kind.irregular: f"an {attractor_kind.words} motion",
        }.get(attractor_kind, f"a motion of {attractor_kind.words} kind")
        mode = float(one.dominant_frequency) - float(one.frequency_shift)
        shift = float(one.frequency_shift) / mode if mode > 0.0 else 0.0
        near = off_by(shift) if is_shifted(shift) else "near"
        yield (
            f"{share} {words} at {_frequency_of(answer, one)}, {near} the mode at "
            f"{engineering(mode, 'Hz')}: rms speed "
            f"{engineering(float(one.velocity_rms), 'm s-1')}, peak "
            f"{engineering(float(one.velocity_peak), 'm s-1')}; open {_of_contacts(one)}."
        )
    if float(answer.share_undetermined) > 0:
        unbounded = float(answer.get("share_unbounded", 0.0))
        if unbounded > 0.0:
            limits = "without bound."
            if "grows_without_bound" in answer:
                limits = _nothing_limits(answer)
            yield f"{percent(unbounded)} of random starts grow {limits}"
        if (rest := float(answer.share_undetermined) - unbounded) > 0.0:
            yield f"{percent(rest)} of random starts did not settle; give a longer t_end."


def onset(answer: xr.Dataset, of_whole: float | None = None) -> Iterator[str]:
    """Say where squeal begins and where it dies as friction falls, if it was followed.

    Args:
        of_whole: critical friction of the whole structure, where it is known: it is told, and the
            one of the modes kept is within 1 % of it (see ``squeal/first_onset.py``).
    """
    if "onset_kind" not in answer or not agrees(answer):
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
        yield (
            "Where steady sliding turns unstable could not be located, or not confirmed in the "
            "whole structure."
        )
    else:
        at = engineering(float(answer.onset_frequency), "Hz")
        told, of_modes = number(critical, 4), ""
        if of_whole is not None and of_whole > 0 and number(of_whole, 4) != told:
            # frictions at which motions die, told next, are those of the modes that were run
            of_modes = f"in the {int(answer.n_modes)} modes that were run: {told}; "
            told = number(of_whole, 4)
        begins = f"Steady sliding turns unstable at mu = {told} ({of_modes}{at})."
        yield f"{begins} {_kind(answer)}"
    for index in range(answer.sizes["track"]):
        one = answer.isel(track=index)
        if int(one.track_attractor) != JUST_ABOVE:
            motion = answer.isel(attractor=int(one.track_attractor))
            at = engineering(float(motion.dominant_frequency), "Hz")
            yield f"As friction falls, the motion at {at} {_end_of(one, critical)}."
    if _lasts(answer):
        own = parameter(answer, "mu")
        yield f"At mu = {number(own)}, too, squeal that has begun lasts."


def _lasts(answer: xr.Dataset) -> bool:
    """Return whether squeal that began at more friction lasts where no mode is unstable."""
    if "onset_kind" not in answer or answer.sizes["mode"]:
        return False
    if not bool(answer.squeals_below_critical):
        return False
    own = parameter(answer, "mu")
    return bool(np.nanmin(answer.track_mu.values) <= own)


def _kind(answer: xr.Dataset) -> str:
    """Name the motion that begins at the onset."""
    match OnsetKind(int(answer.onset_kind)):
        case OnsetKind.supercritical:
            return "The noise just above it dies there (supercritical)."
        case OnsetKind.subcritical:
            one = answer.isel(track=answer.track_attractor.values == JUST_ABOVE)
            end = _end_of(one.isel(track=0), float(answer.onset_mu))
            return f"The noise just above it {end} (subcritical)."
    return "Whether the noise just above it lasts below is undetermined."


def _end_of(one: xr.Dataset, critical: float) -> str:
    """Describe where a motion that was followed over friction dies."""
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
    """Share of time open, by contact; of many those that are open most."""
    pairs = list(zip(one.contact.values, one.separated_fraction.values, strict=True))
    few = pairs
    if len(pairs) > LISTED:
        few = sorted(pairs, key=lambda pair: -pair[1])[: LISTED // 2]
    told = [f"{name} {part_of_time(float(value))}" for name, value in few]
    if rest := len(pairs) - len(few):
        told.append(f"{rest} others at most {part_of_time(float(few[-1][1]))}")
    return ", ".join(told)
