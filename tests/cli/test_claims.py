"""``squealpipe claims``: one line each at any width, details by id, filters, CSV and JSON."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

from squealpipe.cli import run

FILE = str(Path(__file__).resolve().parents[2] / "results/archive/reference/data/claims.nc")


@pytest.mark.parametrize("width", [40, 80, 200])
def test_a_line_for_each_statement_at_any_width(width, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    assert run(["claims", FILE]) in {0, 1}
    *lines, last = capsys.readouterr().out.splitlines()
    assert all(len(line) <= width for line in lines)
    assert last.startswith(f"{len(lines)} statements")
    assert lines[0].split()[0] == "T1"
    statement = "contact is kept throughout at (0.5π, π)"
    assert lines[4].removesuffix("…").split("  ")[-1].strip() in statement


def test_one_statement_in_full(capsys):
    assert run(["claims", "f2d", "--file", FILE]) in {0, 1}
    out = capsys.readouterr().out
    assert out.startswith("F2d  holds")
    assert "separations up to t = 50" in out
    assert len(out.splitlines()) < 12


def test_only_a_verdict(capsys):
    run(["claims", "--json", FILE])
    every = json.loads(capsys.readouterr().out)
    run(["claims", "--only", "fails", "--json", FILE])
    fails = json.loads(capsys.readouterr().out)
    assert fails == [row for row in every if row["verdict"] == "fails"]
    run(["claims", "--only", "holds", "--json", FILE])
    holds = json.loads(capsys.readouterr().out)
    assert holds
    assert {row["verdict"] for row in holds} == {"holds"}


def test_csv_has_every_column_of_json(capsys):
    run(["claims", "--json", FILE])
    every = json.loads(capsys.readouterr().out)
    run(["claims", "--csv", FILE])
    table = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [row["evidence"] for row in table] == [row["evidence"] for row in every]
    assert list(table[0]) == list(every[0])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["XYZ", "--file", FILE], "no statement 'XYZ'; known: T1"),
        (["--only", "maybe", FILE], "no statement has this verdict; cannot be decided, depends on"),
        (["a.nc", "b.nc"], "give one file of verdicts"),
    ],
)
def test_wrong_requests_say_what_there_is(words, message, capsys):
    assert run(["claims", *words]) == 2
    assert message in capsys.readouterr().err
