"""Layers of the explorer's map: one quantity over both angles, from a stored dataset."""

from collections.abc import Mapping
from typing import NamedTuple

import xarray as xr

from squealpipe.brake.schema.dynamics.runs import MotionFlag
from squealpipe.brake.schema.ladder import Level
from squealpipe.codes import flag_words
from squealpipe.plotting.style import REGIME_COLOURS, colour_of
from squealpipe.schema import meanings


class Layer(NamedTuple):
    """A quantity over both angles.

    Attributes:
        map: over alpha1 and alpha2; NaN where there is none.
        note: what NaN means, or what else to know.
        meanings: code → name, for categories.
    """

    label: str
    map: xr.DataArray
    note: str = ""
    meanings: Mapping[int, str] = {}
    colours: Mapping[int, str] = {}


def _categories(
    label: str,
    values: xr.DataArray,
    words: Mapping[int, str],
    colours: Mapping[int, str],
) -> Layer:
    """A layer of categories, with those that occur."""
    present = [code for code in words if (values == code).any()]
    named = {code: words[code] for code in present}
    return Layer(label, values, "", named, {code: colours[code] for code in present})


def _regimes(label: str, flag: xr.DataArray) -> Layer:
    """A layer of a flag variable, in the colours that figures use."""
    table = meanings(flag)
    colours = {code: REGIME_COLOURS[name] for code, name in table.items()}
    return _categories(
        label, flag, {k: flag_words(name) for k, name in table.items()}, colours
    )


def _of_verdicts(verdicts: xr.Dataset | None) -> dict[str, Layer]:
    if verdicts is None:
        return {}
    growth = verdicts.sliding_growth_rate
    return {
        "verdict": _regimes("verdict", verdicts.verdict),
        "growth": Layer("growth of small motions", growth, "blank: no steady sliding"),
    }


def _of_contact(
    validity: xr.Dataset | None, stability: xr.Dataset | None
) -> dict[str, Layer]:
    layers = {}
    regimes = validity if stability is None else stability
    if regimes is not None:
        layers["stability"] = _regimes("linear stability (A3)", regimes.regime_linear)
    if validity is not None:
        layers["first_separation"] = Layer(
            "first separation",
            validity.first_separation_time,
            "blank: contact is kept to the end of the run",
        )
    return layers


def layers(
    *,
    validity: xr.Dataset | None = None,
    stability: xr.Dataset | None = None,
    frequencies: xr.Dataset | None = None,
    hammering: xr.Dataset | None = None,
    ladder: xr.Dataset | None = None,
    verdicts: xr.Dataset | None = None,
) -> dict[str, Layer]:
    """All layers, in the order of the chooser; those of missing datasets are left out."""
    by_name = {}
    levels = {int(level): level.label for level in Level}
    colours = {int(level): colour_of(level) for level in Level}
    if hammering is not None:
        motion = hammering.motion.where(
            hammering.motion_changed == 0, MotionFlag.unsettled
        )
        by_name["motion"] = _regimes("motion (A1)", motion)
    by_name |= _of_verdicts(verdicts) | _of_contact(validity, stability)
    if hammering is not None:
        by_name |= {
            "peak_force": Layer(
                "peak contact force / (k₃ lₚᵣₑ)", hammering.peak_contact_force
            ),
            "impact_rate": Layer("impacts per time", hammering.impact_rate),
            "predictability": Layer(
                "predictable until (at most the end of the run)",
                hammering.predictability_horizon,
                "beyond it a single run means nothing; the largest value is the end of the runs",
            ),
        }
    if stability is not None:
        by_name["growth_rate"] = Layer("growth rate (A3)", stability.growth_rate)
    if frequencies is not None:
        for state, words in (("contact", "in contact"), ("separated", "separated")):
            for mode in (1, 2):
                chosen = frequencies.omega.sel(mode=mode, contact_state=state)
                by_name[f"omega{mode}_{state}"] = Layer(
                    f"ω{'₁₂'[mode - 1]} {words}", chosen
                )
    if ladder is not None:
        for question in ladder.question.values.tolist():
            cheapest = ladder.cheapest.sel(question=question)
            label = f"cheapest model: {question.replace('_', ' ')}"
            by_name[f"cheapest_{question}"] = _categories(
                label, cheapest, levels, colours
            )
    return by_name
