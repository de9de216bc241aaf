"""``squealpipe benchmark``: a solver on problems with events, and two results side by side."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from squealpipe.cli.arguments import Force, Output, Texts, Time, Tolerances
from squealpipe.cli.console import ExitCodes

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr

    from squealpipe.benchmark.scoring import Score


def run(
    *,
    solver: Texts = None,
    problem: Texts = None,
    tolerance: Tolerances = None,
    time_limit: Time | None = None,
    output: Output = Path("benchmark.nc"),
    force: Force = False,
) -> int:
    """Run solvers on problems with events; exit code 1: an answer is silently wrong.

    Example: `squealpipe benchmark --solver my_solver.py:solve --problem 'light barrier' -o mine.nc`

    Args:
        solver: a shipped one, or FILE.py:FUNCTION; all that are installed by default.
        problem: names of problems; all by default.
        tolerance: tolerances to run at; by default 1e-6, 1e-8, 1e-10 and 1e-12.
        time_limit: wall time after which an answer is given up, s; 120 by default.
    """
    from squealpipe.cli.output import check_output, write

    check_output(output, force=force)

    from squealpipe.benchmark.adapters import SOLVERS, installed
    from squealpipe.benchmark.scoring import TIME_LIMIT, TOLERANCES, benchmark

    solvers = installed(solver or SOLVERS)
    tolerances = sorted({*(tolerance or TOLERANCES)}, reverse=True)

    def done(problem: str, name: str, scores: list[Score]) -> None:
        found = "; ".join(
            f"{t:g} {s.words}" for t, s in zip(tolerances, scores, strict=True)
        )
        print(f"{problem}: {f'{name}: ' * (len(solvers) > 1)}{found}", flush=True)

    found = write(
        lambda: benchmark(
            solvers,
            names=problem or (),
            tolerances=tolerances,
            time_limit=TIME_LIMIT if time_limit is None else time_limit,
            done=done,
        ),
        output,
        config={
            "solvers": list(solvers),
            "problems": problem or [],
            "tolerances": tolerances,
        },
    )
    return _verdict(found, output)


def _verdict(found: xr.Dataset, output: Path) -> int:
    from squealpipe.benchmark.schema import Reliability

    wrong = int((found.verdict == Reliability.silently_wrong).sum())
    print(f"{wrong} of {found.verdict.size} answers silently wrong; wrote {output}")
    return ExitCodes.answer_is_no if wrong else ExitCodes.done


def problems(*, output: Output = Path("problems.json"), force: Force = False) -> int:
    """Write all problems, with equations and references, as JSON for a solver in any language.

    Example: `squealpipe benchmark problems -o problems.json`
    """
    from squealpipe.benchmark.answers import problems_as_json

    return _write_json(problems_as_json, output, force=force)


def _write_json(text: Callable[[], str], output: Path, *, force: bool) -> int:
    from squealpipe.cli.output import check_output
    from squealpipe.store.whole_files import whole_file

    check_output(output, force=force, kinds=(".json",))
    content = text()
    with whole_file(output) as temporary:
        temporary.write_text(content, encoding="utf-8")
    print(f"wrote {output}")
    return ExitCodes.done


def score(
    answers: Path, /, *, output: Output = Path("benchmark.nc"), force: Force = False
) -> int:
    """Score answers that a solver in any language wrote as JSON; exit codes as for a run.

    Example: `squealpipe benchmark score answers.json -o theirs.nc`

    Args:
        answers: the file; docs/benchmark.md has its form.
    """
    from squealpipe.cli.output import check_output, write

    check_output(output, force=force)

    from squealpipe.benchmark.answers import score_answers

    scores = write(
        lambda: score_answers(answers), output, config={"answers": answers.name}
    )
    return _verdict(scores, output)


def results(
    files: Annotated[list[Path], Parameter(consume_multiple=True)],
    /,
    *,
    output: Output = Path("results.json"),
    force: Force = False,
) -> int:
    """Write results as one JSON text with packages and processor, to cite or to send.

    Example: `squealpipe benchmark results mine.nc -o results.json`

    Args:
        files: datasets of `squealpipe benchmark`, each of other solvers.
    """
    from squealpipe.benchmark.results import results_as_json

    return _write_json(
        lambda: results_as_json(map(_dataset, files)), output, force=force
    )


def _loaded(path: Path) -> xr.Dataset:
    from squealpipe.benchmark.results import SHIPPED, read_results

    if path.suffix == ".json" or str(path) == SHIPPED:
        return read_results(path)
    return _dataset(path)


def _dataset(path: Path) -> xr.Dataset:
    from squealpipe.store import load

    dataset = load(path)
    if dataset.attrs["schema"] != "benchmark":
        raise ValueError(
            f"{path} is a dataset {dataset.attrs['schema']!r}, not of the benchmark"
        )
    return dataset


def compare(one: Path, other: Path, /) -> int:
    """Set the verdicts of two results on what both have side by side; exit code 1: they differ.

    Example: `squealpipe benchmark compare mine.nc shipped`

    Args:
        one: a dataset of `squealpipe benchmark`, results as JSON, or `shipped`: those that come
            with the package.
        other: another.
    """
    import xarray as xr

    from squealpipe.benchmark.scoring import verdicts

    pair = _loaded(one), _loaded(other)
    versions = [each.attrs["benchmark_version"] for each in pair]
    if versions[0] != versions[1]:
        raise ValueError(
            f"{one} was judged by version {versions[0]} of the benchmark, {other} by "
            f"{versions[1]}; run the older one again"
        )
    aligned, others = xr.align(*pair, exclude="solver")
    if not aligned.verdict.size:
        raise ValueError(f"{one} and {other} have no problem at the same tolerance")
    print("tolerances: " + ", ".join(f"{tol:g}" for tol in aligned.tol.values))
    same = True
    for problem in aligned.problem.values:
        left, right = (
            verdicts(each.sel(problem=problem)) for each in (aligned, others)
        )
        print(f"{problem}\n  {one.name}: {left}\n  {other.name}: {right}")
        same &= left.partition(": ")[2] == right.partition(": ")[2]
    return ExitCodes.done if same else ExitCodes.answer_is_no
