"""The answer of a dataset ``assess``, of a pad or structure, in words that need no handbook."""

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.schema import Outcome
from squealpipe.structures.schema.squealing import GIVE_DAMPING
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number, off_by, part_of_time, percent
from squealpipe.vibration.schema import Mechanism, error_of
from squealpipe.vibration.settling import ALWAYS

NAMES = {
    "mu": "friction coefficient at belt speed",
    "k3": "contact stiffness k3",
    "k1": "stiffness of spring 1",
    "k2": "stiffness of spring 2",
    "alpha1": "angle alpha1",
    "alpha2": "angle alpha2",
    "damping": "damping ratio of both springs",
    "preload": "preload (compression of the contact)",
    "belt_speed": "belt speed",
}
"""Words for what is changed of a pad."""
CHEAPEST = 3
"""Cures that an answer names."""
CARRIED = (
    "the belt still carries a sticking contact along, ever farther; friction jams, or the belt is "
    "very slow"
)
"""Words for a contact that sticks for good."""
NOT_RUN = "not run"
"""Words for what no run has told."""


class CureWords(NamedTuple):
    """One row of the table of cures."""

    name: str
    words: str
    now: str
    quiet_from: str
    change: str
    any_start: str
    change_any_start: str
    intervals: str
    tried: str


def is_structure(answer: xr.Dataset) -> bool:
    """Tell whether an answer is of a structure, and not of a pad on two springs."""
    return "n_modes" in answer


def words_of(answer: xr.Dataset, name: str) -> str:
    """Return the words for what is changed."""
    if not is_structure(answer):
        return NAMES[name]
    if name.startswith("mu_"):
        return f"friction coefficient of {name.removeprefix('mu_')}"
    # modifications have the names that they were given
    words_of_structures = {
        "mu": "friction coefficient",
        "contact_stiffness": "stiffness of all contacts, as a factor",
        "preload": "preload of all contacts, as a factor",
        "modal_damping": "damping ratio of all modes",
        "belt_speed": "speed",
    }
    return words_of_structures.get(name, name)


def verdict_of(answer: xr.Dataset, prefix: str = "") -> Verdict:
    """The verdict of a start."""
    return Verdict(int(answer[f"{prefix}verdict"]))


def headline(answer: xr.Dataset, prefix: str = "") -> str:
    """The verdict in one sentence."""

    def value(name: str) -> float:
        return float(answer[f"{prefix}{name}"])

    verdict = verdict_of(answer, prefix)
    said = verdict.opening
    if verdict is Verdict.quiet:
        if not prefix and bool(answer.quiet_unless_struck):
            also = verdict_of(answer, "sudden_") is not Verdict.quiet
            fate = "stay small" if _is_neutral(answer) else "die out"
            return (
                f"{said} unless struck: small motions {fate}, but a hard enough blow"
                f"{' or a sudden start' * also} leaves a vibration that lasts."
            )
        if _is_neutral(answer):
            return (
                f"{said}: nothing damps the vibration after a push, but it stays small."
            )
        return f"{said}: the vibration dies out."
    at = engineering(value("frequency"), "Hz") + _wanders(answer, prefix)
    force = number(value("peak_contact_force_over_preload"))
    lost = percent(value("separated_fraction"))
    if verdict is Verdict.hammers and answer.sizes.get("contact", 1) > 1:
        which = "one contact"
        if not prefix:  # of a sudden start it is not stored which contact opens most
            opened = answer.contact_separated_fraction
            which = f"contact {opened.idxmax('contact').item()}"
        return (
            f"{said} at {at}: {which} is open {lost} of the time, and a contact is pressed with "
            f"up to {force} times its preload."
        )
    if verdict is Verdict.hammers:
        return (
            f"{said} at {at}: contact is lost {lost} of the time, the peak force is {force} "
            "times the preload force."
        )
    if verdict is Verdict.squeals:
        stuck = value("stick_fraction")
        how = (
            f"in stick–slip, sticking to the belt {percent(stuck)} of the time"
            if stuck > 0
            else "without sticking"
        )
        return f"{said} at {at} {how}; {contact_kept(_opened(answer, prefix))}."
    return said + _not_settled(answer, prefix)


def contact_kept(opened: Iterable[float]) -> str:
    """Say whether contact is kept, by the shares of the time in which contacts are open.

    A verdict of squeal allows one loss, and contacts that are always open.
    """
    lost = max((share for share in opened if share < ALWAYS), default=0.0)
    if lost > 0.0:
        return f"contact is lost {part_of_time(lost)} of the time"
    return "contact is kept"


def _opened(answer: xr.Dataset, prefix: str) -> list[float]:
    """Return the share of the time in which each contact is open; of a sudden start the largest."""
    if prefix or not is_structure(answer):
        return [float(answer[f"{prefix}separated_fraction"])]
    return [float(share) for share in answer.contact_separated_fraction]


def _not_settled(answer: xr.Dataset, prefix: str) -> str:
    """Say how far a motion came that has not settled, and what to do about it."""

    def value(name: str) -> float:
        return float(answer[f"{prefix}{name}"])

    if not prefix and _grows_without_bound(answer):
        return (
            ": after a small push the vibration grows without bound, since nothing limits it at "
            f"{engineering(float(answer.leading_frequency), 'Hz')}; give it more modal_damping, "
            "or a frequency_max below."
        )
    after = engineering(value("settled_by"), "s")
    # of a structure after a sudden start it is not stored whether all contacts are open
    is_known = not (prefix and is_structure(answer))
    if is_known and min(_opened(answer, prefix)) >= ALWAYS:
        return (
            f": {_what(answer)} has left the belt, and had not come back after {after}; without "
            "contact there is nothing to judge."
        )
    if value("stick_fraction") >= ALWAYS:
        return f": after {after} {CARRIED}."
    told = f": after {after} the motion had not settled"
    if not np.isnan(value("frequency")):
        at = engineering(value("frequency"), "Hz") + _wanders(answer, prefix)
        lost = percent(value("separated_fraction"))
        told += f"; at the end its strongest line was at {at}, contact lost {lost} of the time"
    return f"{told}.{damping_advice(answer)}"


def _grows_without_bound(answer: xr.Dataset) -> bool:
    return int(answer.get("outcome", Outcome.converged)) == Outcome.not_finite


def damping_advice(answer: xr.Dataset) -> str:
    """Say what to do about a motion that has not settled, if nothing damps the structure."""
    if not bool(answer.get("is_undamped", False)):
        return ""
    return f" {GIVE_DAMPING[0].upper()}{GIVE_DAMPING[1:]}."


def _wanders(answer: xr.Dataset, prefix: str = "") -> str:
    """Say that the strongest line of an irregular motion is not the same in all parts of it."""
    frequency, error = f"{prefix}frequency", error_of(f"{prefix}frequency")
    if not answer[error] > 0.05 * answer[frequency]:
        return ""
    scatter = engineering(float(answer[error]), "Hz", 2)
    return f" (at times another line is strongest: standard deviation {scatter})"


def cause(answer: xr.Dataset) -> str:
    """Say why, in one sentence, and where the mass slides if that is far away."""
    return " ".join(filter(None, (_cause(answer), shift(answer), _far(answer))))


def _cause(answer: xr.Dataset) -> str:
    twofold = math.log(2.0) / max(abs(float(answer.sliding_growth_rate)), 1e-300)
    time = engineering(twofold, "s")
    modes = [float(f) for f in answer.mode_frequency.values if f > 0]
    of = "modes are at"
    if is_structure(answer):
        modes, of = [float(answer.leading_frequency)], "mode that decays slowest is at"
    frequencies = " and ".join(engineering(f, "Hz") for f in modes)
    mechanism = Mechanism(int(answer.mechanism))
    if mechanism is Mechanism.falling_friction:
        return (
            "Cause: friction that falls with speed feeds the vibration, which doubles every "
            f"{time} at first; the {'mode that grows is' if is_structure(answer) else 'modes are'} "
            f"at {frequencies}."
        )
    if mechanism is Mechanism.flutter:
        if len(modes) == 2 and abs(modes[1] - modes[0]) > 0.01 * modes[0]:
            merged = f"the modes at {frequencies}"
        else:
            merged = f"two modes into one near {engineering(modes[0], 'Hz')}"
        return (
            f"Cause: friction couples {merged} (flutter), and the vibration doubles every {time} "
            "at first."
        )
    if mechanism is Mechanism.divergence:
        return (
            f"Cause: friction and contact push {_what(answer)} away from steady sliding without "
            f"oscillation (divergence); its distance doubles every {time} at first."
        )
    if mechanism is Mechanism.no_sliding_state:
        return "Cause: there is no steady sliding in contact; the answer is that of a sudden start."
    if verdict_of(answer) is Verdict.quiet and not bool(answer.quiet_unless_struck):
        fades = (
            "small motions neither grow nor decay, because nothing damps them"
            if _is_neutral(answer)
            else f"small motions halve every {time}"
        )
        return f"Steady sliding is stable: {fades}; the {of} {frequencies}."
    push = "hard" if verdict_of(answer) is Verdict.quiet else "small"
    return (
        f"Steady sliding is stable, but another motion exists beside it, which a {push} push "
        f"reaches; the {of} {frequencies}."
    )


def is_shifted(apart: float) -> bool:
    """Tell whether a noise is farther from a mode, over its frequency, than rounding hides."""
    return abs(apart) > 0.02


def shift(answer: xr.Dataset) -> str:
    """Say how far contact loss shifts the noise of a structure from the mode that grows."""
    noise, mode = float(answer.frequency), float(answer.get("leading_frequency", 0.0))
    if not (mode > 0.0 and float(answer.separated_fraction) > 0.0):
        return ""
    apart = noise / mode - 1.0
    if not is_shifted(apart) or _wanders(answer):  # a line that wanders has no shift
        return ""
    return (
        f"The noise is {off_by(apart)} the mode that grows fastest "
        f"({engineering(mode, 'Hz')}), since contact is lost in it."
    )


def _what(answer: xr.Dataset) -> str:
    return "the structure" if is_structure(answer) else "the mass"


def _far(answer: xr.Dataset) -> str:
    if is_structure(answer):
        return ""
    away = math.hypot(float(answer.x_sliding), float(answer.y_sliding))
    preloads = away / float(answer.preload)
    # from here on the reader is told how far steady sliding is from rest
    if not preloads > 10.0:
        return ""
    return (
        f"Friction carries the mass {engineering(away, 'm')} from where its springs are unloaded, "
        f"{number(preloads)} times the preload, before it slides steadily: make sure that they are "
        "linear that far."
    )


def level(answer: xr.Dataset) -> str:
    """Return the level of the noise in one sentence."""
    verdict = verdict_of(answer)
    if verdict is Verdict.quiet:
        return f"Level: none; the contact force is {_force(answer)}."
    if _grows_without_bound(answer) or np.isnan(float(answer.velocity_rms_along)):
        return "Level: not known."
    when = " at the end" * (verdict is Verdict.undetermined)
    along, across = (
        engineering(float(answer[f"velocity_rms_{way}"]), "m s-1")
        for way in ("along", "across")
    )
    peak = engineering(float(answer.displacement_peak), "m")
    told = (
        f"Level{when}: {along} rms along the belt and {across} across it{_scatter(answer)}; "
        f"displacement up to {peak}, contact force up to {_force(answer)}."
    )
    return f"{told} {in_more_modes(answer)}".rstrip()


def in_more_modes(answer: xr.Dataset) -> str:
    """Say how the level changes in more modes, in one sentence; nothing where that is not known."""
    size = int(answer.get("refined_n_modes", 0))
    if not size or verdict_of(answer) in (Verdict.quiet, Verdict.undetermined):
        return ""
    level = math.hypot(
        *(float(answer[f"velocity_rms_{way}"]) for way in ("along", "across"))
    )
    return level_change(
        (level, float(answer.refined_velocity_rms)),
        (int(answer.n_modes), size, int(answer.degrees_of_freedom)),
        (verdict_of(answer), verdict_of(answer, "refined_")),
    )


def level_change(
    levels: tuple[float, float],
    sizes: tuple[int, int, int],
    verdicts: tuple[Verdict, Verdict],
) -> str:
    """Say how a level changes in more modes, in one sentence.

    Args:
        levels: rms speed of vibration, m/s, in the modes that were run and in more of them; NaN if
            the motion has not settled there.
        sizes: numbers of both, and of all degrees of freedom.
        verdicts: what is heard in both.
    """
    (level, refined), (few, many, all_modes) = levels, sizes
    more = ""
    if many < all_modes:
        more = f": see what more modes change (n_modes={many} and above)"
    if not np.isfinite(refined):
        return (
            f"The level is uncertain: run on in {many} modes the motion did not settle."
        )
    told = f"{engineering(level, 'm s-1')} (rms) in {few} modes"
    becomes = f"{engineering(refined, 'm s-1')} in {many}"
    if verdicts[0] is not verdicts[1]:
        does = {
            Verdict.quiet: "dies out",
            Verdict.squeals: "squeals",
            Verdict.hammers: "hammers",
        }
        becomes += f", where it {does[verdicts[1]]}"
    # what two windows of an irregular motion may differ by is no reason to doubt a level
    elif abs(refined - level) <= 0.1 * level:
        return f"Its level is {told}, and {becomes}."
    return f"The level is uncertain: {told}, but {becomes}{more}."


def _scatter(answer: xr.Dataset) -> str:
    """Return the statistical error of the levels in words, if their digits would show it."""
    ways = [f"velocity_rms_{way}" for way in ("along", "across")]
    values = [float(answer[way]) for way in ways]
    errors = [float(answer[error_of(way)]) for way in ways]
    loudest = int(np.argmax(values))
    share = errors[loudest] / max(values[loudest], 1e-300)
    return f" (within {percent(share)})" if share >= 5e-3 else ""


def impacts(answer: xr.Dataset) -> str:
    """Losses of contact, stick and harmonics, in one line."""
    if verdict_of(answer) is Verdict.quiet:
        return "Contact is kept."
    if _grows_without_bound(answer) or np.isnan(float(answer.stick_fraction)):
        return "Motion: not known."
    parts = []
    if float(answer.impact_rate) > 0:
        parts.append(
            f"{number(float(answer.impact_rate))} impacts per second at up to "
            f"{engineering(float(answer.impact_speed), 'm s-1')}"
        )
    parts.append(f"sticking {percent(float(answer.stick_fraction))} of the time")
    parts.append("it repeats" if bool(answer.periodic) else "it does not repeat")
    resolution = engineering(float(answer.frequency_resolution), "Hz", 2)
    parts.append(f"frequencies are resolved to {resolution}")
    return "Motion: " + "; ".join(parts) + "."


def sudden(answer: xr.Dataset) -> str:
    """Return in words what the start at rest under the whole preload leads to."""
    if Mechanism(int(answer.mechanism)) is Mechanism.no_sliding_state:
        return "Pressed on suddenly: the same."
    told = headline(answer, "sudden_")
    return f"Pressed on suddenly: {told[0].lower()}{told[1:]}"


def cures(answer: xr.Dataset) -> list[CureWords]:
    """The table of cures, the smallest change by which a push dies out first.

    Those that are known from any start alone come last; those that were not found are left out.
    """
    return [_words(answer, name) for name in _found(answer)]


def of_a_push(answer: xr.Dataset) -> list[CureWords]:
    """Return the cures that decide whether a small push dies out, the smallest change first.

    They are ordered by the change that is printed first, to the value that is safe from any start.
    Cures without such a value follow.
    """

    def order(name: str) -> tuple[bool, float]:
        safe, push = (
            abs(float(answer[key].sel(cure=name)))
            for key in ("change_any_start", "change")
        )
        if bool(answer.quiet_unless_struck):
            return False, push
        return not math.isfinite(safe), safe if math.isfinite(safe) else push

    names = sorted(_found(answer), key=order)
    table = [_words(answer, name) for name in names]
    return [cure for cure in table if cure.quiet_from != "none"]


def stops(answer: xr.Dataset) -> str:
    """Return the sentences that the table of cures supports."""
    if verdict_of(answer) is not Verdict.quiet:
        return "What stops it"
    if bool(answer.quiet_unless_struck):
        return "How far until a small push is enough"
    return "How far from noise"


def not_cures(answer: xr.Dataset) -> list[tuple[str, str]]:
    """Return the changes that cure nothing, each with the range that was searched."""
    tried = _found(answer)
    return [
        (words_of(answer, str(name)), _range(answer.sel(cure=name)))
        for name in answer.cure.values
        if str(name) not in tried
    ]


def cure_line(cure: CureWords, answer: xr.Dataset) -> str:
    """Return a cure in one line, with the value that is safe from any start first.

    A value from which a small push dies out does not stop a pad that a blow or a sudden start
    makes hammer.
    """
    word = "up to" if verdict_of(answer) is Verdict.quiet else "from"
    push = f"{cure.quiet_from} ({cure.change})"
    safe = f"{cure.any_start} ({cure.change_any_start})"
    if bool(answer.quiet_unless_struck):
        told = f"a small push {_fate_of_push(answer)} up to {push}"
        if cure.any_start not in ("none", NOT_RUN):
            told = f"{told}; quiet from any start at {safe}"
    elif cure.any_start == NOT_RUN:
        fate = _fate_of_push(answer)
        told = f"{word} {push} a small push {fate}; other starts were not run"
    elif cure.any_start == cure.quiet_from:
        told = f"quiet {word} {push}"
    elif cure.any_start == "none":
        told = f"quiet {word} {push} unless struck"
    else:
        told = f"quiet {word} {safe}; {word} {cure.quiet_from} unless struck"
    return f"{cure.words}: now {cure.now}, {told}{_more_intervals(cure.name, answer)}"


def _more_intervals(name: str, answer: xr.Dataset) -> str:
    """Return the quiet intervals beyond the nearest one in words; none if there are none."""
    told = _intervals(answer.sel(cure=name))[1:]
    if not told:
        return ""
    return f"; a push also {_fate_of_push(answer)} at {' and '.join(told)}"


def _fate_of_push(answer: xr.Dataset) -> str:
    """Return what a small push does where steady sliding is stable, as a verb."""
    return "stays small" if _is_neutral(answer) else "dies out"


def _intervals(cure: xr.Dataset) -> list[str]:
    """Return all quiet intervals of a cure in words, the nearest first."""
    name, unit = str(cure.cure.item()), str(cure.unit.item())
    return [
        f"{_value(name, float(low), unit)} to {_value(name, float(high), unit)}"
        for low, high in zip(cure.quiet_low.values, cure.quiet_high.values, strict=True)
        if math.isfinite(low)
    ]


def lines(answer: xr.Dataset) -> Iterator[str]:
    """The answer in ten lines or fewer."""
    yield from first_lines(answer)
    yield from cure_lines(answer)


def first_lines(answer: xr.Dataset) -> Iterator[str]:
    """Yield the lines of the answer but for what stops it."""
    yield headline(answer)
    yield cause(answer)
    yield level(answer)
    yield impacts(answer)
    yield sudden(answer)


def cure_lines(answer: xr.Dataset) -> Iterator[str]:
    """Yield the three smallest changes that stop it, and what else was tried."""
    table = of_a_push(answer)
    if not table:
        yield "No single change within the ranges searched alters the verdict."
        yield from _snap_line(answer)
        return
    yield f"{stops(answer)}, the smallest change first:"
    for cure in table[:CHEAPEST]:
        yield f"  {cure_line(cure, answer)}"
    others = [cure.words for cure in table[CHEAPEST:]]
    known = {cure.name for cure in table}
    every = map(str, answer.cure.values) if is_structure(answer) else NAMES
    vain = [words_of(answer, name) for name in every if name not in known]
    told = [f"also {', '.join(others)}"] if others else []
    told += [f"no answer within the range searched: {', '.join(vain)}"] if vain else []
    if told:
        yield f"  {'; '.join(told)}"
    yield from _snap_line(answer)


def _snap_line(answer: xr.Dataset) -> Iterator[str]:
    """The limits at which the pad jumps and may be as quiet elsewhere, if there are any."""
    if snaps := snap_throughs(answer):
        yield f"Steady sliding jumps to another equilibrium at {', '.join(snaps)}"


def snap_throughs(answer: xr.Dataset) -> list[str]:
    """Tell where steady sliding of a quiet brake jumps to another equilibrium, quiet or not."""
    if "snaps_from" not in answer:
        return []
    told = []
    for name in map(str, answer.cure.values):
        cure = answer.sel(cure=name)
        value = float(cure.snaps_from)
        if math.isfinite(value):
            unit = str(cure.unit.item())
            far = engineering(float(cure.snap_distance), "m", 2)
            told.append(f"{NAMES[name]} {_value(name, value, unit)} ({far} away)")
    return told


def _is_neutral(answer: xr.Dataset) -> bool:
    """Return whether small motions about steady sliding keep their size, apart from round-off."""
    fastest = 2.0 * math.pi * float(answer.mode_frequency.max())
    # an undamped motion grows or decays by round-off alone; relative to the highest frequency,
    # rad/s
    return abs(float(answer.sliding_growth_rate)) <= 1e-7 * fastest


def _found(answer: xr.Dataset) -> list[str]:
    return [
        str(name)
        for name in answer.cure.values
        for cure in [answer.sel(cure=name)]
        if np.isfinite([cure.quiet_from, cure.quiet_from_any_start]).any()
    ]


def _words(answer: xr.Dataset, name: str) -> CureWords:
    cure, words = answer.sel(cure=name), words_of(answer, name)
    unit = str(cure.unit.item())
    # less than a thousandth of the present friction is none: only an undamped flutter needs so
    # little
    is_none = name == "mu" and float(cure.quiet_from) <= 1e-3 * float(cure.value)
    return CureWords(
        name,
        words,
        _value(name, float(cure.value), unit),
        "practically no friction"
        if is_none
        else _value(name, float(cure.quiet_from), unit),
        _change(name, float(cure.change), float(cure.value)),
        _value(name, float(cure.quiet_from_any_start), unit)
        if bool(cure.cure_is_run)
        else NOT_RUN,
        _change(name, float(cure.change_any_start), float(cure.value)),
        "; ".join(_intervals(cure)) or "none",
        _range(cure),
    )


def _range(cure: xr.Dataset) -> str:
    name, unit = str(cure.cure.item()), str(cure.unit.item())
    low, high = (float(cure[end]) for end in ("lowest_tried", "highest_tried"))
    return f"{_value(name, low, unit)} to {_value(name, high, unit)}"


def _value(name: str, value: float, unit: str) -> str:
    if not math.isfinite(value):
        return "none"
    if name.startswith("alpha"):
        return f"{number(float(np.degrees(value)))}°"
    if name in ("damping", "modal_damping"):
        return percent(value, 3)
    if unit == "kg" and 0.0 < value < 0.1:
        return f"{number(1e3 * value)} g"
    return engineering(value if abs(value) > 1e-8 or unit != "1" else 0.0, unit)


def _change(name: str, change: float, value: float) -> str:
    if not math.isfinite(change):
        return "–"
    sign = "+" if change > 0 else "−"
    unit = "°" if name.startswith("alpha") else " %"
    if value == 0.0 and name == "damping":  # of nothing there are no per cent
        unit = " points"
    elif value == 0.0:
        return f"{number(abs(change), 2)} % of the largest tried"
    return f"{sign}{number(abs(change), 2)}{unit}"


def _force(answer: xr.Dataset) -> str:
    newtons = engineering(float(answer.peak_contact_force), "N")
    times = number(float(answer.peak_contact_force_over_preload))
    # the largest force and the largest ratio are often those of two contacts
    if answer.sizes.get("contact", 1) > 1:
        return f"{newtons}, and up to {times} times a contact's preload"
    return f"{newtons}, {times} times the preload force"
