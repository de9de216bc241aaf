"""Every public function tells what made its dataset; nothing of that enters the dataset's id."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import squealpipe
from squealpipe import Parameters, Sweep, load, run_sweep, save
from squealpipe.schema.origin import plain
from squealpipe.store.checkout import ROOT, commit
from squealpipe.store.netcdf import dataset_id
from tests.calls import CALLS

PARAMS = Parameters(mu=0.21, k1=1.3, belt_speed=-7.0)
MADE_BY = {
    ("A1", 1e-12): "simulate summarize validity_map refine_validity_map hammering_map basin_map",
    ("A1", 1e-9): "contact_boundary boundary_distance regime_chart smallest_disturbance "
    "infer_parameters",
    ("A1", "round-off"): "limit_cycle cycle_branch",
    ("A1, A3", 1e-9): "propensity",
    ("A2", "round-off"): "quasi_static_map",
    ("A3", "round-off"): "stability_map critical_friction_map",
    ("A4", "round-off"): "natural_frequencies periodic_orbit backbone",
}
MODEL_AND_TOLERANCE = {name: made for made, names in MADE_BY.items() for name in names.split()}


@pytest.mark.parametrize("name", MODEL_AND_TOLERANCE)
def test_attributes_tell_what_made_it_and_survive_the_file(name, tmp_path):
    made, (model, tolerance) = CALLS[name](PARAMS), MODEL_AND_TOLERANCE[name]
    back = load(save(made, tmp_path / "made.nc"))
    for dataset in (made, back):
        assert dataset.attrs["made_by"] == f"squealpipe.{name}"
        assert Parameters(**json.loads(dataset.attrs["parameters"])) == PARAMS
        assert dataset.attrs["model"] == model
        assert dataset.attrs["tolerance"] == tolerance
        assert dataset.attrs["method"]
        assert "numpy" in json.loads(dataset.attrs["libraries"])
    assert back.attrs["commit"] == commit()
    assert "squealpipe" in back.attrs["history"]
    told = ("made_by", "parameters", "model", "method", "tolerance", "arguments", "libraries")
    bare = made.drop_attrs(deep=False).assign_attrs(schema=made.attrs["schema"])
    assert not set(told) & set(bare.attrs)
    assert dataset_id(bare) == back.attrs["dataset_id"]


def test_every_public_function_that_returns_a_dataset_is_covered():
    other = {"SCENES", "Parameters", "Scene", "Sweep", "choose_model", "load", "save", "run_sweep"}
    other |= {"open_results", "labels", "System", "Switch", "convert", "plot"}
    assert set(squealpipe.__all__) - other == set(MODEL_AND_TOLERANCE)


def test_arguments_are_told_and_long_ones_by_their_ends():
    run = squealpipe.simulate(PARAMS, 0.4, 1.1, t_end=1.0, model="A1-no-stick", tol=1e-9).attrs
    assert json.loads(run["arguments"])["alpha2"] == 1.1
    assert (run["model"], run["tolerance"]) == ("A1-no-stick", 1e-9)
    assert plain(np.linspace(0, 1, 9)) == {"first": 0.0, "last": 1.0, "number": 9}
    assert json.dumps(plain(np.longdouble(1.5))) == "1.5"
    assert plain({"a": (1, 2.5, "x")}) == {"a": ["1", "2.5", "x"]}


def test_sweeps_tell_their_task_and_what_stays_fixed():
    fixed = {"alpha1": 0.9, "alpha2": 2.8, "mode": 1, "y_peak_max": 1.1, "mu": 0.4}
    plan = {"task": "backbone", "vary": {"k3": [0.5, 0.7]}, "fixed": fixed}
    attrs = run_sweep(Sweep(params=PARAMS, **plan)).attrs
    assert attrs["made_by"] == "squealpipe.backbone"
    assert json.loads(attrs["parameters"]) == PARAMS.with_(mu=0.4).as_dict()
    arguments = json.loads(attrs["arguments"])
    assert "k3" not in arguments, "a coordinate of the dataset tells its values"
    assert arguments["y_peak_max"] == 1.1
    assert (attrs["model"], attrs["method"]) == ("A4", "exact")


def git(place, *arguments):
    who = ["-c", "user.name=a", "-c", "user.email=a@b.c"]
    subprocess.run(["git", *who, *arguments], cwd=place, check=True, capture_output=True)


def test_commit_is_our_own_or_none(tmp_path):
    """Not that of a repository around the checkout, nor of one that we are installed into."""
    inside = tmp_path / "theirs/squealpipe-copy"
    (inside / "squealpipe").mkdir(parents=True)
    for name in ("Snakefile", "squealpipe/__init__.py"):
        shutil.copy(ROOT / name, inside / name)
    git(tmp_path / "theirs", "init")
    git(tmp_path / "theirs", "add", ".")
    git(tmp_path / "theirs", "commit", "-m", "theirs")
    assert commit(inside) == "unknown"
    git(inside, "init")
    commit.cache_clear()
    assert commit(inside) == "unknown", "nothing of ours is committed"
    commit.cache_clear()
    git(inside, "add", ".")
    git(inside, "commit", "-m", "ours")
    head = subprocess.run(
        ["git", "rev-parse", "HEAD"], cwd=inside, capture_output=True, text=True, check=True
    )
    assert head.stdout.startswith(commit(inside))
    assert commit(Path("/")) == "unknown"
