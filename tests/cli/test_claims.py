"""``squealpipe claims``: one line each at any width, details by id, filters and JSON."""

import json

import numpy as np
import pytest

from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.linear.maps import quasi_static_map, stability_map
from squealpipe.cli import run
from squealpipe.paper.claims.judge import judge
from squealpipe.parameters import SCENES, Parameters
from squealpipe.store.netcdf import save
from squealpipe.store.provenance import stamped

SCENE = SCENES["F2d"]


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """Verdicts on what two datasets can decide."""
    angles = np.linspace(0.0, np.pi, 41)
    params = Parameters()
    found = {
        "simulate/F2d": simulate(params, SCENE.alpha1, SCENE.alpha2, t_end=SCENE.t_end)
    }
    mended = params.with_(belt_speed=-100.0)
    for of, belt in (("", params), ("corrected/", mended)):
        found[f"{of}quasi_static_map"] = quasi_static_map(belt, angles, angles)
        found[f"{of}stability_map"] = stability_map(belt, angles, angles)
    path = tmp_path_factory.mktemp("claims") / "claims.nc"
    save(stamped(lambda: judge(params, found, "as_printed"), config={}), path)
    return str(path)


@pytest.mark.parametrize("width", [40, 80, 200])
def test_a_line_for_each_statement_at_any_width(width, file, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    assert run(["claims", "--file", file]) in {0, 1}
    every = capsys.readouterr().out.splitlines()
    end = next(number for number, line in enumerate(every) if "statements;" in line)
    lines, changed = every[:end], every[end + 3 :]
    assert all(len(line) <= width for line in lines + changed)
    assert every[end].startswith(f"{len(lines)} statements")
    assert every[end + 2] == "With friction of one sign throughout these change:"
    assert [line.split()[:2] for line in changed] == [
        [name, "fails"] for name in ("F6b", "F6c", "C2")
    ]
    assert lines[0].split()[0] == "T1"
    statement = "contact is kept throughout at (0.5π, π)"
    assert lines[4].removesuffix("…").split("  ")[-1].strip() in statement


def test_one_statement_in_full(file, capsys):
    assert run(["claims", "f2d", "--file", file]) in {0, 1}
    out = capsys.readouterr().out
    assert out.startswith("F2d  holds")
    assert "separations up to t = 50" in out
    assert len(out.splitlines()) < 12


def test_only_a_verdict(file, capsys):
    def listed(*words):
        run(["claims", *words, "--json", "--file", file])
        return json.loads(capsys.readouterr().out)

    for verdict in ("fails", "holds"):
        found = listed("--only", verdict)
        assert found == [row for row in listed() if row["verdict"] == verdict] != []


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["XYZ"], "no statement 'XYZ'; known: T1"),
        (
            ["--only", "maybe"],
            "no statement has this verdict; cannot be decided, fails, holds",
        ),
    ],
)
def test_wrong_requests_say_what_there_is(words, message, file, capsys):
    assert run(["claims", *words, "--file", file]) == 2
    assert message in capsys.readouterr().err
