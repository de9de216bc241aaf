"""Results of the benchmark as JSON: to cite, to ship, and to compare with."""

import json
import math
from collections.abc import Iterable, Sequence
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.benchmark.problems import all_data
from squealpipe.benchmark.schema import Reliability
from squealpipe.benchmark.scoring import BENCHMARK_VERSION, Score, Stored

INPUT_FILES = ("results.json",)
SHIPPED = "shipped"
"""Stands for the results that come with the package, in place of a file's name."""
COUNTS = ("missed", "spurious", "out_of_order", "evaluations")
SCORED_NUMBERS = ("error", "time_error", "cpu_ratio")


def results_as_json(datasets: Iterable[xr.Dataset]) -> str:
    """Datasets ``benchmark`` as one JSON text, a line for each problem and solver.

    Raises:
        ValueError: a solver is in two of them, or they have other tolerances or problems judged
            by another version.
    """
    datasets = list(datasets)
    said = {
        (dataset.attrs["benchmark_version"], tuple(dataset.tol.values.tolist()))
        for dataset in datasets
    }
    if len(said) != 1:
        raise ValueError(
            "results of one benchmark_version and one list of tolerances are needed, not of "
            f"{sorted(said)}"
        )
    ((benchmark_version, tolerances),) = said
    solvers: dict[str, dict[str, str]] = {}
    lines = []
    for dataset in datasets:
        for name in dataset.solver.values.tolist():
            if name in solvers:
                raise ValueError(f"two results of {name!r}")
            solvers[name] = origin_of(dataset, name)
            lines += [_entry(dataset, problem, name) for problem in dataset.problem]
    head = {
        "benchmark_version": int(benchmark_version),
        "tolerances": list(tolerances),
        "solvers": solvers,
    }
    text = json.dumps(head, ensure_ascii=False, indent=1).removesuffix("\n}")
    body = ",\n".join(json.dumps(line, ensure_ascii=False) for line in lines)
    return f'{text},\n "results": [\n{body}\n]}}\n'


def origin_of(dataset: xr.Dataset, solver: str) -> dict[str, str]:
    """Package and processor of a solver's answers; of older datasets both are attributes."""
    if "processor" in dataset.variables:
        one = dataset.sel(solver=solver)
        return {name: str(one[name].item()) for name in ("package", "processor")}
    packages = json.loads(dataset.attrs.get("solver_versions", "{}"))
    return {
        "package": packages.get(solver, "unknown"),
        "processor": dataset.attrs.get("processor", "unknown"),
    }


def _entry(dataset: xr.Dataset, problem: xr.DataArray, solver: str) -> dict[str, Any]:
    cells = dataset.sel(problem=problem, solver=solver)
    entry: dict[str, Any] = {"problem": str(problem.item()), "solver": solver}
    entry["verdict"] = [Reliability(v).name for v in cells.verdict.values.tolist()]
    entry |= {name: cells[name].values.tolist() for name in COUNTS}
    # three digits: errors and CPU times are compared by their decades
    digits = 3
    for name in SCORED_NUMBERS:
        values = cells[name].values.tolist()
        entry[name] = [
            float(f"{value:.{digits}g}") if math.isfinite(value) else None
            for value in values
        ]
    return entry | {"message": cells.message.values.tolist()}


def read_results(path: Path | str) -> xr.Dataset:
    """Verdicts over (problem, solver, tol) of a JSON text that ``results_as_json`` made.

    Args:
        path: the file, or ``"shipped"``.

    Raises:
        ValueError: the file is none.
    """
    try:
        table = (
            shipped()
            if str(path) == SHIPPED
            else json.loads(Path(path).read_text("utf-8"))
        )
        verdicts = {
            (str(entry["problem"]), str(entry["solver"])): [
                int(Reliability[name]) for name in entry["verdict"]
            ]
            for entry in table["results"]
        }
        problems, solvers = (
            list(dict.fromkeys(names)) for names in zip(*verdicts, strict=True)
        )
        tolerances = [float(tolerance) for tolerance in table["tolerances"]]
        none = [int(Reliability.not_applicable)] * len(tolerances)
        cells = [[verdicts.get((p, s), none) for s in solvers] for p in problems]
        coordinates = {"problem": problems, "solver": solvers, "tol": tolerances}
        verdict = xr.DataArray(np.array(cells), coordinates, [*coordinates])
        version = int(table["benchmark_version"])
    except (ValueError, TypeError, KeyError) as error:
        what = f"{type(error).__name__}: {error}"
        raise ValueError(f"{path} is no JSON of results ({what})") from None
    return verdict.to_dataset(name="verdict").assign_attrs(benchmark_version=version)


@cache
def shipped() -> dict[str, Any]:
    """The results that come with the package, with package and processor of each solver."""
    text = (files("squealpipe.benchmark") / "results.json").read_text("utf-8")
    results: dict[str, Any] = json.loads(text)
    return results


def shipped_answers(solver: str, tolerances: Sequence[float]) -> Stored | None:
    """Answers of a solver that come with the package.

    Returns:
        None if no answers of this solver are shipped.

    Raises:
        ValueError: a tolerance is not among those of the shipped results.
    """
    table = shipped()
    if (
        solver not in table["solvers"]
        or table["benchmark_version"] != BENCHMARK_VERSION
    ):
        return None
    known = [float(tolerance) for tolerance in table["tolerances"]]
    if missing := [tol for tol in tolerances if tol not in known]:
        raise ValueError(
            f"tolerance {missing[0]:g}: answers of {solver} are shipped at "
            f"{', '.join(f'{tol:g}' for tol in known)}; take one of these, or set "
            "comparison.benchmark.run_peers to true"
        )
    columns = [known.index(tol) for tol in tolerances]
    unknowable = {data["name"] for data in all_data() if "unknowable" in data}
    scores: dict[str, list[Score]] = {
        entry["problem"]: [
            _score_of(entry, column, answerable=entry["problem"] not in unknowable)
            for column in columns
        ]
        for entry in table["results"]
        if entry["solver"] == solver
    }
    return Stored(scores, table["solvers"][solver])


def _score_of(entry: dict[str, Any], column: int, *, answerable: bool) -> Score:
    verdict = Reliability[entry["verdict"][column]]
    numbers: dict[str, Any] = {
        name: math.nan if entry[name][column] is None else entry[name][column]
        for name in SCORED_NUMBERS
    }
    # JSON has no infinity: of a problem with an answer a missing error is that of no state
    if verdict and entry["error"][column] is None and answerable:
        numbers["error"] = math.inf
    counts = {name: entry[name][column] for name in COUNTS}
    return Score(verdict, message=entry["message"][column], **counts, **numbers)
