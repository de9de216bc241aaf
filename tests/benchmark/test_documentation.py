"""The page's example of a solver and its reproducers do what the page says."""

import re
from pathlib import Path

from squealpipe.benchmark.adapters import SOLVERS
from squealpipe.benchmark.problems import all_data
from squealpipe.benchmark.results import shipped
from squealpipe.cli import run

PAGE = (Path(__file__).parents[2] / "docs/benchmark.md").read_text("utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, flags=re.MULTILINE | re.DOTALL)


def test_example_of_a_solver_runs(tmp_path, capsys):
    (tmp_path / "mine.py").write_text(BLOCKS[0])
    solver = f"{tmp_path / 'mine.py'}:solve"
    some = [
        "--problem",
        "thermostat",
        "--problem",
        "light barrier",
        "--tolerance",
        "1e-8",
    ]
    assert (
        run(["benchmark", "--solver", solver, *some, "-o", str(tmp_path / "mine.nc")])
        == 1
    )
    text = capsys.readouterr().out
    assert "light barrier: 1e-08 silently wrong (2 missed" in text
    assert "thermostat: 1e-08" in text


def test_reproducers_show_the_errors(capsys):
    exec(BLOCKS[1], {})  # noqa: S102 (our own page)
    *missed, spurious = capsys.readouterr().out.split("\n[array(")
    assert missed == ["[array([], dtype=float64)]", *["[], dtype=float64)]"] * 2]
    assert spurious.count(",") == 6
    exec(BLOCKS[2], {})  # noqa: S102
    assert "time_limit" in capsys.readouterr().out


SIGNS = {"right": "✓", "flagged": "!", "silently_wrong": "✗", "not_applicable": "–"}


def table_of_solvers():
    """The page's table from the shipped results of integrators that report events."""
    results = shipped()
    verdicts = {(e["problem"], e["solver"]): e["verdict"] for e in results["results"]}
    modules = {name: SOLVERS[name][0] for name in results["solvers"]}
    solvers = [n for n, m in modules.items() if m not in {"tanh", "moreau_jean"}]
    names = ["ours" if name == "squealpipe" else name for name in solvers]
    rows = [["problem", "what it tests", *names], ["---"] * (len(names) + 2)]
    for data in all_data():
        signs = [
            "".join(SIGNS[verdict] for verdict in verdicts[data["name"], solver])
            for solver in solvers
        ]
        rows.append([data["name"], data["purpose"], *signs])
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    lines[1] = "|" + "|".join(rows[1]) + "|"
    return "\n".join(lines)


def test_table_is_that_of_the_shipped_results():
    """Where it is not: print ``table_of_solvers()`` and put it there."""
    assert table_of_solvers() in PAGE
