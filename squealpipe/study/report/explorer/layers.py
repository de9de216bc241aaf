"""What the explorer's map can show: one quantity over both angles, from a stored dataset."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from squealpipe.plotting.style import REGIME_COLOURS, flag_words
from squealpipe.schema import meanings
from squealpipe.schema.dynamics.runs import MotionFlag
from squealpipe.schema.ladder import Level
from squealpipe.study.figures.comparison.model_ladder import colour_of


@dataclass(frozen=True, kw_only=True)
class Layer:
    """A quantity over both angles.

    Attributes:
        label: its name in the chooser.
        unit: its unit, empty where dimensionless or a category.
        alpha1, alpha2: angles, rad.
        values: (alpha1, alpha2); NaN where there is none.
        note: what NaN means, or what else to know.
        meanings: code → name, for categories.
        colours: code → colour, for categories.
    """

    label: str
    unit: str
    alpha1: np.ndarray
    alpha2: np.ndarray
    values: np.ndarray
    note: str = ""
    meanings: Mapping[int, str] = field(default_factory=dict)
    colours: Mapping[int, str] = field(default_factory=dict)


def quantity(variable: xr.DataArray, label: str, *, note: str = "") -> Layer:
    """A layer of numbers."""
    unit = str(variable.attrs["units"])
    return Layer(
        label=label,
        unit="" if unit == "1" else unit.replace(" s-1", "/s").replace("s-1", "1/s"),
        alpha1=variable.alpha1.values,
        alpha2=variable.alpha2.values,
        values=variable.values.astype(float),
        note=note,
    )


def category(variable: xr.DataArray, label: str, *, colours: Mapping[str, str]) -> Layer:
    """A layer of categories: a flag variable, in the colours that figures use.

    Raises:
        KeyError: a meaning that occurs has no colour.
    """
    table = meanings(variable)
    present = np.unique(variable.values).tolist()
    return Layer(
        label=label,
        unit="",
        alpha1=variable.alpha1.values,
        alpha2=variable.alpha2.values,
        values=variable.values.astype(float),
        meanings={code: flag_words(table[code]) for code in present},
        colours={code: colours[table[code]] for code in present},
    )


def cheapest(ladder: xr.Dataset, question: str) -> Layer:
    """The cheapest adequate model for a question, named and coloured as in the ladder's figure."""
    levels = ladder.cheapest.sel(question=question)
    codes = np.unique(levels.values).tolist()
    present = [level for level in Level if level in codes]
    return Layer(
        label=f"cheapest model: {question.replace('_', ' ')}",
        unit="",
        alpha1=levels.alpha1.values,
        alpha2=levels.alpha2.values,
        values=levels.values.astype(float),
        meanings={int(level): level.label for level in present},
        colours={int(level): colour_of(level) for level in present},
    )


def layers(
    *,
    validity: xr.Dataset,
    stability: xr.Dataset | None = None,
    frequencies: xr.Dataset | None = None,
    hammering: xr.Dataset | None = None,
    ladder: xr.Dataset | None = None,
) -> dict[str, Layer]:
    """All layers, in the order of the chooser; those of datasets that a study lacks are left out.

    Args:
        validity: dataset ``validity_map``.
        stability: dataset ``stability_map``.
        frequencies: dataset ``natural_frequencies``.
        hammering: dataset ``hammering_map``.
        ladder: dataset ``model_ladder``.
    """
    found = {}
    if hammering is not None:
        motion = hammering.motion.where(hammering.motion_changed == 0, MotionFlag.unsettled)
        found["motion"] = category(motion, "motion (A1)", colours=REGIME_COLOURS)
    regime = (validity if stability is None else stability).regime_linear
    found["stability"] = category(regime, "linear stability (A3)", colours=REGIME_COLOURS)
    found["first_separation"] = quantity(
        validity.first_separation_time,
        "first separation",
        note="blank: contact is kept to the end of the run",
    )
    if hammering is not None:
        found |= {
            "peak_force": quantity(hammering.peak_contact_force, "peak contact force / (k₃ lₚᵣₑ)"),
            "impact_rate": quantity(hammering.impact_rate, "impacts per time"),
            "predictability": quantity(
                hammering.predictability_horizon,
                "predictable until",
                note="beyond it a single run means nothing; the largest value is the end of the "
                "runs",
            ),
        }
    if stability is not None:
        found["growth_rate"] = quantity(stability.growth_rate, "growth rate (A3)")
    if frequencies is not None:
        for state, words in (("contact", "in contact"), ("separated", "separated")):
            for mode in (1, 2):
                chosen = frequencies.omega.sel(mode=mode, contact_state=state)
                found[f"omega{mode}_{state}"] = quantity(chosen, f"ω{'₁₂'[mode - 1]} {words}")
    if ladder is not None:
        for question in ladder.question.values:
            found[f"cheapest_{question}"] = cheapest(ladder, str(question))
    return found
