"""Sentences for the page of any study: its friction, its counts, and what an edit changed."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.parameters import (
    DEFAULTS,
    TABLE,
    Parameters,
    direction_of,
    law_in_words,
)
from squealpipe.reading import for_linear, reading_of
from squealpipe.systems.inputs.words import number


def friction_in_words(parameters: Parameters, reading: str) -> str:
    """Describe the friction of A1 beside that of the linear models."""
    belt = direction_of(for_linear(parameters, reading).belt_speed)
    sides = {1: "+x", -1: "−x"}
    if reading_of(reading).a1_model == "A1-as-printed":
        way = (
            f"A1 has Eq. (4) as printed, which pushes a mass slower than the belt along "
            f"{sides[-belt]}; the linear models are dragged along {sides[belt]}"
        )
    else:
        way = f"Friction drags along {sides[belt]} in A1 and in the linear models"
    values = {
        name: value
        for name, value in parameters.as_dict().items()
        if name in ("mu", "mu_static", "friction_speed")
        and name not in parameters.in_laws
    }
    listed = ", ".join(f"{name} = {number(value)}" for name, value in values.items())
    law = law_in_words(parameters.friction_law)
    return f"{way}. Law of friction: {law}{f' ({listed})' if listed else ''}."


def is_physical(key: str) -> bool:
    """Return whether a key of the configuration changes the physics."""
    # the other keys change how finely the study computes
    return key.startswith(("parameters.", "reading"))


def what_changed(changed: Sequence[tuple[str, Any, Any]]) -> str:
    """The physical keys that were edited, in one sentence."""
    keys = [(key, old, new) for key, old, new in changed if is_physical(key)]
    if not keys:
        return (
            "Parameters and reading are those of the shipped study; verdicts that differ do so "
            "because of the other keys listed below."
        )
    listed = "; ".join(
        f"{_name(key)}: {_value(key, new)} (shipped: {_value(key, old)})"
        for key, old, new in keys
    )
    return f"Physics that was edited: {listed}."


def undecided(statements: Sequence[Mapping[str, Any]]) -> list[dict[str, str]]:
    """List the reasons why statements were not decided, each with the statements it concerns."""
    reasons: dict[str, list[str]] = {}
    for row in statements:
        if row["verdict"] == ClaimVerdict.cannot_be_decided.words:
            reason = re.sub(
                r"^Not decided: (the run has no dataset [^:]+: )?", "", row["evidence"]
            ).replace("it is not part", "what is needed is not part", 1)
            reasons.setdefault(reason, []).append(row["id"])
    return [{"why": why, "ids": ", ".join(ids)} for why, ids in reasons.items()]


def _name(key: str) -> str:
    name = key.removeprefix("parameters.")
    if name not in TABLE:
        return name
    return f"{name} ({TABLE[name].meaning.partition(':')[0]})"


def _value(key: str, value: Any) -> str:
    if key == "reading":
        return reading_of(value).meaning
    if value is None:  # parameters beyond the paper's are left out at their defaults
        value = DEFAULTS[key.removeprefix("parameters.")]
    if value is None:
        return "not given"
    return number(value) if isinstance(value, int | float) else str(value)
