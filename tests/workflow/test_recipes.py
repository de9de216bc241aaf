"""The recipes of CONTRIBUTING.md, followed to the letter in a copy of the project."""

import difflib
import json
import os
import re
import subprocess
import sys
from textwrap import indent

import pytest

from squealpipe.store.rerun.key import PLAN_VARIABLE
from tests.conftest import ROOT

ROW, LAW, LAW_NAME, RECORD, FIGURE, FIGURE_NAME, SYSTEM, READER = range(8)
SCHEMA, TASK, SCRIPT, RULE = range(8, 12)
FILES = {
    LAW: "squealpipe/laws/friction_laws/rising.py",
    FIGURE: "squealpipe/paper/figures/dynamics/impacts.py",
    SYSTEM: "squealpipe/systems/shipped/pendulum.py",
    SCHEMA: "squealpipe/brake/schema/impact_rate.py",
    TASK: "squealpipe/brake/dynamics/impact_rate.py",
    SCRIPT: "workflow/scripts/dynamics/rate_impacts.py",
}
LINES = {
    ROW: (
        "squealpipe/parameters.py",
        "\n    def __post_init__(self) -> None:\n        for name",
    ),
    RECORD: ("squealpipe/brake/schema/ladder.py", "    a1_short = "),
    READER: ("squealpipe/structures/readers.py", '        ".npy": lambda'),
    LAW_NAME: ("squealpipe/laws/friction_laws/__init__.py", None),
    FIGURE_NAME: ("squealpipe/paper/report/sections.py", None),
}
"""Where a block goes: before a text, or in place of the line that begins as it does."""


def write_down(folder):
    """Take every step; path → lines added and removed in the files that were there before."""
    text = (folder / "CONTRIBUTING.md").read_text()
    recipes = text[text.index("## Recipes") : text.index("## Rules")]
    blocks = re.findall(r"```python\n(.*?)```", recipes, flags=re.DOTALL)
    for number, name in FILES.items():
        assert name in recipes
        assert not (folder / name).exists()
        (folder / name).write_text(blocks[number])
    rules = folder / "workflow/rules/dynamics.smk"
    assert "workflow/rules/dynamics.smk" in recipes
    rules.write_text(f"{rules.read_text()}\n\n{blocks[RULE]}")
    changed = {}
    for number in (ROW, RECORD, FIGURE_NAME):  # these stand in a class or a table
        blocks[number] = indent(blocks[number], "    ")
    blocks[READER] = indent(blocks[READER], " " * 8)
    for number, (name, place) in LINES.items():
        path = folder / name
        assert name in recipes
        before = path.read_text()
        if place is None:
            start = re.escape(re.match(r"\s*\S+ \S+|\s*\S+:", blocks[number]).group())
            after, found = re.subn(
                rf"^{start}.*\n", blocks[number], before, flags=re.MULTILINE
            )
        else:
            after, found = (
                before.replace(place, blocks[number] + place),
                before.count(place),
            )
        assert found == 1, name
        path.write_text(after)
        moved = [
            line[:2] for line in difflib.ndiff(before.splitlines(), after.splitlines())
        ]
        changed[name] = (moved.count("+ "), moved.count("- "))
    return changed


@pytest.fixture(scope="module")
def extended(new_checkout, tmp_path_factory):
    """A copy with one more of each thing that has a recipe; and what that took."""
    folder = new_checkout(tmp_path_factory.mktemp("recipes") / "squealpipe")
    return folder, write_down(folder)


def python(folder, script):
    """Run a script with the package of the copy."""
    run = subprocess.run(
        [sys.executable, "-c", script],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr[-4000:]
    return run.stdout


def test_the_steps_are_as_few_as_promised(extended):
    _, changed = extended
    assert changed == {
        "squealpipe/parameters.py": (8, 0),
        "squealpipe/brake/schema/ladder.py": (1, 0),
        "squealpipe/laws/friction_laws/__init__.py": (1, 1),
        "squealpipe/paper/report/sections.py": (3, 1),
        "squealpipe/structures/readers.py": (1, 0),
    }


PARAMETER_AND_LAW = """
import numpy as np
from squealpipe import Parameters, stability_map
from squealpipe.study.configuration.settings import parse_study
from squealpipe.brake.models.refusals import refuse_unread
from tests.oracles.a1_automaton import A1Automaton
from squealpipe.brake.a1.jobs import jobs_of
from tests.oracles.a1_scipy import simulate_scipy
from tests.oracles.a1_long_double import simulate_reference

# a row: in no id where it has its default, refused where it makes no sense, known everywhere
assert "friction_slope" not in Parameters().as_dict()
try:
    parse_study({"parameters": {"friction_slope": -1.0}})
except ValueError as error:
    assert "friction_slope" in str(error)
else:
    raise AssertionError
params = Parameters(
    mass=1.7, k1=0.8, k2=1.3, preload=2.0, belt_speed=-0.7, friction_law="rising",
    friction_slope=0.4, mu=0.2,
)
assert parse_study({"parameters": params.as_dict()}).parameters.friction_slope == 0.4
jobs = jobs_of(
    params, 1.0, 2.0, t_end=1.0, model="A1", tol=1e-12, initial_state=np.zeros(4), times=None,
)
assert jobs.values["friction_slope"] == 0.4

# what no equation reads cannot vary
refuse_unread(params, ["friction_slope"])
try:
    refuse_unread(Parameters(), ["friction_slope"])
except ValueError as error:
    assert "friction_law = 'coulomb' does not read it" in str(error)
else:
    raise AssertionError

# the law: symbols of the reference against floats with public solvers, stick and slip
for mu_static in (None, 0.35):
    case = params.with_(mu_static=mu_static, belt_speed=-0.1, friction_slope=0.2)
    exact = simulate_reference(case, 0.5, 1.9, t_end=12.0)
    public = simulate_scipy(case, 0.5, 1.9, t_end=12.0, tol=1e-12)
    assert {"belt_speed", "release"} <= {kind.name for kind in exact.event_kinds}
    assert public.event_kinds == exact.event_kinds
    np.testing.assert_allclose(public.state, np.float64(exact.state), rtol=1e-7, atol=1e-8)

# A3 against differences of the full field about the static state: the rise of friction damps
rising = params.with_(belt_speed=30.0, friction_slope=0.01)
field = A1Automaton(rising, 0.9, 2.4, linear_springs=True).field(0)

def jacobian(state):
    columns = [
        (np.array(field(0.0, state + 1e-5 * unit)) - np.array(field(0.0, state - 1e-5 * unit)))
        for unit in np.eye(4)
    ]
    return np.array(columns).T / 2e-5

rest = np.linalg.solve(jacobian(np.zeros(4)), -np.array(field(0.0, np.zeros(4))))
np.testing.assert_allclose(field(0.0, rest), 0.0, atol=1e-9)
grown, without = (
    float(stability_map(p, np.array([0.9]), np.array([2.4])).growth_rate[0, 0])
    for p in (rising, rising.with_(friction_slope=0.0))
)
assert np.isclose(grown, np.linalg.eigvals(jacobian(rest)).real.max(), rtol=1e-5, atol=1e-8)
assert grown != without
"""


ENGINE = """
# compiled anew in the copy, at random parameters, against long double
import numpy as np
from squealpipe import Parameters
from squealpipe.brake.a1.ensemble import run_ensemble
from tests.oracles.a1_long_double import simulate_reference
rng = np.random.default_rng(7)
for _ in range(12):
    values = {name: rng.uniform(0.5, 2.0) for name in ("mass", "k1", "k2", "k3", "preload")}
    mu = rng.uniform(0.1, 0.5)
    p = Parameters(
        **values, mu=mu, mu_static=mu + rng.choice([0.0, 0.2]), friction_law="rising",
        friction_slope=rng.uniform(0, 0.5), belt_speed=rng.choice([-1, 1]) * rng.uniform(0.2, 3),
        damping1=0.1,
    )
    angles = rng.uniform(0, np.pi, 2)
    end = 8.0 * p.time_unit
    run = run_ensemble(p, *angles, t_end=end)
    exact = simulate_reference(p, *angles, t_end=end)
    np.testing.assert_allclose(run.final_state, np.float64(exact.state), rtol=1e-8, atol=1e-9)
"""

PENDULUM = """
# between impacts the energy is kept, at each it loses 1 − e² of what it was
import numpy as np
from squealpipe.systems.shipped.pendulum import pendulum
run = pendulum.simulate(12.0)
energy = 0.5 * run.rate**2 + 9.81 * (1.0 - np.cos(run.angle))
impacts = np.searchsorted(run.event_time, run.time, side="right")
assert run.sizes["event"] > 4
np.testing.assert_allclose(energy, float(energy[0]) * 0.81**impacts, rtol=1e-10)
"""

TRIPLETS = """
import pathlib
import numpy as np
from squealpipe.structures.readers import read_matrix
pathlib.Path("mass.triplets").write_text("1 1 2.0\\n2 2 3.0\\n2 1 -0.5\\n")
read = read_matrix(pathlib.Path("mass.triplets"), "mass").matrix.toarray()
np.testing.assert_array_equal(read, [[2.0, 0.0], [-0.5, 3.0]])
"""

IMPACT_RATE = """
# each speed as in a run of its own
import numpy as np
from squealpipe import Parameters, simulate
from squealpipe.brake.dynamics.impact_rate import impact_rate
speeds = np.array([-3.0, 0.5, 8.0])
found = impact_rate(Parameters(), 2.6, 1.2, belt_speed=speeds, t_end=200.0)
for speed, rate in zip(speeds, found.impact_rate.values):
    run = simulate(Parameters(belt_speed=speed), 2.6, 1.2, t_end=200.0)
    assert rate == (run.event_kind == 1).sum() / 200.0
assert len(set(found.impact_rate.values)) == 3
"""

LADDER = """
import numpy as np
from squealpipe import Parameters
from squealpipe.study.figures import declared
from squealpipe.brake.ladder.ladder import model_ladder
ladder = model_ladder(Parameters(mu=0.5), 8, 0.05, t_end=100.0, workers=1)
assert "a1_quarter" in ladder.level.values and ladder.sizes["level"] == 7
wrong = ladder.error.sel(level="a1_quarter", question="contact_lost") > 0
assert wrong.any() and not wrong.all()
declared.draw("model_ladder", {"model_ladder": ladder}).savefig("model_ladder.png")
"""

PICTURE = f"""
from squealpipe import load
from squealpipe.study.figures import declared
published = {str(ROOT / "results/archive/reference/data")!r}
names = ("hammering_map", "simulate/F2a", "simulate/F2b")
datasets = {{name: load(published + "/" + name + ".nc") for name in names}}
declared.draw("impacts", datasets).savefig("impacts.png")
"""


@pytest.mark.parametrize(
    "script",
    [PARAMETER_AND_LAW, ENGINE, PENDULUM, TRIPLETS, IMPACT_RATE, LADDER, PICTURE],
)
def test_what_was_added_is_right(extended, script):
    python(extended[0], script)


BROKEN_ONCE = (
    "tests/brake/models/test_damped.py::test_eigenvalues_of_random_sets_to_twelve_digits",
    "tests/study/test_config.py::test_every_key_refuses_another_kind_and_says_which_key_takes_it",
    "tests/schema/test_third_parties.py::test_the_data_dictionary_is_current",
)
"""Tests that what was added has failed."""
GATES = (
    ("squealpipe.study.configuration.settings",),
    ("docs.build_dictionary",),
    ("ruff", "check", "."),
    ("ruff", "format", "--check", "."),
    ("pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *BROKEN_ONCE),
)


def test_the_gates_find_nothing_once_written_files_are_renewed(extended):
    folder, _ = extended
    for words in GATES:
        run = subprocess.run(
            [sys.executable, "-m", *words],
            cwd=folder,
            capture_output=True,
            env={**os.environ, "PYTHONPATH": str(folder)},
            text=True,
            check=False,
        )
        assert run.returncode == 0, run.stdout[-4000:] + run.stderr[-1000:]


def test_workflow_plans_the_new_figure_and_task_and_watches_the_new_law(
    extended, snakemake, tmp_path, monkeypatch
):
    folder, _ = extended
    monkeypatch.setenv(PLAN_VARIABLE, str(tmp_path / "plan.json"))
    figure, ladder = "results/figures/impacts.png", "results/data/model_ladder.nc"
    rates = "results/data/impact_rate.nc"
    run = snakemake(folder, "--dry-run", figure, ladder, rates)
    assert run.returncode == 0, run.stderr[-3000:]
    plan = json.loads((tmp_path / "plan.json").read_text())
    for name, paths in {
        figure: ("hammering_map.nc", "simulate/F2b.nc", "figures/dynamics/impacts.py"),
        ladder: ("friction_laws/rising.py",),
        rates: ("dynamics/impact_rate.py", "schema/impact_rate.py", "rate_impacts.py"),
    }.items():
        read = " ".join(plan[name]["inputs"] + plan[name]["sources"])
        for path in paths:
            assert path in read
    monkeypatch.delenv(PLAN_VARIABLE)
    run = snakemake(folder, rates)
    assert run.returncode == 0, run.stderr[-3000:]
    count = f"from squealpipe import load; print(load({rates!r}).belt_speed.size)"
    assert python(folder, count) == "13\n"
