"""Which rules an edit makes stale: those whose slice of the configuration or sources hold it.

`direct_readers.yaml` states for every key of the configuration which rules read it; what these
feed follows from the files that they exchange, which test_edited_study.py runs.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from squealpipe.config.settings import Study
from squealpipe.config.yaml_files import flat
from squealpipe.rerun.key import PLAN
from squealpipe.rerun.sources import PACKAGE, closure

pytestmark = pytest.mark.release

ROOT = Path(__file__).resolve().parents[2]
STATED = Path(__file__).with_name("direct_readers.yaml")
FIX = "SQUEALPIPE_FIX=1 python -m pytest -m release tests/workflow/test_reruns.py"
KEYS = sorted(set(flat(Study().model_dump(mode="json"))) - {"results", "paper"})


@pytest.fixture(scope="module")
def planned(tmp_path_factory):
    """What each file should be made from, as the workflow states it."""
    folder = tmp_path_factory.mktemp("plan")
    words = ["-m", "snakemake", "--summary", "--directory", str(folder)]
    subprocess.run(
        [sys.executable, *words, "--configfile", "workflow/config/tiny.yaml"], cwd=ROOT,
        env={**os.environ, PLAN: str(folder / "plan.json")}, capture_output=True, check=True,
    )  # fmt: skip
    return json.loads((folder / "plan.json").read_text()).values()


def test_each_key_is_in_the_slices_of_exactly_those_rules_that_read_it(planned):
    found: dict[str, set[str]] = {key: set() for key in KEYS}
    for row in planned:
        part = flat(row["settings"])
        part |= {"reading": part["read_as"]} if "read_as" in part else {}
        for key in found.keys() & part.keys():
            found[key].add(row["rule"])
    listed = {key: sorted(rules) for key, rules in found.items()}
    if os.environ.get("SQUEALPIPE_FIX"):
        STATED.write_text(
            "# Which rules read a key; what they feed is not listed. Checked, and rewritten by\n"
            f"# {FIX}\n" + yaml.safe_dump(listed, width=100)
        )
    stated = yaml.safe_load(STATED.read_text())
    wrong = {
        key: (stated.get(key), listed[key])
        for key in KEYS
        if stated.get(key) != listed[key]
    }
    assert not wrong, (
        f"(stated, found): {wrong}\nif that is meant, fix the file with: {FIX}"
    )


def test_no_key_is_idle_and_no_figure_is_drawn_from_a_number_of_the_physics():
    for key, readers in yaml.safe_load(STATED.read_text()).items():
        assert readers, key
        draws = [rule for rule in readers if rule.startswith("draw_")]
        assert not (draws and key.startswith("parameters.")), key


LAYERS = {
    "laws/springs.py": ({"map_linear"}, {"draw_model"}),
    "tasks/linear/maps.py": ({"map_linear"}, {"draw_model"}),
    "study/figures/linear/fig06.py": ({"draw_linear"}, {"map_linear", "draw_model"}),
    "study/report/build.py": ({"write_report"}, {"map_linear", "draw_linear"}),
    "store/archive.py": (set(), {"write_report"}),
    "execution/sweep.py": (set(), {"map_linear", "write_report"}),
}
"""Module → rules that its edit must reach, and some that it must not."""


@pytest.mark.parametrize("module", LAYERS)
def test_edited_sources_reach_what_imports_them(planned, module):
    stale, fresh = LAYERS[module]
    reads = {row["rule"] for row in planned if str(PACKAGE / module) in row["sources"]}
    assert stale <= reads
    assert not reads & fresh


LOADED = """
import ast, importlib, json, os, sys
for name in ("numpy", "xarray", "scipy.optimize", "matplotlib.figure", "heyoka", "numba", "jinja2"):
    importlib.import_module(name)
for script in sys.argv[1:]:
    if os.fork() == 0:
        tree = ast.parse(open(script).read())
        imports = [node for node in tree.body if isinstance(node, (ast.Import, ast.ImportFrom))]
        exec(compile(ast.Module(imports, []), script, "exec"))
        own = [m.__file__ for n, m in sys.modules.items() if n.split(".")[0] == "squealpipe"]
        print(json.dumps([script, own]), flush=True)
        os._exit(0)
    assert os.wait()[1] == 0, script
"""


def test_sources_hold_every_module_that_python_really_loads():
    scripts = sorted(map(str, (ROOT / "workflow/scripts").glob("*/*.py")))
    command = [sys.executable, "-c", LOADED, *scripts]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    loaded = dict(map(json.loads, run.stdout.splitlines()))
    assert list(loaded) == scripts
    missing = {
        name: {*map(Path, own)} - {*closure(Path(name))} for name, own in loaded.items()
    }
    assert not any(missing.values()), (
        f"loaded, but not among the sources of the rule: {missing}"
    )
