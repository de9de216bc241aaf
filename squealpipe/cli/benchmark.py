"""``squealpipe benchmark``: a solver on problems with events, and two results side by side."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from squealpipe.cli.arguments import Output, Switch
from squealpipe.cli.exit_codes import ANSWER_IS_NO, DONE

if TYPE_CHECKING:
    from collections.abc import Callable

    from squealpipe.benchmark.scoring import Score

Names = Annotated[list[str] | None, Parameter(negative="")]


def run(
    *,
    solver: Names = None,
    problem: Names = None,
    tolerance: Annotated[list[float] | None, Parameter(negative="")] = None,
    output: Output = Path("benchmark.nc"),
    force: Switch = False,
) -> int:
    """Run solvers on problems with events; exit code 1: an answer is silently wrong.

    Example: `squealpipe benchmark --solver my_solver.py:solve --problem 'light barrier' -o mine.nc`

    Args:
        solver: a shipped one, or FILE.py:FUNCTION; all that are installed by default.
        problem: names of problems; all by default.
        tolerance: by default 1e-6, 1e-8, 1e-10 and 1e-12.
        output: dataset to write.
        force: overwrite a file that exists.
    """
    from squealpipe.benchmark.adapters import SOLVERS
    from squealpipe.benchmark.scoring import TOLERANCES, benchmark, silently_wrong
    from squealpipe.cli.output import check_output, write

    check_output(output, force=force)
    chosen = {name.rpartition("/")[2]: _solver(name) for name in solver or SOLVERS}
    solvers = {name: solve for name, solve in chosen.items() if solve is not None}
    for name in chosen.keys() - solvers.keys():
        print(f"{name}: not installed, left out")
    if not solvers:
        raise ValueError(f"nothing to run: {', '.join(chosen)} is not installed")
    tolerances = sorted(tolerance or TOLERANCES, reverse=True)

    def done(problem: str, name: str, scores: list[Score]) -> None:
        found = "; ".join(f"{t:g} {s.words}" for t, s in zip(tolerances, scores, strict=True))
        print(f"{problem}: {f'{name}: ' * (len(solvers) > 1)}{found}", flush=True)

    found = write(
        lambda: benchmark(solvers, names=problem or (), tolerances=tolerances, done=done),
        output,
        config={"solvers": list(solvers), "problems": problem or [], "tolerances": tolerances},
    )
    wrong = silently_wrong(found)
    print(f"{wrong} of {found.verdict.size} answers silently wrong; wrote {output}")
    return ANSWER_IS_NO if wrong else DONE


def compare(one: Path, other: Path, /) -> int:
    """Set the verdicts of two results side by side; exit code 1: they differ.

    Example: `squealpipe benchmark compare mine.nc theirs.nc`

    Args:
        one: a dataset of `squealpipe benchmark`.
        other: another.
    """
    from squealpipe.benchmark.scoring import differences
    from squealpipe.store import load

    same = True
    for name, left, right in differences(load(one), load(other)):
        print(f"{name}\n  {one.name}: {left}\n  {other.name}: {right}")
        same &= left.partition(": ")[2] == right.partition(": ")[2]
    return DONE if same else ANSWER_IS_NO


def _solver(name: str) -> Callable[..., Any] | None:
    """The function that a name or FILE.py:FUNCTION means; None where its package is missing."""
    import runpy

    from squealpipe.benchmark.adapters import solver

    path, colon, function = name.rpartition(":")
    if not colon:
        return solver(name)
    if not Path(path).is_file():
        raise ValueError(f"solver {name!r}: there is no file {path}")
    found = runpy.run_path(path)
    if not callable(found.get(function)):
        raise ValueError(f"solver {name!r}: {path} has no function {function}")  # noqa: TRY004
    return found[function]  # type: ignore[no-any-return]
