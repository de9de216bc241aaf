"""Which rules an edit makes stale: those whose slice of the configuration or sources hold it.

`direct_readers.yaml` states for every key of the configuration which rules read it; what these
feed follows from the files that they exchange, which test_edited_study.py runs.
"""

import json
import os
import subprocess
import sys
from importlib.util import source_from_cache
from pathlib import Path

import pytest
import yaml

from squealpipe.store.rerun.key import PLAN_VARIABLE, WATCHERS
from squealpipe.store.rerun.sources import PACKAGE, closure
from squealpipe.store.yaml_files import flat
from squealpipe.study.configuration.settings import Study

ROOT = Path(__file__).resolve().parents[2]
STATED = Path(__file__).with_name("direct_readers.yaml")
FIX = "SQUEALPIPE_FIX=1 python -m pytest -m release tests/workflow/test_reruns.py"
OF_OTHERS = {"results", "paper", "structure", "modifications", "operating"}
KEYS = sorted(set(flat(Study().model_dump(mode="json"))) - OF_OTHERS)


@pytest.fixture(scope="module")
def planned(tmp_path_factory):
    """What each file should be made from, as the workflow states it."""
    folder = tmp_path_factory.mktemp("plan")
    words = ["-m", "snakemake", "--summary", "--directory", str(folder)]
    subprocess.run(
        [sys.executable, *words, "--configfile", "workflow/config/tiny.yaml"],
        cwd=ROOT,
        env={**os.environ, PLAN_VARIABLE: str(folder / "plan.json")},
        capture_output=True,
        check=True,
    )
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
    "brake/linear/maps.py": ({"map_linear"}, {"draw_model"}),
    "paper/figures/linear/fig06.py": ({"draw_linear"}, {"map_linear", "draw_model"}),
    "study/report/build.py": ({"write_report"}, {"map_linear", "draw_linear"}),
    "study/archive.py": (set(), {"write_report"}),
    "study/sweep.py": (set(), {"map_linear", "write_report"}),
}
"""Module → rules that its edit must reach, and some that it must not."""


@pytest.mark.parametrize("module", LAYERS)
def test_edited_sources_reach_what_imports_them(planned, module):
    stale, fresh = LAYERS[module]
    reads = {row["rule"] for row in planned if str(PACKAGE / module) in row["sources"]}
    assert stale <= reads
    assert not reads & fresh


def test_of_the_figures_of_a_rule_an_edit_of_one_reaches_that_one_alone(planned):
    """The rule draws them all; ``explain`` lists which change."""
    edited = str(PACKAGE / "paper/figures/linear/critical_friction.py")
    drawn = [row for row in planned if row["rule"] == "draw_linear"]
    assert len(drawn) > 8
    reached = [row for row in drawn if edited in row["imports"]]
    assert {row["key"].rpartition("/")[2] for row in reached} == {
        "critical_friction.png",
        "critical_friction.svg",
    }
    assert {path.rpartition("/")[2] for row in reached for path in row["reads"]} == {
        "critical_friction_map.nc",
        "critical_damping_map.nc",
    }


NO_INPUTS = ("results/", ".snakemake/", ".git/")
"""What scripts read beside inputs: results and records of the workflow."""


def tables_and_watchers():
    """Tables of datasets with what they import, all read to get one by name; what watches jobs.

    The table of a dataset that a script reads is in the key of the rule that wrote it. A stub
    says in which module a public name stands, and that module is an input.
    """
    modules = [*PACKAGE.rglob("*.py")]
    tables = [path for path in modules if "schema" in (*path.parts, path.stem)]
    imported = {path for table in tables for path in closure(table)}
    rooms = {table.parent / "__init__.py" for table in tables}
    rooms |= {table.parent.parent / "__init__.py" for table in tables}
    watchers = [path for path in modules if path.name in WATCHERS]
    stubs = PACKAGE.rglob("__init__.pyi")
    beside = [*tables, *imported, *rooms, *watchers, *stubs]
    return {str(path.relative_to(ROOT)) for path in beside}


def test_every_module_and_data_file_that_a_script_really_reads_is_an_input(
    tiny_study, planned
):
    """The scripts of a whole study were watched while they ran (see the folder ``watch``)."""
    allowed: dict[str, list[set[str]]] = {}
    for row in planned:
        files = {
            os.path.relpath(path, ROOT) for path in [*row["sources"], *row["inputs"]]
        }
        script = next(path for path in files if path.startswith("workflow/scripts/"))
        allowed.setdefault(Path(script).name, []).append(files)
    logs = {log: log.name.partition(".")[2] for log in tiny_study.read.iterdir()}
    assert {*logs.values()} == {*allowed}
    assert not missing_inputs(logs, allowed)


def missing_inputs(logs, allowed):
    """Script → what it read and none of its rules has as an input."""
    missing, beside = {}, tables_and_watchers()
    for log, script in logs.items():
        opened = log.read_text().splitlines()
        # modules that jobs share are imported before the fork: a script may need no other
        assert opened, script
        read = {
            path
            for line in opened
            if (path := _source_of(line)) and not path.startswith(NO_INPUTS)
        }
        read -= beside
        unlisted = min((read - files for files in allowed[script]), key=len)
        if unlisted:
            missing[script] = missing.get(script, set()) | unlisted
    return missing


def _source_of(opened):
    """A data file, or the module whose byte code was loaded; code that was only read is none."""
    if opened.endswith(".pyc"):
        opened = source_from_cache(opened)
    elif opened.endswith(".py"):
        return ""
    return opened if (ROOT / opened).is_file() else ""
