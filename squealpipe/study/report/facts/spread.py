"""Numbers about other settings, other starts and uncertain parameters."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from squealpipe.parameters import SCENES
from squealpipe.schema import Outcome
from squealpipe.schema.linear import LinearRegimeFlag
from squealpipe.schema.spread import TRUNCATION, WIDEST
from squealpipe.study.claims.evidence import Run
from squealpipe.study.figures.parts.origin import angles_of, scene_title
from squealpipe.study.figures.parts.style import flag_words
from squealpipe.study.figures.spread.verdict_reach import WORDS
from squealpipe.study.report.facts.motion import finite_or_none

MOST_CHANGED = 3
FEASIBLE = "feasible parameters"
SIGNS = {"k1": "k₁", "k2": "k₂", "k3": "k₃", "mu": "μ", "alpha1": "α₁", "alpha2": "α₂"}


def reach(run: Run) -> dict[str, Any]:
    """How many verdicts differ from that of the setting as configured, and which never do."""
    dataset = run["verdict_reach"]
    share = dataset.share.values
    judged_in = dict(
        zip(
            dataset.variant.values.tolist(), dataset.judged.values.max(axis=1).tolist(), strict=True
        )
    )
    first, others = share[0], share[1:]
    judged = np.isfinite(others) & np.isfinite(first)
    changed = judged & (np.abs(others - first) > 0.5)
    counts = changed.sum(axis=0)
    names = [WORDS.get(name, name) for name in dataset.statement.values.tolist()]
    order = np.argsort(-counts, kind="stable")
    varies = (judged & (others != first)).any(axis=0)
    return {
        "settings": len(others),
        "statements": len(names),
        "judged": int(judged.sum()),
        "changed": int(changed.sum()),
        "firm": [name for name, moved in zip(names, varies, strict=True) if not moved],
        "least": [f"{names[i]} ({counts[i]})" for i in order[:MOST_CHANGED] if counts[i]],
        "starts": max(count for title, count in judged_in.items() if title.startswith("starts")),
        "feasible": judged_in.get(FEASIBLE),
    }


def basins(run: Run) -> dict[str, Any]:
    """Share of the starts of each scene by the kind of motion."""
    scenes = []
    for name in ("F2d", "F3"):
        dataset = run[f"basin/{name}"]
        words = str(dataset.motion.attrs["flag_meanings"]).split()
        values, counts = np.unique(dataset.motion.values, return_counts=True)
        scenes.append({
            "angles": angles_of(SCENES[name]),
            "parts": [
                {"words": flag_words(words[value]), "share": float(count / counts.sum())}
                for value, count in zip(values, counts, strict=True)
            ],
        })  # fmt: skip
    return {
        "starts": int(run["basin/F3"].motion.size),
        "t_end": float(run["basin/F3"].t_end) / run.parameters.time_unit,
        "scenes": scenes,
    }


STEADY = {
    Outcome.already_unstable: "unstable",
    Outcome.no_sliding_state: "none",
}
"""What steady sliding of A1 is, where no disturbance was looked for."""


def disturbances(run: Run) -> dict[str, Any]:
    """Smallest disturbances of steady sliding by scene, beside the linear verdict."""
    rows = []
    for name in SCENES:
        pair = [f"disturbance/{name}_{goal}" for goal in ("contact_lost", "whirl")]
        if not all(one in run for one in pair):
            continue
        contact, whirl = (run[one] for one in pair)
        outcome = Outcome(int(contact.outcome))
        rows.append({
            "scene": scene_title(name),
            "linear": LinearRegimeFlag(int(contact.regime_linear)).name,
            "steady": STEADY.get(outcome, "stable"),
            "rest": finite_or_none(contact.rest_distance),
            "linear_contact": finite_or_none(contact.linear_distance),
            "contact": finite_or_none(contact.distance),
            "whirl": finite_or_none(whirl.distance),
            "whirl_bound": float(whirl.bound) if outcome not in STEADY else None,
            "spread": [
                finite_or_none(part) for part in (whirl.distance, whirl.improved_distance.max())
            ],
        })  # fmt: skip
    first = run["disturbance/F2a_contact_lost"]
    return {
        "rows": rows,
        "directions": int(first.directions[-1]),
        "t_end": float(first.t_end) / run.parameters.time_unit,
        "share_below": next(
            (
                share
                for name in SCENES
                if f"disturbance/{name}_contact_lost" in run
                and (share := finite_or_none(run[f"disturbance/{name}_contact_lost"].share_below))
            ),
            None,
        ),
        "conditional": [
            row["scene"] for row in rows if row["linear"] == "stable" and row["contact"] is not None
        ],
        "contradicted": [
            row["scene"]
            for row in rows
            if row["linear"] == "stable" and row["steady"] == "unstable"
        ],
    }


def propensity(run: Run) -> dict[str, Any]:
    """Shares with intervals, and the parameter with the largest total index of each quantity."""
    dataset = run["propensity"]
    words = [name.replace("_", " ") for name in dataset.quantity.values.tolist()]
    total = dataset.total_order.values
    supported = np.isfinite(total).all(axis=1)
    half = dataset.half_width_by_size.values[:, -1]
    base = dataset.index_samples.values[:, -1]
    leading = []
    for i in np.flatnonzero(supported):
        best = int(np.argmax(total[i]))
        name = str(dataset.input.values[best])
        low, high = (
            dataset.total_order_low.values[i, best],
            dataset.total_order_high.values[i, best],
        )
        leading.append({
            "words": words[i],
            "input": SIGNS.get(name, name),
            "index": float(total[i, best]),
            "half": float(0.5 * (high - low)),
        })  # fmt: skip
    return {
        "samples": int(dataset.judged),
        "inputs": [SIGNS.get(name, name) for name in dataset.input.values.tolist()],
        "outside": drawn_elsewhere(run),
        "rows": [
            {
                "words": words[i],
                "share": float(dataset.share[i]),
                "low": float(dataset.share_low[i]),
                "high": float(dataset.share_high[i]),
            }
            for i in range(len(words))
        ],
        "leading": leading,
        "unsupported": [
            {"words": words[i], "half": finite_or_none(half[i]), "samples": int(base[i])}
            for i in np.flatnonzero(~supported)
        ],
        "widest": WIDEST,
    }


def drawn_elsewhere(run: Run) -> list[str]:
    """Parameters whose own value in the study lies beyond what is drawn of them.

    A normal distribution is cut off; a lognormal one is rare beyond as many deviations.
    """
    given = json.loads(run["propensity"].attrs.get("arguments", "{}")).get("distributions", {})
    beyond = []
    for name, value in run.parameters.as_dict().items():
        match given.get(name):
            case {"low": low, "high": high}:
                drawn = low <= value <= high
            case {"mean": mean, "std": std}:
                drawn = abs(value - mean) <= TRUNCATION * std
            case {"median": median, "log_std": log_std}:
                drawn = value > 0 and abs(np.log(value / median)) <= TRUNCATION * log_std
            case _:
                continue
        if not drawn:
            beyond.append(SIGNS.get(name, name))
    return beyond
