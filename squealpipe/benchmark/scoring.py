"""What an answer is worth: its events against the reference's, its error over the growth."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.optimize import linear_sum_assignment

from squealpipe.benchmark.adapters.scipy import solve as reference_solver
from squealpipe.benchmark.problems import Problem, all_data, references
from squealpipe.schema import build
from squealpipe.schema.comparison import BENCHMARK, Reliability, Role

BENCHMARK_VERSION = 1
"""Goes up with each problem that is added; none is ever changed or removed."""
TOLERANCES = (1e-6, 1e-8, 1e-10, 1e-12)
ALLOWED = 100.0
"""Error over growth, in tolerances, up to which an answer is right."""
REFERENCE_TOLERANCE = 1e-8
"""Of DOP853, whose CPU time is the unit of ``cpu_ratio``."""


class Score(NamedTuple):
    """What one answer is worth; names as in the dataset."""

    verdict: Reliability
    missed: int = -1
    spurious: int = -1
    out_of_order: int = -1
    time_error: float = np.nan
    error: float = np.nan
    message: str = ""
    evaluations: int = 0
    cpu_time: float = np.nan
    cpu_ratio: float = np.nan

    @property
    def words(self) -> str:
        """The score as text: the verdict, then what is wrong."""
        found = [
            f"{count} {name}"
            for count, name in (
                (self.missed, "missed"),
                (self.spurious, "spurious"),
                (self.out_of_order, "out of order"),
            )
            if count > 0
        ]
        if self.verdict > Reliability.right and np.isfinite(self.error):
            found.append(f"error {self.error:.1e}")
        found += [self.message] * bool(self.message)
        verdict = self.verdict.name.replace("_", " ")
        return f"{verdict} ({', '.join(found)})" if found else verdict


def score(
    data: Mapping[str, Any], reference: Mapping[str, Any], answer: Sequence[Any], tol: float
) -> Score:
    """Judge one answer.

    Args:
        data: the problem.
        reference: its final state, events, growth and margin.
        answer: times, kinds, state, evaluations, and optionally a flag and a derivative; times and
            kinds are None where a method reports no events.
        tol: what was asked for.
    """
    times, kinds, state, evaluations, *more = answer
    flag, slope = more[0] if more else "", more[1] if len(more) > 1 else None
    if "unknowable" in data:
        verdict = Reliability.flagged if flag else Reliability.silently_wrong
        return Score(verdict, message=flag, evaluations=evaluations)
    error = largest(state, reference["state"], reference["growth"])
    missed = spurious = swapped = -1
    time_error, wrong = np.nan, False
    if times is not None:
        pairs, missed, spurious = matched(reference, times, kinds)
        mine, truth, growth = (
            np.array(each, float) for each in (times, reference["times"], reference["time_growth"])
        )
        swapped = out_of_order(pairs, truth, ALLOWED * tol * growth)
        found = [(mine[j], truth[i], growth[i]) for i, j in pairs]
        time_error = max((largest([a], [b], 1.0) for a, b, _ in found), default=0.0)
        if knowable := ALLOWED * tol <= reference["margin"]:
            error = max([error, *(largest([a], [b], g) for a, b, g in found)])
        wrong = knowable and max(missed, spurious, swapped) > 0
    if slope is not None and data.get("derivative"):
        error = max(error, largest([slope], [reference["derivative"]], reference["growth"]))
    right = not wrong and error <= ALLOWED * tol
    wrong_verdict = Reliability.flagged if flag else Reliability.silently_wrong
    verdict = Reliability.right if right else wrong_verdict
    return Score(verdict, missed, spurious, swapped, time_error, error, flag, evaluations)


def largest(found: Sequence[float], truth: Sequence[float], growth: float) -> float:
    """Largest difference, relative where the truth is above 1, over the growth."""
    a, b = np.array(found, float), np.array(truth, float)
    if a.shape != b.shape or not np.isfinite(a).all():
        return np.inf
    return float(np.max(np.abs(a - b) / np.maximum(1.0, np.abs(b)), initial=0.0) / growth)


def matched(
    reference: Mapping[str, Any], times: Sequence[float], kinds: Sequence[str]
) -> tuple[list[tuple[int, int]], int, int]:
    """Pairs (event of the reference, event found) of one kind, nearest first; missed; spurious."""
    pairs: list[tuple[int, int]] = []
    for kind in {*kinds, *reference["kinds"]}:
        mine = [j for j, each in enumerate(kinds) if each == kind]
        theirs = [i for i, each in enumerate(reference["kinds"]) if each == kind]
        ours, truth = np.array(times, float)[mine], np.array(reference["times"])[theirs]
        rows, columns = linear_sum_assignment(np.abs(truth[:, None] - ours[None, :]) ** 0.5)
        pairs += [(theirs[i], mine[j]) for i, j in zip(rows, columns, strict=True)]
    return sorted(pairs), len(reference["kinds"]) - len(pairs), len(kinds) - len(pairs)


def out_of_order(pairs: Sequence[tuple[int, int]], truth: np.ndarray, resolved: np.ndarray) -> int:
    """Events found before one that they follow, by more time than the tolerance resolves."""
    late = [
        any(j > k and truth[i] - truth[before] > resolved[i] for before, j in pairs[:place])
        for place, (i, k) in enumerate(pairs)
    ]
    return sum(late)


def measure(data: Mapping[str, Any], solve: Callable[..., Any], tol: float) -> Score:
    """Ask one solver one problem; an exception flags its answer."""
    problem = Problem(data)
    started = time.process_time()
    try:
        answer = solve(problem, tol)
    except NotImplementedError as refusal:
        return Score(Reliability.not_applicable, message=str(refusal)[:64])
    except Exception as failure:  # noqa: BLE001 (whatever a solver raises is its flag)
        flag = f"{type(failure).__name__}: {failure}"[:64]
        nowhere = [np.nan] * len(problem.states)
        answer = None, None, nowhere, problem.calls, flag
    spent = time.process_time() - started
    found = score(data, references()[data["name"]], answer, tol)
    return found._replace(cpu_time=spent, message=found.message[:64])


def benchmark(
    solvers: Mapping[str, Callable[..., Any]],
    *,
    names: Sequence[str] = (),
    tolerances: Sequence[float] = TOLERANCES,
    done: Callable[[str, str, list[Score]], None] = lambda *_: None,
) -> xr.Dataset:
    """Dataset ``benchmark``: every solver on every problem at every tolerance.

    Args:
        solvers: name → ``solve(problem, tol)``.
        names: of the problems; all by default.
        tolerances: each solver gets the same.
        done: called with problem, solver and its scores.

    Raises:
        ValueError: a problem is unknown.
    """
    known = {data["name"]: data for data in all_data()}
    if unknown := [name for name in names if name not in known]:
        raise ValueError(f"problem {unknown[0]!r} is unknown; known: {', '.join(known)}")
    chosen = [known[name] for name in names or known]
    rows: list[list[list[Score]]] = []
    for data in chosen:
        unit = measure(data, reference_solver, REFERENCE_TOLERANCE).cpu_time
        rows.append([])
        for name, solve in solvers.items():
            measure(data, solve, tolerances[0])  # compiles before any stopwatch runs
            found = [measure(data, solve, tol) for tol in tolerances]
            rows[-1].append([each._replace(cpu_ratio=each.cpu_time / unit) for each in found])
            done(data["name"], name, rows[-1][-1])
    columns = {
        field: [[[getattr(s, field) for s in row] for row in rows_of] for rows_of in rows]
        for field in Score._fields
    }
    groups = [data["class"] for data in chosen]
    ours = [Role.ours if name == "squealpipe" else Role.public for name in solvers]
    return build(
        BENCHMARK,
        {**columns, "group": groups, "role": ours},
        {
            "problem": [data["name"] for data in chosen],
            "solver": list(solvers),
            "tolerance": list(tolerances),
        },
        {"benchmark_version": BENCHMARK_VERSION},
    )


def silently_wrong(dataset: xr.Dataset) -> int:
    """Answers that are wrong without a flag."""
    return int((dataset.verdict == Reliability.silently_wrong).sum())


def differences(one: xr.Dataset, other: xr.Dataset) -> Iterable[tuple[str, str, str]]:
    """Problem, and the verdicts of two datasets at each tolerance that both have."""
    for problem in one.problem.values:
        if problem not in other.problem.values:
            continue
        yield (
            problem,
            *(
                "; ".join(
                    f"{solver}: {_verdicts(d.sel(problem=problem, solver=solver))}"
                    for solver in d.solver.values
                )
                for d in (one, other)
            ),
        )


def _verdicts(row: xr.Dataset) -> str:
    return ", ".join(Reliability(int(v)).name.replace("_", " ") for v in row.verdict.values)
