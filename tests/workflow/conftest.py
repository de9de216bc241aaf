"""Dry runs of a finished tiny study, many at a time."""

import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pytest

TINY = "workflow/config/tiny.yaml"


@dataclass(frozen=True)
class Plan:
    """What a dry run said: rule → reason, and the files of each job."""

    reasons: dict[str, str]
    files: list[tuple[str, list[str], list[str]]] = field(default_factory=list)
    text: str = ""

    @property
    def rules(self):
        return set(self.reasons) - {"all"}


def read(text):
    """Rules, reasons, inputs and outputs from the text of a dry run."""
    blocks = re.split(r"^(?:local)?rule (\w+):$", text, flags=re.MULTILINE)[1:]
    reasons, files = {}, []
    for rule, block in zip(blocks[::2], blocks[1::2], strict=True):
        entries = dict(re.findall(r"^    (\w+): (.*)$", block, flags=re.MULTILINE))
        reasons[rule] = f"{reasons.get(rule, '')} {entries.get('reason', '')}".strip()
        files.append(
            (rule, entries.get("input", "").split(", "), entries.get("output", "").split(", "))
        )
    return Plan(reasons, files, text)


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
        return [read(text) for _, text in answers]

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
