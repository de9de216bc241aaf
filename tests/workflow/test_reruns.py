"""An edit makes exactly those rules stale that read it, and what they feed; a rewording nothing.

`direct_readers.yaml` states for every key of the configuration which rules read it; whatever
those rules feed follows from the files that they exchange. Snakemake is asked by dry runs.
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
from squealpipe.rerun.sources import closure

pytestmark = pytest.mark.release


ROOT = Path(__file__).resolve().parents[2]
TINY = "workflow/config/tiny.yaml"
STATED = Path(__file__).with_name("direct_readers.yaml")
FIX = "SQUEALPIPE_FIX=1 python -m pytest -m release tests/workflow/test_reruns.py"
KEYS = sorted(set(flat(Study().model_dump(mode="json"))) - {"results", "paper"})


def downstream(rules, planned):
    """Those rules and all that they feed, by the files that rules exchange."""
    maker = {path: row["rule"] for path, row in planned.items()}
    reads = {row["rule"]: {maker.get(path) for path in row["inputs"]} for row in planned.values()}
    reached: set[str] = set()
    while reached != (reached := set(rules) | {rule for rule in reads if reads[rule] & reached}):
        pass
    return reached


@pytest.fixture(scope="module")
def planned(study_copy):
    """File → what it should be made from, as the workflow states it."""
    plan = study_copy / "plan.json"
    subprocess.run(
        [sys.executable, "-m", "snakemake", "--summary", "--configfile", TINY],
        cwd=study_copy,
        env={**os.environ, "PYTHONPATH": str(study_copy), PLAN: str(plan)},
        capture_output=True,
        check=True,
    )
    return json.loads(plan.read_text())


def test_each_key_is_in_the_slices_of_exactly_those_rules_that_read_it(planned):
    found: dict[str, set[str]] = {key: set() for key in KEYS}
    for row in planned.values():
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
    expected = yaml.safe_load(STATED.read_text())
    wrong = {
        key: f"stated {expected.get(key)}, found {listed[key]}"
        for key in KEYS
        if expected.get(key) != listed[key]
    }
    assert not wrong, f"{wrong}\nif that is meant, fix the file with: {FIX}"


EDITS = {
    "parameters.mu": "parameters: {mu: 0.35}",
    "linear.points": "linear: {points: 41}",
    "dynamics.validity_points": "dynamics: {validity_points: 23}",
    "comparison.ladder.horizon": "comparison: {ladder: {horizon: 25.0}}",
    "backbones.coupled.coupled": "backbones: {coupled: {coupled: [0.3, 0.85]}}",
    "cycles.points": "cycles: {points: 31}",
    "robustness.samples": "robustness: {samples: 128}",
    "inference.samples": "inference: {samples: 129}",
}


def test_an_edit_of_a_key_makes_its_readers_stale_and_what_they_feed(
    study_copy, dry_runs, planned, tmp_path
):
    """One key of each section; the slices of the others are held above."""
    arguments = []
    for key, text in EDITS.items():
        path = tmp_path / f"{key}.yaml"
        path.write_text(text)
        arguments.append(["--configfile", TINY, path])
    stated = yaml.safe_load(STATED.read_text())
    for key, plan in zip(EDITS, dry_runs(study_copy, arguments), strict=True):
        assert plan.rules == downstream(stated[key], planned), key


def test_no_key_is_idle_and_no_number_of_the_physics_reaches_drawing_without_a_dataset():
    for key, readers in yaml.safe_load(STATED.read_text()).items():
        drawing = [rule for rule in readers if rule.startswith("draw_")]
        assert readers, key
        assert not drawing or not key.startswith("parameters."), key


REWORDINGS = {
    "comments": lambda text: "# a comment\n" + text.replace("\n", "  # more\n", 3),
    "blank lines": lambda text: text.replace("\n", "\n\n"),
    "1.0 as 1": lambda text: text.replace("mass: 1.0", "mass: 1"),
    "exponent": lambda text: text.replace("sigma: 1000.0", "sigma: 1e3"),
    "order": lambda text: yaml.safe_dump(yaml.safe_load(text), sort_keys=True),
    "flow style": lambda text: yaml.safe_dump(yaml.safe_load(text), default_flow_style=True),
}


def test_rewording_the_configuration_reruns_nothing(study_copy, dry_runs, tmp_path):
    text = (study_copy / "workflow/config/paper.yaml").read_text()
    arguments = []
    for name, reword in REWORDINGS.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(reword(text))
        assert path.read_text() != text
        arguments.append(["--configfile", path, TINY])
    made = dict(zip(REWORDINGS, dry_runs(study_copy, arguments), strict=True))
    assert {name: plan.rules for name, plan in made.items() if plan.rules} == {}


def test_new_dates_rerun_nothing_and_neither_does_an_edit_taken_back(study_copy, dry_runs):
    for path in [*study_copy.glob("squealpipe/**/*.py"), *study_copy.glob("workflow/**/*.*")]:
        path.touch()
    edited = study_copy / "squealpipe/laws/springs.py"
    text = edited.read_text()
    edited.write_text(text + "ANOTHER = 1\n")
    assert dry_runs(study_copy, [["--configfile", TINY]])[0].rules
    edited.write_text(text)
    assert dry_runs(study_copy, [["--configfile", TINY]])[0].rules == set()


LAYERS = {
    "laws/springs.py": ({"map_linear"}, {"draw_model"}),
    "tasks/linear/maps.py": ({"map_linear"}, {"draw_model"}),
    "study/figures/linear/fig06.py": ({"draw_linear"}, {"map_linear", "draw_model"}),
    "study/report/build.py": ({"write_report"}, {"map_linear", "draw_linear"}),
    "store/archive.py": (set(), {"write_report"}),
}
"""Module → rules that its edit must reach, and some that it must not."""


def test_edited_sources_reach_what_imports_them_and_reworded_ones_nothing(
    study_copy, dry_runs, planned
):
    def rules_after(module, edit):
        path = study_copy / "squealpipe" / module
        text = path.read_text()
        path.write_text(edit(text))
        try:
            return dry_runs(study_copy, [["--configfile", TINY]])[0].rules
        finally:
            path.write_text(text)

    assert (
        rules_after("laws/springs.py", lambda text: text.replace('"""', '# more\n"""Anew. ', 1))
        == set()
    )
    for module, (stale, fresh) in LAYERS.items():
        found = rules_after(module, lambda text: text + "ANOTHER = 1\n")
        path = str(study_copy / "squealpipe" / module)
        reads = {row["rule"] for row in planned.values() if path in row["sources"]}
        assert found == downstream(reads, planned), module
        assert stale <= found, module
        assert not found & fresh, module


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
    scripts = sorted((ROOT / "workflow/scripts").glob("*/*.py"))
    run = subprocess.run(
        [sys.executable, "-c", LOADED, *map(str, scripts)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = dict(map(json.loads, run.stdout.splitlines()))
    assert len(loaded) == len(scripts)
    missing = {
        script: set(map(Path, modules)) - set(closure(script)) for script, modules in loaded.items()
    }
    assert not any(missing.values()), f"loaded, but not among the sources of the rule: {missing}"
