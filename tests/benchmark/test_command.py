"""``squealpipe benchmark`` and ``squealpipe benchmark compare``."""

import json
import re
import shutil
import subprocess

import pytest

import squealpipe
from squealpipe.benchmark.answers import score_answers
from squealpipe.benchmark.machine import processor
from squealpipe.benchmark.problems import all_data, references
from squealpipe.benchmark.results import read_results, shipped
from squealpipe.cli import run

MINE = """
from scipy.integrate import solve_ivp

def solve(problem, tol):
    switch = problem.switches[-1]
    def event(t, y):
        return switch.when(t, y, problem.regime)
    event.direction = -1
    span = 0, problem.t_end
    run = solve_ivp(problem.field, span, problem.start, rtol=tol, atol=tol, events=event)
    times = run.t_events[0].tolist()
    return times, [switch.name] * len(times), run.y[:, -1].tolist(), run.nfev
"""


@pytest.fixture
def mine(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(MINE)
    return f"{path}:solve"


def test_right_solver_gives_exit_code_zero_and_two_are_compared(mine, tmp_path, capsys):
    theirs, ours = str(tmp_path / "a.nc"), str(tmp_path / "b.nc")
    some = ["--problem", "two gates", "--tolerance", "1e-8"]
    assert run(["benchmark", "--solver", "DOP853", *some, "-o", theirs]) == 0
    assert "two gates: 1e-08 right" in capsys.readouterr().out
    assert run(["benchmark", "--solver", mine, *some, "-o", ours]) == 1
    assert run(["benchmark", "compare", theirs, ours]) == 1
    text = capsys.readouterr().out
    assert "a.nc: DOP853: right" in text
    assert "mine.py:solve: silently wrong" in text
    assert run(["benchmark", "compare", theirs, theirs]) == 0


def test_results_with_nothing_in_common_are_not_the_same(tmp_path, capsys):
    one, other = str(tmp_path / "a.nc"), str(tmp_path / "b.nc")
    for tol, output in (("1e-6", one), ("1e-8", other)):
        some = ["--problem", "thermostat", "--tolerance", tol, "-o", output]
        assert run(["benchmark", "--solver", "DOP853", *some]) == 0
    assert run(["benchmark", "compare", one, other]) == 2
    assert "no problem at the same tolerance" in capsys.readouterr().err


def test_solvers_of_one_name_and_tolerance_zero_are_refused(mine, tmp_path, capsys):
    (tmp_path / "other").mkdir()
    (tmp_path / "other/mine.py").write_text(MINE)
    two = ["--solver", mine, "--solver", f"{tmp_path / 'other/mine.py'}:solve"]
    some = ["--problem", "two gates", "-o", str(tmp_path / "x.nc")]
    assert run(["benchmark", *two, *some]) == 2
    assert "the same name" in capsys.readouterr().err
    assert run(["benchmark", "--solver", "DOP853", "--tolerance", "0", *some]) == 2
    assert "above 0" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("solver", "message"),
    [
        ("nobody", "one of"),
        ("nowhere.py:solve", "no file"),
        ("{here}:other", "no function"),
    ],
)
def test_unknown_solver_is_refused(solver, message, mine, tmp_path, capsys):
    name = solver.replace("{here}", mine.rpartition(":")[0])
    assert run(["benchmark", "--solver", name, "-o", str(tmp_path / "x.nc")]) == 2
    assert message in capsys.readouterr().err


def test_results_as_json_say_what_the_dataset_says(tmp_path, capsys):
    one, two = str(tmp_path / "a.nc"), str(tmp_path / "b.nc")
    some = ["--problem", "two gates", "--problem", "light barrier"]
    for solver, output in (("DOP853", one), ("RK45", two)):
        assert run(["benchmark", "--solver", solver, *some, "-o", output]) == 1
    text = str(tmp_path / "results.json")
    assert run(["benchmark", "results", one, two, "-o", text]) == 0
    table = json.loads((tmp_path / "results.json").read_text())
    assert set(table["solvers"]) == {"DOP853", "RK45"}
    for solver in table["solvers"].values():
        assert solver["processor"] == processor()
        assert solver["package"].startswith("scipy ")
    both = read_results(text)
    for path in (one, two):
        dataset = squealpipe.load(path)
        ours = both.sel(solver=dataset.solver.values, problem=dataset.problem.values)
        assert (ours.verdict.values == dataset.verdict.values).all()
    capsys.readouterr()
    assert run(["benchmark", "compare", one, text]) == 1  # which has one solver more
    assert run(["benchmark", "compare", text, text]) == 0
    assert run(["benchmark", "results", one, one, "-o", text, "--force"]) == 2
    assert "two results of 'DOP853'" in capsys.readouterr().err
    assert run(["benchmark", "compare", one, str(tmp_path / "mine.json")]) == 2
    assert run(["benchmark", "results", text, "-o", str(tmp_path / "more.json")]) == 2
    other = tmp_path / "other.json"
    for change, said in (
        ({"benchmark_version": 1}, "by version 1 of the benchmark"),
        ({"tolerances": table["tolerances"][:1]}, "no JSON of results"),
        ({"results": [{**table["results"][0], "verdict": ["fine"]}]}, "'fine'"),
        ({"results": []}, "no JSON of results"),
    ):
        other.write_text(json.dumps(table | change))
        assert run(["benchmark", "compare", str(other), text]) == 2
        assert said in capsys.readouterr().err
    assert "Traceback" not in capsys.readouterr().err


def test_shipped_results_name_what_made_them(tmp_path, capsys):
    table = shipped()
    problems = {data["name"] for data in all_data()}
    for name, solver in table["solvers"].items():
        assert "unknown" not in solver.values(), name
        asked = {e["problem"] for e in table["results"] if e["solver"] == name}
        assert asked == problems, name
    mine = str(tmp_path / "mine.nc")
    some = ["--problem", "two gates", "-o", mine]
    assert run(["benchmark", "--solver", "DOP853", *some]) == 0
    run(["benchmark", "compare", mine, "shipped"])
    assert "shipped: " in capsys.readouterr().out


def test_problems_as_json_hold_references_of_thirty_digits(tmp_path):
    output = tmp_path / "problems.json"
    assert run(["benchmark", "problems", "-o", str(output)]) == 0
    table = json.loads(output.read_text())
    for problem in table["problems"]:
        digits = problem["reference"].get("digits", {})
        assert digits == references()[problem["name"]].get("digits", {})
        assert ("unknowable" in problem) == (not digits)


ELSEWHERE = r"""
BEGIN {
  print "{\"solver\": \"closed form\", \"answers\": ["
  v = 0; g = 1.0; r = 0.9; t = sqrt(2 / g); speed = g * t; n = 0
  while (t < 26.0) {
    times[n++] = t; speed *= r; start = t; t += 2 * speed / g
  }
  left = 26.0 - start
  y = speed * left - g * left * left / 2; v = speed - g * left
  printf "{\"problem\": \"bouncing ball\", \"tolerance\": 1e-8, \"times\": ["
  for (i = 0; i < n; i++) printf "%s%.17g", (i ? ", " : ""), times[i]
  printf "], \"kinds\": ["
  for (i = 0; i < n; i++) printf "%s\"impact\"", (i ? ", " : "")
  printf "], \"state\": [%.17g, %.17g], \"evaluations\": %d}\n]}\n", y, v, n
}
"""


def test_answers_of_another_language_are_scored(tmp_path, capsys):
    """The closed form of the bouncing ball, in awk."""
    awk = shutil.which("awk")
    if awk is None:
        pytest.skip("no awk on this machine")
    done = subprocess.run([awk, ELSEWHERE], capture_output=True, text=True, check=True)
    answers, output = tmp_path / "answers.json", tmp_path / "theirs.nc"
    answers.write_text(done.stdout)
    assert run(["benchmark", "score", str(answers), "-o", str(output)]) == 0
    found = squealpipe.load(output)
    assert found.solver.values.tolist() == ["closed form"]
    assert found.attrs["processor"] == "unknown"
    assert squealpipe.labels(found.verdict).values.tolist() == [[["right"]]]

    table = json.loads(answers.read_text())
    table["answers"][0]["times"].pop()
    table["answers"][0]["kinds"].pop()
    answers.write_text(json.dumps(table))
    assert run(["benchmark", "score", str(answers), "-o", str(output), "--force"]) == 1
    table["answers"][0]["knids"] = []
    answers.write_text(json.dumps(table))
    assert run(["benchmark", "score", str(answers), "-o", str(output), "--force"]) == 2
    assert "'knids' is unknown" in capsys.readouterr().err


def test_problems_are_written_for_any_language(tmp_path):
    path = tmp_path / "problems.json"
    assert run(["benchmark", "problems", "-o", str(path)]) == 0
    problems = json.loads(path.read_text())["problems"]
    assert len(problems) == 32
    for problem in problems:
        assert {"field", "switches", "start", "reference"} <= set(problem)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("cpu_time", "fast", "answer 0: cpu_time 'fast'"),
        ("evaluations", -3, "answer 0: evaluations -3"),
        ("problem", [1], "answer 0: problem [1] is unknown"),
        ("tolerance", True, "answer 0: tolerance True"),
        ("solver", None, "solver None"),
        ("answers", 5, "'answers' is no list"),
    ],
)
def test_an_answer_that_cannot_be_read_is_refused_by_its_number_and_key(
    key, value, words, tmp_path
):
    answer = {
        "problem": "two gates",
        "tolerance": 1e-8,
        "times": None,
        "kinds": None,
        "state": [0, 0],
        "evaluations": None,
        "cpu_time": None,
    }
    table = {"solver": "mine", "answers": [answer]}
    path = tmp_path / "answers.json"
    path.write_text(json.dumps(table))
    assert score_answers(path).verdict.size == 1
    (answer if key in answer else table)[key] = value
    path.write_text(json.dumps(table))
    with pytest.raises(ValueError, match=re.escape(words)):
        score_answers(path)
