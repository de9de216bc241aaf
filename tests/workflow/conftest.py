"""Dry runs of a finished tiny study, many at a time."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

TINY = "workflow/config/tiny.yaml"


class Plan(NamedTuple):
    """Rules that a dry run would run, and all that it printed."""

    rules: set[str]
    text: str


@pytest.fixture(scope="session")
def dry_runs():
    """Plans of several dry runs in one checkout, each with its own arguments."""

    def run(checkout, arguments):
        process = subprocess.run(
            [sys.executable, str(Path(__file__).with_name("dry_runs.py"))],
            input=json.dumps([list(map(str, words)) for words in arguments]),
            cwd=checkout,
            env={**os.environ, "PYTHONPATH": str(checkout)},
            capture_output=True,
            text=True,
            check=True,
        )
        answers = json.loads(process.stdout)
        for code, text in answers:
            assert code == 0, text
        rule = re.compile(r"^(?:local)?rule (\w+):$", flags=re.MULTILINE)
        return [Plan(set(rule.findall(text)) - {"all"}, text) for _, text in answers]

    return run


@pytest.fixture(scope="module")
def one_checkout(new_checkout, tmp_path_factory):
    """One for all tests of a file: in each new one the engine is compiled anew."""
    return new_checkout(tmp_path_factory.mktemp("one") / "squealpipe")


@pytest.fixture(scope="module")
def study_copy(tiny_study, tmp_path_factory):
    """A finished tiny study whose files may be edited; dates are kept."""
    copy = tmp_path_factory.mktemp("edited") / "squealpipe"
    subprocess.run(["cp", "-a", tiny_study.checkout, copy], check=True)
    return copy
