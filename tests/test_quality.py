"""The code keeps its own rules: lint, format, types, and imports that point one way."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.mark.parametrize(
    "command",
    [
        ("ruff", "check", "."),
        ("ruff", "format", "--check", "."),
        pytest.param(("mypy",), marks=pytest.mark.release),
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


INSIDE_FUNCTIONS = {
    "squealpipe/systems/system.py": "cycles load scipy.interpolate, which runs do not need",
    "squealpipe/structures/structure.py": "runs load the compiler, which modes do not need",
    "squealpipe/study/forked_jobs.py": "it imports once it looks for no garbage",
}
"""Modules that may import parts of the package inside functions; the command line may, too: a
command loads what it needs, so that ``--help`` is quick."""
BY_NAME = {
    "squealpipe/systems/shipped/brake.py": "import path of 1.0.0; systems stand alone",
    "squealpipe/__init__.py": "public names are loaded on first use",
    "squealpipe/benchmark/adapters/__init__.py": "a solver is loaded if it is asked for",
    "squealpipe/schema/__init__.py": "schemas register themselves by their module's name",
    "squealpipe/study/figures/declared.py": "figures do, too",
    "squealpipe/study/forked_jobs.py": "libraries of jobs, which need not be there",
}
"""Modules that may import by a name that is computed, which no contract sees."""


def _imports_inside(function):
    for node in ast.walk(function):
        if isinstance(node, ast.ImportFrom):
            names = [str(node.module)]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        yield from (n for n in names if n.partition(".")[0] == "squealpipe")


def test_no_import_hides_from_the_contracts():
    inside, by_name = set(), set()
    # the formatter lets an import begin its line; where neither word stands nothing is parsed
    either = re.compile(
        r"^[ \t]+(from|import) [^\n]*\bsquealpipe|import_module|__import__",
        re.MULTILINE,
    )
    for path in sorted((ROOT / "squealpipe").rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if not either.search(text):
            continue
        place = str(path.relative_to(ROOT))
        for node in ast.walk(ast.parse(text)):
            is_function = isinstance(node, ast.FunctionDef)
            if is_function and place not in inside and any(_imports_inside(node)):
                inside.add(place)
            func = getattr(node, "func", None)
            called = getattr(func, "attr", getattr(func, "id", ""))
            if called in {"import_module", "__import__"}:
                by_name.add(place)
    inside = {n for n in inside if not n.startswith("squealpipe/cli/")}
    assert inside == set(INSIDE_FUNCTIONS)
    assert by_name == set(BY_NAME)


def test_no_module_takes_the_name_of_what_its_package_defines():
    """``schema.labels`` was a function until a module of that name was imported."""
    for path in (ROOT / "squealpipe").rglob("__init__.py"):
        defined = {
            node.name
            for node in ast.parse(path.read_bytes()).body
            if isinstance(node, ast.FunctionDef | ast.ClassDef)
        }
        modules = {each.stem for each in path.parent.iterdir()}
        assert not defined & modules, path


def test_docstrings_open_with_a_verb_or_a_noun():
    opens = re.compile(
        r'^ *"""(?:Of|What|Which|Whether|Where|How|When|Why|The same)\b.*', re.MULTILINE
    )
    texts = {
        path: path.read_text(encoding="utf-8")
        for path in [*ROOT.glob("squealpipe/**/*.py"), *ROOT.glob("workflow/**/*.py")]
    }
    assert len(texts) > 500
    found = [(p, each) for p, text in texts.items() for each in opens.findall(text)]
    # what a check measures stands in datasets, too, and archives are compared with them
    kept = ROOT / "squealpipe/paper/claims/checks/misprints.py"
    words = '    """How many of the four dimensionless groups the paper prints."""'
    assert found == [(kept, words)]
