"""Contents of the report of a structure, as plain data: the answer first."""

import json
from collections.abc import Iterable, Mapping
from itertools import groupby
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.plotting.modes import own_friction
from squealpipe.schema import Outcome, meanings
from squealpipe.store import load
from squealpipe.structures.schema.squealing import NO_ATTRACTOR
from squealpipe.structures.schema.structures import Onset
from squealpipe.study.report import squealing
from squealpipe.study.report.answer import shift
from squealpipe.study.report.answer_content import answer_content
from squealpipe.study.report.media import media_of
from squealpipe.study.report.operating import lines
from squealpipe.study.report.parts import Made, pictures
from squealpipe.study.report.sections import STRUCTURE
from squealpipe.systems.inputs.units import engineering, shown_in
from squealpipe.systems.inputs.words import number, part_of_time, percent


def gather_structure(
    datasets: Mapping[str, Made], figures: Mapping[str, Made]
) -> dict[str, Any]:
    """Content of ``templates/structure.typ``."""
    run = {name: load(made.path) for name, made in datasets.items()}
    modes, answer = run["structure/modes"], run["structure/squeal"]
    told = answer_content(run["structure/assess"])
    told_shift = shift(run["structure/assess"])
    numbers = json.loads(modes.attrs["parameters"])
    was_run = not answer.attrs.get("not_run")
    is_known = was_run and squealing.agrees(answer)
    said = (
        squealing.outside(answer) if is_known else None,
        cause(modes, answer),
        told_shift if is_known else None,
        told["level"] if is_known else squealing.level(answer),
        told["sudden"] if is_known else None,
        squealing.beside(answer),
        *squealing.onset(answer, _critical(modes)),
    )
    return {
        **told,
        "title": "Which mode makes noise? Report of a structure",
        "words": {each.name: each.words for each in Verdict},
        "set": f"mu = {_frictions(numbers)}, {_speed_words(numbers)}",
        "headline": told["headline"] if is_known else squealing.headline(answer),
        "lines": [line for line in said if line],
        "run": was_run,
        "peaks_differ": not (told["quiet"] or bool(run["structure/assess"].periodic)),
        "starts": starts_tried(run["structure/assess"]),
        "moves": bool(run["structure/run"].sizes["time"]),
        "fates": [*squealing.modes(answer), *squealing.missing(answer)],
        "ends": list(squealing.attractors(answer)),
        "operating": operating(run.get("structure/operating")),
        "onsets": onsets(modes),
        "contacts": contacts(answer),
        "points": points(run.get("structure/fewer_points")),
        "structure": structure(modes, answer),
        "rest": not_examined(answer),
        "figures": pictures(STRUCTURE, figures, run),
    }


def starts_tried(answer: xr.Dataset) -> str:
    """Say which starts were tried at other values of what is changed."""
    is_run = answer.cure_is_run
    if is_run.all():
        return (
            "the push, the structure pressed on suddenly, "
            f"{int(answer.random_starts)} random starts, and the vibrations that are there now, "
            "followed while the value changes in small steps."
        )
    return (
        "the push, the structure pressed on suddenly, and the vibration that is there now, at the "
        "nearest quiet value and, where one of them lasts, at values beyond. Runs of this "
        f"structure are long, so that the {int(is_run.sum())} smallest changes alone were run; "
        "those of the others after a push follow from eigenvalues."
    )


def operating(points: xr.Dataset | None) -> list[str]:
    """Return sentences on the operating points; none where no map was asked for."""
    return [] if points is None else [line.strip() for line in lines(points)]


def media_of_structure(datasets: Mapping[str, Made]) -> dict[str, str]:
    """Film and sound of the motion that a small push ends in, as elements of the page."""
    run = load(datasets["structure/run"].path)
    return {"structure": media_of("the structure", run)} if run.sizes["time"] else {}


def _unstable(modes: xr.Dataset) -> list[xr.Dataset]:
    """Modes over friction that grow at the structure's own, the fastest first."""
    place = own_friction(modes)
    at = modes.isel(mu=place)
    order = np.argsort(-at.growth_rate.values, kind="stable")
    return [modes.isel(mode=int(i)) for i in order if bool(at.unstable[i])]


def _critical(modes: xr.Dataset) -> float:
    """The smallest friction at which any mode turns unstable; 0 if one always is, NaN if none."""
    if (modes.onset == Onset.unstable_throughout).any():
        return 0.0
    located = modes.critical_mu.values[np.isfinite(modes.critical_mu.values)]
    return float(located.min()) if located.size else float("nan")


def cause(modes: xr.Dataset, answer: xr.Dataset) -> str:
    """Say why, in a sentence for each of the fastest modes."""
    growing, beyond = _unstable(modes), _beyond(answer)
    if not growing and beyond:
        return f"Cause: not known of the mode at {beyond}, beyond the band that was examined."
    if not growing:
        damped = answer.pole_growth_rate.values.max() < 0
        fades = "small motions die out" if damped else "no small motion grows"
        return f"Steady sliding is stable: {fades}."
    return "Cause: " + "; ".join(_origin(modes, mode) for mode in growing[:3]) + "."


def _beyond(answer: xr.Dataset) -> str:
    """The fastest mode that grows in what was run beyond the band of the modes over friction."""
    limit = squealing.frequency_max(answer)
    above = answer.frequency.values[answer.frequency.values > limit]
    return engineering(float(above[0]), "Hz") if above.size else ""


def _origin(modes: xr.Dataset, mode: xr.Dataset) -> str:
    """Name the source of a mode's growth."""
    frequency = float(mode.frequency[own_friction(modes)])
    if not frequency > 0:
        return "a mode that does not oscillate grows (divergence)"
    if int(mode.onset) == Onset.unstable_throughout:
        return (
            f"the mode at {engineering(frequency, 'Hz')} grows at any friction: friction that "
            "falls with speed, or matrices that are not symmetric, feed it"
        )
    since = (
        f", from mu = {number(float(mode.critical_mu))} on"
        if np.isfinite(mode.critical_mu)
        else ""
    )
    partner = int(mode.merges_with)
    if not partner:
        return (
            f"the mode at {engineering(frequency, 'Hz')} grows without meeting another{since}: "
            "friction that falls with speed, or matrices that are not symmetric, feed it"
        )
    apart = sorted(
        float(modes.sel(mode=each).frequency[0]) for each in (int(mode.mode), partner)
    )
    return (
        f"friction couples the modes that without it are at {engineering(apart[0], 'Hz', 4)} and "
        f"{engineering(apart[1], 'Hz', 4)} until one of them grows{since} (flutter)"
    )


def onsets(modes: xr.Dataset) -> list[dict[str, str]]:
    """A row for each mode that is unstable anywhere in the range, by onset."""
    place = own_friction(modes)
    rows = []
    ever = modes.unstable.any("mu").values
    places = np.flatnonzero(ever).tolist()
    for index in sorted(places, key=lambda place: _since(modes, place)):
        mode = modes.isel(mode=index)
        critical = float(mode.critical_mu)
        words = meanings(modes.onset)[int(mode.onset)].replace("_", " ")
        rows.append(
            {
                "frequency": engineering(float(mode.frequency[place]), "Hz", 4),
                "growth": number(float(mode.growth_rate[place])),
                "critical": number(critical, 4) if np.isfinite(critical) else words,
                "partner": _partner(modes, int(mode.merges_with)),
            }
        )
    return rows


def _since(modes: xr.Dataset, index: int) -> float:
    critical = float(modes.critical_mu[index])
    return critical if np.isfinite(critical) else 0.0


def points(fewer: xr.Dataset | None) -> dict[str, Any]:
    """Return a sentence and a table of what fewer contact points change; none of two or no faces.

    Args:
        fewer: dataset ``fewer_points``, of a structure whose contacts come from faces.
    """
    if fewer is None or fewer.points[-1] <= 2:
        return {"sentence": "", "rows": []}
    rows = [
        {
            "points": str(int(at.points)),
            "contacts": str(int(at.contacts)),
            "unstable": str(int(at.unstable_modes)) if known else "–",
            "growth": _number_or_dash(at.growth_rate),
            "frequency": engineering(float(at.frequency), "Hz", 4)
            if np.isfinite(at.frequency)
            else "–",
        }
        for at in (fewer.isel(points=i) for i in range(fewer.sizes["points"]))
        for known in [int(at.outcome) == Outcome.converged]
    ]
    return {"sentence": _needed_points(fewer), "rows": rows}


def _needed_points(fewer: xr.Dataset) -> str:
    """Tell from which number of points on the same modes grow as fast as with all."""
    most = int(fewer.points[-1])
    each = "" if int(fewer.contacts[-1]) == most else " for each face"
    if int(fewer.outcome[-1]) != Outcome.converged:
        return f"With all {most} points{each}: {_reason(fewer.outcome[-1])}."
    number_of_all, growth = int(fewer.unstable_modes[-1]), float(fewer.growth_rate[-1])
    same = (fewer.outcome == Outcome.converged) & (
        fewer.unstable_modes == number_of_all
    )
    if number_of_all:
        same &= abs(fewer.growth_rate / growth - 1.0) <= 0.1
    # the run of equal answers that ends with all points: one match among others is chance
    first = fewer.sizes["points"] - int(np.argmin([*same.values[::-1], False]))
    below = fewer.isel(points=max(first - 1, 0))
    count = int(below.points)
    several = f"{count} point{'s' if count > 1 else ''}"
    told = f"with {several}{each} {_instead(below, number_of_all, growth)}"
    if first == fewer.sizes["points"] - 1:
        return f"All {most} points{each} are needed: {told}."
    needed = int(fewer.points[first])
    start = f"From {needed} point{'s' if needed > 1 else ''}{each} on"
    if not number_of_all:
        start = f"{start} no mode grows, as with all {most}"
    else:
        start = (
            f"{start} as many modes grow as with all {most}, and the largest growth rate is within "
            "10 % of theirs"
        )
    return f"{start}; {told}." if first else f"{start}."


def _instead(fewer: xr.Dataset, number_of_all: int, growth: float) -> str:
    """Say what fewer points give instead of the unstable modes and growth rate of all."""
    if int(fewer.outcome) != Outcome.converged:
        return f"it is not known ({_reason(fewer.outcome)})"
    if int(fewer.unstable_modes) != number_of_all:
        return f"{int(fewer.unstable_modes)} modes grow instead of {number_of_all}"
    return (
        f"the largest growth rate is {number(float(fewer.growth_rate))} instead of "
        f"{number(growth)} 1/s"
    )


def _reason(outcome: xr.DataArray) -> str:
    return Outcome(int(outcome)).name.replace("_", " ")


def _partner(modes: xr.Dataset, number_: int) -> str:
    """Frequency without friction of the mode that another one meets."""
    if not number_:
        return "–"
    return engineering(float(modes.sel(mode=number_).frequency[0]), "Hz", 4)


def contacts(answer: xr.Dataset) -> list[dict[str, Any]]:
    """Tables of the contacts, one for each motion that lasts."""
    tables: list[dict[str, Any]] = []
    for index in range(min(answer.sizes["attractor"], squealing.LISTED)):
        one = answer.isel(attractor=index)
        if Verdict(int(one.motion)) is Verdict.quiet:
            continue
        newtons = column(one.peak_normal_force.values, "N")
        speeds = column(one.contact_velocity_rms.values, "m s-1")
        rows = [
            {
                "name": str(at.contact.item()),
                "open": part_of_time(float(at.separated_fraction)),
                "stick": part_of_time(float(at.stick_fraction)),
                "force": _number_or_dash(at.peak_force),
                "newtons": newtons[place],
                "impacts": number(float(at.impacts_per_period)),
                "speed": speeds[place],
            }
            for place in range(one.sizes["contact"])
            for at in [one.isel(contact=place)]
        ]
        tables.append(
            {
                "title": f"Motion {len(tables) + 1}, at "
                f"{engineering(float(one.dominant_frequency), 'Hz')}",
                "rows": rows,
            }
        )
    return tables


def column(values: Iterable[float], units: str) -> list[str]:
    """Return the values of a column as text in the unit of the largest; a dash for NaN."""
    every = [float(value) for value in values]
    known = [abs(value) for value in every if np.isfinite(value)]
    factor, name = shown_in(max(known, default=0.0), units)
    return [
        f"{number(factor * value)} {name}".rstrip() if np.isfinite(value) else "–"
        for value in every
    ]


def _number_or_dash(value: xr.DataArray) -> str:
    return number(float(value)) if np.isfinite(value) else "–"


def _modes_words(answer: xr.Dataset) -> str:
    """Return the number of modes, and how many of them are no natural modes."""
    static, total = int(answer.static_responses), int(answer.n_modes)
    return f"{total}, of which {static} static responses" if static else str(total)


def structure(modes: xr.Dataset, answer: xr.Dataset) -> dict[str, Any]:
    """Return the size, friction and contacts of the structure that was run."""
    whole = json.loads(modes.attrs["parameters"])
    contacts_of_file = whole["contacts"]
    meshed = {name: each for name, each in contacts_of_file.items() if "nodes" in each}
    stiffnesses, preloads, speeds = (
        column((each[key] for each in contacts_of_file.values()), units)
        for key, units in (
            ("stiffness", "N m-1"),
            ("preload", "N"),
            ("speed", "m" if "rotation" in whole else "1"),
        )
    )
    gaps = column((each["gap"] for each in meshed.values()), "m")
    static = whole["mu_static"]
    damping = np.atleast_1d(whole["modal_damping"])
    ratios = {float(ratio) for ratio in damping}
    rows = [
        ("Degrees of freedom", str(whole["degrees_of_freedom"])),
        ("Modes in which it was run", _modes_words(answer)),
        ("Friction mu", _frictions(whole)),
        ("Friction law", str(whole["friction_law"]).partition(" ")[0]),
        ("Speed", _speed_words(whole)),
        (
            "Damping ratio of modes",
            f"{number(100 * ratios.pop())} %" if len(ratios) == 1 else "by mode",
        ),
    ]
    if static is not None:
        rows.insert(3, ("Limit of friction in stick", number(static)))
    return {
        "rows": [{"words": words, "value": value} for words, value in rows],
        "speed": "Radius" if "rotation" in whole else "Speed over the belt's",
        "contacts": _alike_in_one_row(
            {
                "name": name,
                "stiffness": stiffness
                + " at the preload" * ("law" in each)
                + _spring_words(each.get("tangential_stiffness")),
                "preload": preload,
                "speed": speed,
            }
            for (name, each), stiffness, preload, speed in zip(
                contacts_of_file.items(), stiffnesses, preloads, speeds, strict=True
            )
        ),
        "origins": [
            {
                "name": name,
                "nodes": _few(each["nodes"]),
                "against": _few(each["against"]) or "belt",
                "area": f"{number(1e6 * each['area'])} mm²",
                "gap": gap,
            }
            for (name, each), gap in zip(meshed.items(), gaps, strict=True)
        ],
    }


def _alike_in_one_row(rows: Iterable[dict[str, str]]) -> list[dict[str, str]]:
    """Merge consecutive rows of a table that differ in nothing but the name."""
    merged: list[dict[str, str]] = []
    for _, group in groupby(rows, lambda row: {**row, "name": ""}):
        alike = list(group)
        name = alike[0]["name"]
        if len(alike) > 1:
            name = f"{name} to {alike[-1]['name']}"
        merged.append(alike[0] | {"name": name})
    return merged


def _spring_words(stiffness: float | None) -> str:
    """Return the words of a spring in series with friction, where there is one."""
    if stiffness is None:
        return ""
    return f", {engineering(stiffness, 'N m-1')} along the belt"


def _frictions(numbers: dict[str, Any]) -> str:
    """Return the coefficient of the contacts, or the range of those of their own."""
    values = [
        contact.get("mu", numbers["mu"]) for contact in numbers["contacts"].values()
    ]
    low, high = min(values), max(values)
    return number(low) if low == high else f"{number(low)} to {number(high)}"


def _speed_words(numbers: dict[str, Any]) -> str:
    """Return the speed of the belt, or of a rotation."""
    if "rotation" in numbers:
        return f"rotation at {engineering(numbers['belt_speed'], 'rad s-1')}"
    return f"belt speed {engineering(numbers['belt_speed'], 'm s-1')}"


def _few(nodes: list[int]) -> str:
    """Return numbers of nodes, the first four of many."""
    more = ", …" if len(nodes) > 4 else ""
    return ", ".join(map(str, nodes[:4])) + more


def not_examined(answer: xr.Dataset) -> list[str]:
    """Return what the answer does not cover, in sentences."""
    errors = [float(answer.frequency_error), float(answer.growth_rate_error)]
    rest = [
        "Wear, heat, the sound that is radiated, and parameters that scatter.",
        "Starts of more energy than the preload stores in the contacts.",
        "What several changes do together, and values beyond the ranges that were searched.",
    ]
    if max(errors) > 0:
        rest.insert(
            1,
            f"What the {int(answer.n_modes)} modes leave out: of the unstable ones frequencies "
            f"are within {percent(errors[0])}, growth rates within {percent(errors[1])} of "
            "the larger of themselves and 1 % of the angular frequency. These errors do not "
            "bound levels: run more modes to see how far a level changes.",
        )
    if np.isfinite(squealing.frequency_max(answer)):
        above = engineering(squealing.frequency_max(answer), "Hz")
        rest.insert(
            1, f"Modes of the whole structure above {above}, whether or not they grow."
        )
    if damped := squealing.damped_beyond(answer):
        rest.insert(2, damped)
    if answer.attrs.get("not_run"):
        rest.insert(0, f"Runs: {answer.attrs['not_run']}.")
    elif "onset_kind" not in answer and answer.sizes["mode"]:
        rest.append(
            "What becomes of the noise as friction falls in small steps. Whether it lasts where a "
            "push dies out is told in the table of changes, at the friction."
        )
    if float(answer.share_undetermined) > 0:
        rest.append("The starts that had not settled at the end of their runs.")
    if (answer.ends_in == NO_ATTRACTOR).any():
        rest.append("What pushes along some modes end in: they had not settled.")
    return rest
