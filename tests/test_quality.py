"""The code keeps its own rules: lint, format, types, and imports that point one way."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
MAKEFILE = (ROOT / "Makefile").read_text().replace("\\\n", "")
SCRIPTS = re.search(r"^SCRIPTS := (.*)$", MAKEFILE, flags=re.MULTILINE).group(1).split()


@pytest.mark.parametrize(
    "command",
    [
        ("ruff", "check", "."),
        ("ruff", "format", "--check", "."),
        pytest.param(("mypy",), marks=pytest.mark.release),
        pytest.param(("mypy", *SCRIPTS), marks=pytest.mark.release),
        pytest.param(("lint-imports", "--no-cache"), marks=pytest.mark.release),
    ],
    ids=lambda command: " ".join(command[:2]),
)
def test_tool_finds_nothing(command):
    tool = Path(sys.executable).with_name(command[0])
    run = subprocess.run(
        [str(tool), *command[1:]], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr


def test_hooks_watch_files_that_exist():
    """A pattern that matches nothing checks nothing."""
    hooks = (ROOT / ".pre-commit-config.yaml").read_text()
    tracked = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    patterns = re.findall(r"files: (\S+)", hooks)
    assert patterns
    for pattern in patterns:
        alternatives = re.search(r"\(([^)]*)\)", pattern)
        for each in alternatives.group(1).split("|") if alternatives else [""]:
            narrowed = pattern.replace(alternatives.group(), each) if each else pattern
            assert any(re.search(narrowed, name) for name in tracked), narrowed
