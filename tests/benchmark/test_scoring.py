"""The score names what a solver does wrong; the shipped solvers do what they are known to do."""

import os

import numpy as np
import pytest

from squealpipe.benchmark.adapters import SOLVERS, solver
from squealpipe.benchmark.problems import Problem, all_data, references
from squealpipe.benchmark.schema import Reliability
from squealpipe.benchmark.scoring import BENCHMARK_VERSION, benchmark, measure, score

DATA = {data["name"]: data for data in all_data()}
TOL = 1e-8


def _truth(name):
    found = references()[name]
    return list(found["times"]), list(found["kinds"]), list(found["state"]), 1


def _scored(name, times, kinds, state, flag="", slope=None, tol=TOL):
    """Of an answer that gives the right derivative where none is given here."""
    truth = references()[name]
    slope = truth.get("derivative") if slope is None else slope
    return score(DATA[name], truth, (times, kinds, state, 1, flag, slope), tol)


def _knowable():
    found = {n: r for n, r in references().items() if r}
    return [
        n for n, r in found.items() if len(r["times"]) > 1 and r["margin"] >= 100 * TOL
    ]


def test_truth_is_right_everywhere():
    for name in references():
        if "unknowable" not in DATA[name]:
            times, kinds, state, _ = _truth(name)
            assert _scored(name, times, kinds, state, tol=1e-12).words == "right", name


def test_dropped_event_is_missed_and_one_too_many_spurious():
    for name in _knowable():
        times, kinds, state, _ = _truth(name)
        for i in range(len(times)):
            found = _scored(
                name, times[:i] + times[i + 1 :], kinds[:i] + kinds[i + 1 :], state
            )
            assert (found.missed, found.spurious) == (1, 0), (name, i)
            assert found.words.startswith("silently wrong (1 missed"), (name, i)
        found = _scored(name, [*times, times[-1] + 0.1], [*kinds, kinds[-1]], state)
        assert found.spurious == 1, name
        assert "silently wrong (1 spurious" in found.words


def test_swapped_events_are_out_of_order():
    for name in _knowable():
        times, kinds, state, _ = _truth(name)
        apart = np.diff(times) > 200 * TOL * np.array(
            references()[name]["time_growth"][1:]
        )
        for i in np.flatnonzero(apart):
            order = [*range(i), i + 1, i, *range(i + 2, len(times))]
            found = _scored(
                name, [times[j] for j in order], [kinds[j] for j in order], state
            )
            assert "silently wrong (1 out of order" in found.words, (name, i)


@pytest.mark.parametrize(
    ("name", "kept", "words"),
    [
        # at 1e-6 the last impacts cannot be known, the first can
        (
            "bouncing ball",
            lambda times: [times[1], times[0], *times[2:]],
            "1 out of order",
        ),
        (
            "chaotic impacts",
            lambda times: times[1:],
            "1 missed",
        ),  # but not the last ones
    ],
)
def test_known_events_are_judged_where_later_ones_are_not(name, kept, words):
    times, kinds, state, _ = _truth(name)
    found = _scored(name, kept(times), kinds[: len(kept(times))], state, tol=1e-6)
    assert found.words.startswith(f"silently wrong ({words}")
    if name == "chaotic impacts":
        assert "right" in _scored(name, times[:-1], kinds[:-1], state, tol=1e-6).words


def test_drift_is_an_error():
    for name in references():
        if references()[name].get("growth", 99.0) > 10.0:
            continue
        times, kinds, state, _ = _truth(name)
        found = _scored(name, times, kinds, [each + 1e-3 for each in state])
        assert found.words.startswith("silently wrong (error"), name
        drift = [each + 1e-4 * max(1.0, abs(each)) for each in state]
        assert "error" in _scored(name, times, kinds, drift, tol=1e-10).words, name


def test_late_events_are_an_error():
    for name in _knowable():
        if max(references()[name]["time_growth"]) < 10.0:
            times, kinds, state, _ = _truth(name)
            found = _scored(name, [each * (1.0 + 1e-4) for each in times], kinds, state)
            assert found.words.startswith("silently wrong (error"), name


def test_flag_is_not_silence():
    times, kinds, state, _ = _truth("two gates")
    assert _scored("two gates", times[1:], kinds[1:], state, "lost").words.startswith(
        "flagged (1 "
    )
    assert _scored("chattering", [], [], []).verdict == Reliability.silently_wrong
    assert (
        _scored("chattering", [], [], [], "accumulation").verdict == Reliability.flagged
    )


def test_simultaneous_events_have_no_order_and_others_are_out_of_it_by_their_kinds_alone():
    times, kinds, state, _ = _truth("two gates")
    assert "out of order" in _scored("two gates", times, kinds[::-1], state).words
    times, kinds, state, _ = _truth("two balls")
    assert times[0] == times[1]
    kinds[:2] = kinds[1::-1]
    assert _scored("two balls", times, kinds, state).words == "right"


def test_list_is_not_judged_where_the_tolerance_cannot_know_it():
    *_, state, _ = _truth("tangency, depth 1e-09")
    assert (
        _scored("tangency, depth 1e-09", [], [], state, tol=1e-6).words
        == "right (4 missed)"
    )
    assert (
        "silently wrong"
        in _scored("tangency, depth 1e-09", [], [], state, tol=1e-12).words
    )


def test_derivative_counts_where_it_is_given():
    name = "time of the third impact"
    times, kinds, state, _ = _truth(name)
    slope = references()[name]["derivative"]
    assert solver("squealpipe")(Problem(DATA[name]), TOL)[5] == pytest.approx(
        slope, rel=1e-10
    )
    assert _scored(name, times, kinds, state, "", slope).words == "right"
    assert "error" in _scored(name, times, kinds, state, "", 1.01 * slope).words


def test_exception_and_endless_solver_are_flagged():
    def endless(problem, tol):
        while True:
            problem.field(0.0, problem.start)

    assert "gave up" in measure(DATA["two gates"], endless, TOL).words
    assert measure(DATA["two gates"], lambda *_: 1 / 0, TOL).words.startswith(
        "flagged (Zero"
    )


@pytest.mark.parametrize("time", [np.nan, np.inf, -np.inf])
def test_event_time_that_is_no_number_is_an_error(time):
    times, kinds, *rest = _truth("two gates")
    found = measure(DATA["two gates"], lambda *_: ([times[0], time], kinds, *rest), TOL)
    assert found.words == "silently wrong (NaN or infinite)"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            lambda times, kinds, state, n: (times, kinds, state),
            "flagged (ValueError: times, kinds, state and evaluations are needed",
        ),
        (
            lambda times, kinds, state, n: "all right",
            "flagged (ValueError: times, kinds, state and evaluations are needed",
        ),
        (
            lambda times, kinds, state, n: (times, kinds[:1], state, n),
            "flagged (ValueError: 2 tim",
        ),
        (
            lambda times, kinds, state, n: (times, kinds, state, None),
            "flagged (TypeError",
        ),
        (lambda times, kinds, state, n: (times, kinds, state, n, None), "right"),
        (
            lambda times, kinds, state, n: (times, kinds, [np.nan] * 2, n),
            "silently wrong (NaN or infinite)",
        ),
        (
            lambda times, kinds, state, n: (times, kinds, [*state, 0.0], n),
            "flagged (ValueError: a state of shape (3,); (2,) is needed",
        ),
    ],
)
def test_malformed_answer_does_not_end_the_run(change, words):
    answer = change(*_truth("two gates"))
    assert measure(DATA["two gates"], lambda *_: answer, TOL).words.startswith(words)


def test_what_is_not_answered_is_not_right():
    *_, state, _ = _truth("two gates")
    found = _scored("two gates", None, None, state)
    assert found.words == "flagged (reports no events)"
    assert _scored("two gates", None, None, [9.0, 9.0]).words.startswith("silently")
    name = "time of the third impact"
    found = score(DATA[name], references()[name], _truth(name), TOL)
    assert found.words == "flagged (gives no derivative)"


def test_a_plain_integrator_without_events_is_right_only_where_there_are_none():
    def plain(problem, tol):
        return None, None, references()[problem.name].get("state", []), 1

    for name, data in DATA.items():
        if "unknowable" not in data and references()[name]["times"]:
            assert measure(data, plain, TOL).verdict != Reliability.right, name


def test_calls_of_the_field_are_counted_here():
    def modest(problem, tol):
        for _ in range(7):
            problem.field(0.0, problem.start)
        return (*_truth("two gates")[:3], 1)

    assert measure(DATA["two gates"], modest, TOL).evaluations == 7


def test_an_altered_problem_is_named_and_alters_nothing_else():
    def careless(problem, tol):
        truth = _truth(problem.name)
        problem.start[0] = 99.0
        problem.data["switches"].clear()
        references()[problem.name]["state"][0] = 99.0
        return truth

    for _ in range(2):
        words = measure(DATA["two gates"], careless, TOL).words
        assert words == "right (altered start, data)"


def _loops(problem, tol):
    while True:
        pass


def _exits(problem, tol):
    raise SystemExit(3)


def _dies(problem, tol):
    os._exit(5)


@pytest.mark.release
@pytest.mark.parametrize(
    ("solve", "words"),
    [
        (_loops, "flagged (no answer within 1 s)"),
        (_exits, "flagged (SystemExit: 3)"),
        (_dies, "flagged (its process ended with exit code 5)"),
    ],
)
def test_a_solver_that_never_answers_ends_its_own_run_only(solve, words):
    said = []
    found = benchmark(
        {"mine": solve, "DOP853": solver("DOP853")},
        names=["two gates", "light barrier"],
        tolerances=[1e-8],
        time_limit=1.0,
        done=lambda problem, name, scores: said.append((problem, name, scores)),
    )
    mine = [scores[0].words for _, name, scores in said if name == "mine"]
    assert mine == [words, words]
    assert found.verdict.sel(problem="two gates", solver="DOP853") == Reliability.right


def test_our_engine_is_never_silently_wrong():
    ours = solver("squealpipe")
    for name, data in DATA.items():
        for tol in (1e-6, 1e-8, 1e-12):
            found = measure(data, ours, tol)
            assert found.verdict in {Reliability.right, Reliability.flagged}, (
                name,
                found.words,
            )
            if "unknowable" in data or tol in {1e-8, 1e-12}:
                assert (found.verdict == Reliability.right) == (
                    "unknowable" not in data
                ), name


@pytest.mark.parametrize("tol", [1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12])
def test_release_from_stick_is_not_taken_back(tol):
    """The slip begins with a rate of zero, of which an event located to ``tol`` knows no more."""
    assert measure(DATA["dry friction"], solver("squealpipe"), tol).words == "right"


def test_known_failures_of_public_solvers():
    scipy, heyoka = solver("DOP853"), solver("heyoka")
    assert measure(DATA["light barrier"], scipy, TOL).missed == 2  # scipy 9228
    assert measure(DATA["chattering"], scipy, TOL).verdict == Reliability.silently_wrong
    assert measure(DATA["start on the surface"], heyoka, TOL).missed == 3
    assert measure(DATA["thermostat"], scipy, TOL).words == "right"


@pytest.mark.parametrize("name", [name for name in SOLVERS if name != "diffrax"])
def test_shipped_solvers_get_an_easy_problem_right(name):
    if (solve := solver(name)) is None:
        pytest.skip(f"{name} is not installed")
    if name.startswith(("tanh", "Moreau")):
        found = measure(DATA["A1: stick release"], solve, 1e-6)
        assert found.missed == -1
        assert found.error < 1.0
    else:
        assert measure(DATA["thermostat"], solve, 1e-6).words == "right"


def test_dataset_has_its_schema():
    found = benchmark(
        {"DOP853": solver("DOP853")}, names=["two gates"], tolerances=[1e-6, 1e-8]
    )
    assert found.verdict.dims == ("problem", "solver", "tol")
    assert found.attrs["benchmark_version"] == BENCHMARK_VERSION
    with pytest.raises(ValueError, match="unknown"):
        benchmark({}, names=["no such problem"])


def test_a_clock_that_shows_no_time_leaves_the_ratio_unknown(monkeypatch):
    """The command divided by zero where the reference took less than the clock resolves."""
    monkeypatch.setattr("squealpipe.benchmark.scoring.time.process_time", lambda: 1.0)
    found = benchmark(
        {"DOP853": solver("DOP853")}, names=["two gates"], tolerances=[1e-6]
    )
    assert found.verdict.item() == Reliability.right
    assert np.isnan(found.cpu_ratio.item())
