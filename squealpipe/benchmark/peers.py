"""Benchmark of our engine, which runs, beside peers, which run again only on demand."""

from collections.abc import Sequence

import xarray as xr

from squealpipe.benchmark.adapters import installed
from squealpipe.benchmark.results import shipped_answers
from squealpipe.benchmark.scoring import TOLERANCES, benchmark


def benchmark_beside_peers(
    solvers: Sequence[str],
    *,
    tolerances: Sequence[float] = TOLERANCES,
    run_peers: bool = False,
) -> xr.Dataset:
    """Return dataset ``benchmark`` of our engine, run here, and of peers, by shipped answers.

    A peer's answers say nothing new when a study is computed again, and take most of its time.

    Args:
        solvers: names, or FILE.py:FUNCTION. A solver without shipped answers runs here, or is left
            out if it is not installed.
        run_peers: run all of them here.

    Raises:
        ValueError: answers are not shipped at one of the tolerances, or a solver is unknown.
    """
    tolerances = sorted(tolerances, reverse=True)
    stored = {
        name: answers
        for name in solvers
        if name != "squealpipe" and not run_peers
        if (answers := shipped_answers(name, tolerances)) is not None
    }
    scored = benchmark(
        installed(name for name in solvers if name not in stored),
        tolerances=tolerances,
        stored=stored,
    )
    names = [name.rpartition("/")[2] for name in solvers]
    return scored.sel(solver=[name for name in names if name in scored.solver])
