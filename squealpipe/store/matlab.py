"""Datasets as MATLAB files, whose names are short and of ASCII letters."""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path

import xarray as xr

from squealpipe.schema import meanings

LONGEST_NAME = 63
KEYWORDS = frozenset(
    {
        "break",
        "case",
        "catch",
        "classdef",
        "continue",
        "else",
        "elseif",
        "end",
        "for",
        "function",
        "global",
        "if",
        "otherwise",
        "parfor",
        "persistent",
        "return",
        "spmd",
        "switch",
        "try",
        "while",
    }
)


def write_matlab(dataset: xr.Dataset, about: Mapping[str, str], path: Path) -> None:
    """Write all arrays as they are, and structures that say what they are.

    Args:
        about: texts for the structure ``attributes``.
    """
    from scipy.io import savemat

    variables = {str(name): variable for name, variable in dataset.variables.items()}
    # a file holds these beside its arrays; no array takes their names
    names = matlab_names(variables, ("units", "meanings", "attributes", "names"))
    content: dict[str, object] = {
        names[name]: variable.values.astype(object)
        if variable.dtype.kind in "UO"
        else variable.values
        for name, variable in variables.items()
    }
    content["units"] = {
        names[name]: str(variable.attrs["units"])
        for name, variable in variables.items()
        if "units" in variable.attrs
    }
    content["meanings"] = {
        names[name]: ", ".join(f"{value}: {words}" for value, words in table.items())
        for name in variables
        if (table := meanings(dataset[name]))
    }
    stated = matlab_names(about)
    content["attributes"] = {stated[key]: text for key, text in about.items()}
    content["names"] = {short: name for name, short in names.items()}
    savemat(path, content, appendmat=False, long_field_names=True, oned_as="column")


def matlab_names(names: Iterable[str], taken: Iterable[str] = ()) -> dict[str, str]:
    """Name → a name that MATLAB takes; those that are one already stay, and none comes twice."""
    names, used = list(names), {*taken}
    renamed = {name: name for name in names if _is_name(name) and name not in used}
    used |= {*renamed}
    for name in names:
        if name not in renamed:
            plain = _plain(name)
            short, number = plain[:LONGEST_NAME], 1
            while short in used or short in KEYWORDS:
                number += 1
                short = f"{plain[: LONGEST_NAME - 1 - len(str(number))]}_{number}"
            renamed[name] = short
            used.add(short)
    return {name: renamed[name] for name in names}


def _is_name(name: str) -> bool:
    fits = re.fullmatch(r"[A-Za-z]\w*", name, re.ASCII) and len(name) <= LONGEST_NAME
    return bool(fits) and name not in KEYWORDS


def _plain(name: str) -> str:
    """ASCII letters, digits and _ for a name: a leading _ goes behind, θ becomes u3b8."""
    rest = name.lstrip("_")
    moved = rest + "_" * (len(name) - len(rest))
    text = "".join(
        letter if re.fullmatch(r"\w", letter, re.ASCII) else _code(letter)
        for letter in moved
    )
    return text if re.match("[A-Za-z]", text) else f"x{text}"


def _code(letter: str) -> str:
    return "_" if letter.isascii() else f"u{ord(letter):x}"
