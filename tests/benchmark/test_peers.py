"""Answers of peers that are shipped: what a study and its comparison make of them."""

import json

import numpy as np
import pytest

from squealpipe.benchmark.machine import processor
from squealpipe.benchmark.peers import benchmark_beside_peers
from squealpipe.benchmark.problems import all_data
from squealpipe.benchmark.results import results_as_json, shipped
from squealpipe.benchmark.schema import Reliability
from squealpipe.benchmark.scoring import Score, dataset_of
from squealpipe.paper.figures.comparison.work_precision_benchmark import (
    where_solvers_ran,
)
from squealpipe.store.comparison.compare import compare_datasets
from squealpipe.store.comparison.differences import Agreement
from squealpipe.study.configuration.sections import BenchmarkComparison


@pytest.fixture(scope="module")
def peers():
    return benchmark_beside_peers(["CyRK", "tanh, σ = 10"], tolerances=[1e-6, 1e-10])


def test_every_peer_of_the_study_is_shipped_on_every_problem():
    study, table = BenchmarkComparison(), shipped()
    cells = {(entry["problem"], entry["solver"]) for entry in table["results"]}
    for name in study.solvers:
        assert all((data["name"], name) in cells for data in all_data()), name
    assert set(study.tolerances) <= set(table["tolerances"])


def test_shipped_answers_are_told_as_they_were_judged(peers):
    """Read from the file by hand, and written again they are the same lines."""
    table, again = shipped(), json.loads(results_as_json([peers]))
    assert again["solvers"] == {n: table["solvers"][n] for n in peers.solver.values}
    for entry in again["results"]:
        (stored,) = (
            each
            for each in table["results"]
            if [each[k] for k in ("problem", "solver")]
            == [entry[k] for k in ("problem", "solver")]
        )
        for name, values in entry.items():
            if isinstance(values, list):
                assert values == [stored[name][0], stored[name][2]]
    assert (peers.shipped == 1).all()
    assert "CyRK 0.20.0" in where_solvers_ran(peers)
    assert table["solvers"]["CyRK"]["processor"] in where_solvers_ran(peers)


def test_no_state_is_an_infinite_error_and_an_unknowable_problem_has_none(peers):
    error = peers.error.sel(solver="CyRK")
    assert np.isposinf(error.sel(problem="kept at zero")).all()
    assert np.isnan(error.sel(problem="chattering")).all()


def test_tolerances_without_shipped_answers_are_refused_with_the_remedy():
    with pytest.raises(ValueError, match=r"tolerance 1e-07: .*run_peers to true"):
        benchmark_beside_peers(["DOP853"], tolerances=[1e-6, 1e-7])


def test_the_button_asks_peers_anew(monkeypatch):
    """With ``run_peers`` nothing is taken from the file: only a solver that is there answers."""
    asked = []
    monkeypatch.setattr(
        "squealpipe.benchmark.peers.benchmark",
        lambda solvers, **options: asked.append((list(solvers), options["stored"])),
    )
    for run_peers in (False, True):
        with pytest.raises(AttributeError):  # the stand-in gives no dataset
            benchmark_beside_peers(["squealpipe", "DOP853"], run_peers=run_peers)
    (ours, stored), (both, none) = asked
    assert (ours, list(stored)) == (["squealpipe"], ["DOP853"])
    assert (both, list(none)) == (["squealpipe", "DOP853"], [])


@pytest.mark.parametrize(("changed", "verdict"), [(0, "different"), (1, "equal")])
def test_a_comparison_judges_our_answers_alone(changed, verdict):
    """A peer that answers otherwise on another processor is no difference; ours is one."""
    data = all_data()[:2]
    cells = [[[Score(Reliability.right)] for _ in range(2)] for _ in data]
    one = dataset_of(data, ["squealpipe", "DOP853"], [1e-8], cells)
    cells[0][changed] = [Score(Reliability.silently_wrong, missed=1)]
    other = dataset_of(data, ["squealpipe", "DOP853"], [1e-8], cells, "another")
    found = compare_datasets("benchmark", one, other)
    assert found.verdict == Agreement[verdict]
    assert "not judged: DOP853" in found.notes[0]
    assert other.processor.values.tolist() == ["another"] * 2 != [processor()] * 2


def test_results_of_the_first_release_are_compared(peers):
    """They do not say of each solver where it ran."""
    older = peers.drop_vars(["processor", "package", "shipped"])
    assert compare_datasets("benchmark", older, peers).verdict == Agreement.equal
