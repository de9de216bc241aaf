"""Score of an answer: its events against the reference's, its error over the growth."""

import time
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from functools import partial
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import scipy
import xarray as xr

from squealpipe.benchmark.adapters.scipy import solve as reference_solver
from squealpipe.benchmark.machine import processor, versions
from squealpipe.benchmark.problems import Problem, all_data, references
from squealpipe.benchmark.schema import Reliability, Role, benchmark_schema
from squealpipe.benchmark.worker import Worker
from squealpipe.parameters import finite_number
from squealpipe.schema import build

BENCHMARK_VERSION = 3
"""Goes up when problems are added, none of which is ever changed or removed, and when answers are
judged otherwise: from 3 on, no events and no derivative are no answer where they are asked."""
TIME_LIMIT = 120.0
"""Wall time for one answer, s."""
TOLERANCES = (1e-6, 1e-8, 1e-10, 1e-12)


class Score(NamedTuple):
    """Score of one answer; names as in the dataset."""

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
        counts = {n: getattr(self, n) for n in ("missed", "spurious", "out_of_order")}
        remarks = [
            f"{count} {name.replace('_', ' ')}"
            for name, count in counts.items()
            if count > 0
        ]
        # beside a remark an error says something only if it is one that nothing was said of
        said = self.message and (
            self.verdict == Reliability.flagged or np.isinf(self.error)
        )
        if self.verdict > Reliability.right and not (np.isnan(self.error) or said):
            remarks.append(f"error {self.error:.1e}")
        remarks += [self.message] * bool(self.message)
        verdict = self.verdict.name.replace("_", " ")
        return f"{verdict} ({', '.join(remarks)})" if remarks else verdict


class Stored(NamedTuple):
    """Answers that a solver gave earlier.

    Attributes:
        scores: by the problem's name, one for each tolerance.
        origin: ``package`` and ``processor``.
    """

    scores: Mapping[str, list[Score]]
    origin: Mapping[str, str]


def score(
    data: Mapping[str, Any],
    reference: Mapping[str, Any],
    answer: Sequence[Any],
    tol: float,
) -> Score:
    """Judge one answer.

    Args:
        reference: its final state, events, growth and margin.
        answer: times, kinds, state, evaluations, and optionally a flag and a derivative; times and
            kinds are None where a method reports no events.

    Raises:
        ValueError: the answer has other parts, or kinds and times differ in number.
    """
    times, kinds, state, evaluations, *more = _parts(answer)
    evaluations = int(evaluations)
    flag = str(more[0] or "") if more else ""
    slope = more[1] if more[1:] else None
    unlike_right = Reliability.flagged if flag else Reliability.silently_wrong
    if "unknowable" in data:
        return Score(unlike_right, message=flag, evaluations=evaluations)
    size = np.shape(reference["state"])
    if np.shape(state) != size and not flag:
        raise ValueError(f"a state of shape {np.shape(state)}; {size} is needed")
    remarks = [flag] * bool(flag)
    if not np.isfinite(np.array([*(times or []), *state], float)).all():
        remarks.append("NaN or infinite")
    unanswered = []
    if times is None and reference["times"]:
        unanswered.append("reports no events")
    if slope is None and data.get("derivative"):
        unanswered.append("gives no derivative")
    error = largest(state, reference["state"], reference["growth"])
    missed = spurious = swapped = -1
    # an answer is right up to a hundred tolerances, times the growth of a perturbation
    time_error, wrong, allowed = np.nan, False, 100.0 * tol
    # stands for an event time that is not a finite number
    never = 1e300
    if times is not None:
        if len(times) != len(kinds):
            raise ValueError(f"{len(times)} times, but {len(kinds)} kinds of events")
        truth, growth = np.array(reference["times"]), np.array(reference["time_growth"])
        mine = np.nan_to_num(
            np.array(times, float), nan=never, posinf=never, neginf=-never
        )
        i, j = matched(reference, mine, kinds).T
        missed, spurious = len(truth) - len(i), len(mine) - len(j)
        swapped = out_of_order(j, truth[i], allowed * growth[i])
        judged = allowed <= reference["margin"]
        # an event is known if the allowed error moves its time by less than a tenth of the way to
        # the next one
        known = judged | (allowed * growth <= 0.1 * spacing(truth))
        errors = np.abs(mine[j] - truth[i]) / np.maximum(1.0, truth[i])
        errors[np.abs(mine[j]) == never] = np.inf
        time_error = errors.max(initial=0.0)
        error = (errors / growth[i]).max(initial=error, where=known[i])
        order = out_of_order(
            j[known[i]], truth[i][known[i]], (allowed * growth)[i][known[i]]
        )
        wrong = known.sum() > known[i].sum() or order > 0 or (judged and spurious > 0)
    if slope is not None and data.get("derivative"):
        error = max(
            error, largest([slope], [reference["derivative"]], reference["growth"])
        )
    verdict = unlike_right
    if error <= allowed and not wrong:
        # what was not answered was not answered wrongly
        verdict = Reliability.flagged if unanswered else Reliability.right
    message = "; ".join([*remarks, *unanswered])
    return Score(
        verdict, missed, spurious, swapped, time_error, error, message, evaluations
    )


def _parts(answer: Sequence[Any]) -> Sequence[Any]:
    if isinstance(answer, str) or not 4 <= len(answer) <= 6:
        raise ValueError("times, kinds, state and evaluations are needed")
    return answer


def largest(found: Sequence[float], truth: Sequence[float], growth: float) -> float:
    """Largest difference, relative where the truth is above 1, over the growth."""
    a, b = np.array(found, float), np.array(truth, float)
    if a.shape != b.shape or not np.isfinite(a).all():
        return np.inf
    return float(
        np.max(np.abs(a - b) / np.maximum(1.0, np.abs(b)), initial=0.0) / growth
    )


def matched(
    reference: Mapping[str, Any], times: np.ndarray, kinds: Sequence[str]
) -> np.ndarray:
    """Pairs (event of the reference, event found) of one kind, nearest first."""
    pairs: list[tuple[int, int]] = []
    for kind in {*reference["kinds"]}:
        mine = [j for j, each in enumerate(kinds) if each == kind]
        theirs = [i for i, each in enumerate(reference["kinds"]) if each == kind]
        apart = np.array(reference["times"])[theirs, None] - times[mine]
        rows, columns = scipy.optimize.linear_sum_assignment(np.abs(apart) ** 0.5)
        pairs += [(theirs[i], mine[j]) for i, j in zip(rows, columns, strict=True)]
    return np.array(sorted(pairs), int).reshape(-1, 2)


def out_of_order(found: np.ndarray, truth: np.ndarray, resolved: np.ndarray) -> int:
    """Events found before one that they follow, by more time than the tolerance resolves."""
    later = (found[:, None] < found) & (truth[:, None] - truth > resolved[:, None])
    return int(later.any(axis=1).sum())


def spacing(times: np.ndarray) -> np.ndarray:
    """Time from each event to the nearest other one that does not come at once."""
    gaps = np.diff(times, prepend=-np.inf, append=np.inf)
    gaps[gaps == 0.0] = np.inf
    return np.minimum(gaps[:-1], gaps[1:])


def measure(data: Mapping[str, Any], solve: Callable[..., Any], tol: float) -> Score:
    """Ask one solver one problem; an exception, or an exit, flags its answer.

    Calls of the field are counted here; a solver that makes its own functions tells their number.
    """
    problem = Problem(deepcopy(dict(data)))
    stated = _stated(problem)
    started = time.process_time()
    try:
        answer = solve(problem, tol)
        spent = time.process_time() - started
        if problem.calls:
            answer = (*answer[:3], problem.calls, *answer[4:])
        scored = score(data, references()[data["name"]], answer, tol)
    except NotImplementedError as refusal:
        return Score(Reliability.not_applicable, message=str(refusal)[:64])
    except (Exception, SystemExit) as failure:  # noqa: BLE001 (whatever a solver raises)
        spent = time.process_time() - started
        scored = failed(data, f"{type(failure).__name__}: {failure}", problem.calls)
    if altered := [n for n, text in _stated(problem).items() if text != stated[n]]:
        remarks = [scored.message] * bool(scored.message)
        remarks.append(f"altered {', '.join(altered)}")
        scored = scored._replace(message="; ".join(remarks))
    return scored._replace(cpu_time=spent, message=scored.message[:64])


def failed(data: Mapping[str, Any], flag: str, calls: int = 0) -> Score:
    """The score of no answer, and of what was said instead."""
    reference = references()[data["name"]]
    scored = score(data, reference, (None, None, [], calls, flag), 1.0)
    return scored._replace(message=flag[:64])


def _stated(problem: Problem) -> dict[str, str]:
    """Return, as texts, the fields that a solver may not change in its copy of the problem."""
    names = [
        "start",
        "parameters",
        "states",
        "regime",
        "t_end",
        "times",
        "data",
        "patience",
    ]
    return {name: repr(getattr(problem, name)) for name in names}


def benchmark(
    solvers: Mapping[str, Callable[..., Any]],
    *,
    names: Sequence[str] = (),
    tolerances: Sequence[float] = TOLERANCES,
    time_limit: float = TIME_LIMIT,
    stored: Mapping[str, Stored] = MappingProxyType({}),
    done: Callable[[str, str, list[Score]], None] = lambda *_: None,
) -> xr.Dataset:
    """Dataset ``benchmark``: every solver on every problem at every tolerance.

    Args:
        solvers: name → ``solve(problem, tol)``; each runs in a process of its own.
        time_limit: s of wall time for one answer.
        stored: answers at these tolerances of solvers that are not asked anew.
        done: called with problem, solver and its scores.

    Raises:
        ValueError: a problem is unknown, or there is no solver.
    """
    known = {data["name"]: data for data in all_data()}
    if unknown := [name for name in names if name not in known]:
        raise ValueError(
            f"problem {unknown[0]!r} is unknown; one of {'; '.join(known)}"
        )
    tolerances = [
        finite_number("tolerances", tolerance, "1") for tolerance in tolerances
    ]
    time_limit = finite_number("time_limit", time_limit, "s")
    if min(tolerances) <= 0.0:
        raise ValueError(f"tolerance {min(tolerances):g}: has to be above 0")
    if not solvers and not stored:
        raise ValueError("no solver that is asked for is installed")
    chosen = [known[name] for name in names or known]
    cells: list[list[list[Score]]] = []
    workers = {
        name: Worker(partial(measure, solve=solve), time_limit)
        for name, solve in solvers.items()
    }
    for data in chosen:
        unit = np.nan
        if workers:
            # DOP853 at 10⁻⁸: its CPU time is the unit of ``cpu_ratio``
            # (NaN where the clock shows none: no ratio to it is known)
            unit = measure(data, reference_solver, 1e-8).cpu_time or np.nan
        cells.append([])
        for name, worker in workers.items():
            _ask(worker, data, tolerances[0])  # compiles before any stopwatch runs
            scores = [_ask(worker, data, tol) for tol in tolerances]
            cells[-1].append(
                [score._replace(cpu_ratio=score.cpu_time / unit) for score in scores]
            )
            done(data["name"], name, cells[-1][-1])
        cells[-1] += [each.scores[data["name"]] for each in stored.values()]
    for worker in workers.values():
        worker.close()
    origins = {name: each.origin for name, each in stored.items()}
    return dataset_of(chosen, [*solvers, *stored], tolerances, cells, origins=origins)


def _ask(worker: Worker[Score], data: Mapping[str, Any], tol: float) -> Score:
    try:
        return worker.ask(data=data, tol=tol)
    except (TimeoutError, EOFError) as failure:
        return failed(data, str(failure))


def dataset_of(
    chosen: Sequence[Mapping[str, Any]],
    solvers: Sequence[str],
    tolerances: Sequence[float],
    cells: Sequence[Sequence[Sequence[Score]]],
    machine: str = "",
    origins: Mapping[str, Mapping[str, str]] = MappingProxyType({}),
) -> xr.Dataset:
    """Dataset ``benchmark`` of scores over (problem, solver, tolerance).

    Args:
        machine: the processor on which the solvers ran; this one by default.
        origins: package and processor of the solvers that ran elsewhere, by name.
    """
    table = np.array(cells, dtype=object)
    columns = {name: table[..., i].tolist() for i, name in enumerate(Score._fields)}
    coordinates = {
        "problem": [data["name"] for data in chosen],
        "solver": list(solvers),
        "tol": list(tolerances),
    }
    groups = [data["class"] for data in chosen]
    role = [Role.ours if name == "squealpipe" else Role.public for name in solvers]
    machine = machine or processor()
    packages = versions(name for name in solvers if name not in origins)
    elsewhere = [origins.get(name, {}) for name in solvers]
    columns |= {
        "group": groups,
        "role": role,
        "processor": [each.get("processor", machine) for each in elsewhere],
        "package": [
            each.get("package", packages.get(name, "unknown"))
            for name, each in zip(solvers, elsewhere, strict=True)
        ],
        "shipped": [bool(each) for each in elsewhere],
    }
    attributes = {"benchmark_version": BENCHMARK_VERSION, "processor": machine}
    return build(benchmark_schema, columns, coordinates, attributes)


def verdicts(row: xr.Dataset) -> str:
    """Those of all solvers on one problem, as text."""
    return "; ".join(
        f"{solver}: {', '.join(Reliability(v).name.replace('_', ' ') for v in verdict)}"
        for solver, verdict in zip(
            row.solver.values, row.verdict.values.tolist(), strict=True
        )
    )
