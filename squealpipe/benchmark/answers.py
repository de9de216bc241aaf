"""Problems and answers as JSON, for solvers in another language."""

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.benchmark.problems import all_data, references
from squealpipe.benchmark.schema import Reliability
from squealpipe.benchmark.scoring import (
    BENCHMARK_VERSION,
    Score,
    dataset_of,
    failed,
    score,
)


def problems_as_json() -> str:
    """All problems with their equations, and their references, as one JSON text."""
    truth = references()
    entries = [{**data, "reference": truth[data["name"]]} for data in all_data()]
    table = {"benchmark_version": BENCHMARK_VERSION, "problems": entries}
    return json.dumps(table, ensure_ascii=False, indent=1)


def score_answers(path: str | os.PathLike[str]) -> xr.Dataset:
    """Dataset ``benchmark`` of the answers in a JSON file.

    The file holds ``solver``, its name, optionally ``processor``, on which it ran, and
    ``answers``, a list of objects with ``problem``, ``tolerance``, ``times`` and ``kinds`` (null
    where no events are reported), ``state``, and where there are any ``evaluations``, ``flag``,
    ``derivative`` and ``cpu_time`` in s. A problem that has no answer at a tolerance cannot be
    asked.

    Raises:
        ValueError: the file is no JSON, or an answer has a key too few or one that is unknown.
    """
    try:
        table = json.loads(Path(path).read_text("utf-8"))
    except ValueError as error:
        raise ValueError(f"{path} is no JSON: {error}") from None
    if not isinstance(table, Mapping) or not {"solver", "answers"} <= set(table):
        raise ValueError(f"{path}: an object with 'solver' and 'answers' is needed")
    if not isinstance(table["solver"], str) or not table["solver"].strip():
        raise ValueError(f"{path}: solver {table['solver']!r}: its name is needed")
    if not isinstance(table["answers"], list):
        raise ValueError(f"{path}: 'answers' is no list")  # noqa: TRY004 (of a file)
    known = {data["name"]: data for data in all_data()}
    truth = references()
    scores: dict[tuple[str, float], Score] = {}
    for number, answer in enumerate(table["answers"]):
        place = f"{path}: answer {number}"
        _check(place, answer, known)
        name = answer["problem"]
        cell = name, float(answer["tolerance"])
        if cell in scores:
            raise ValueError(f"{place}: {name!r} has an answer at {cell[1]:g} already")
        scores[cell] = _score(known[name], truth[name], answer)
    if not scores:
        raise ValueError(f"{path} holds no answers")
    chosen = [data for name, data in known.items() if any(c[0] == name for c in scores)]
    tolerances = sorted({tol for _, tol in scores}, reverse=True)
    none = Score(Reliability.not_applicable)
    cells = [
        [[scores.get((data["name"], tol), none) for tol in tolerances]]
        for data in chosen
    ]
    machine = str(table.get("processor") or "unknown")
    return dataset_of(chosen, [table["solver"]], tolerances, cells, machine)


def _check(place: str, answer: Any, known: Mapping[str, Any]) -> None:
    if not isinstance(answer, Mapping):
        raise ValueError(  # noqa: TRY004 (of a file, not of an argument)
            f"{place} is {answer!r}; an object is needed"
        )
    needed_keys = ("problem", "tolerance", "times", "kinds", "state")
    for key in needed_keys:
        if key not in answer:
            raise ValueError(f"{place} lacks {key!r}")
    # an answer may leave these out; what is left out is not judged
    optional_keys = ("evaluations", "flag", "derivative", "cpu_time")
    for key in answer:
        if key not in (*needed_keys, *optional_keys):
            allowed = ", ".join((*needed_keys, *optional_keys))
            raise ValueError(f"{place}: {key!r} is unknown; one of {allowed}")
    if not isinstance(answer["problem"], str) or answer["problem"] not in known:
        raise ValueError(
            f"{place}: problem {answer['problem']!r} is unknown; one of {'; '.join(known)}"
        )
    tolerance = answer["tolerance"]
    if not _is_number(tolerance) or not tolerance > 0.0:
        raise ValueError(
            f"{place}: tolerance {tolerance!r}: a number above 0 is needed"
        )
    for key in ("evaluations", "cpu_time"):
        value = answer.get(key)
        if value is not None and not (_is_number(value) and value >= 0.0):
            raise ValueError(
                f"{place}: {key} {value!r}: a number that is not negative is needed, or null"
            )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _score(
    data: Mapping[str, Any], truth: Mapping[str, Any], answer: Mapping[str, Any]
) -> Score:
    parts: Sequence[Any] = (
        answer["times"],
        answer["kinds"],
        answer["state"],
        answer.get("evaluations") or 0,
        answer.get("flag", ""),
        answer.get("derivative"),
    )
    try:
        scored = score(data, truth, parts, float(answer["tolerance"]))
    except (TypeError, ValueError) as failure:
        scored = failed(data, f"{type(failure).__name__}: {failure}")
    spent = answer.get("cpu_time")
    return scored._replace(cpu_time=np.nan if spent is None else float(spent))
