"""Every public function tells what made its dataset; nothing of that enters the dataset's id."""

import json
import subprocess
from pathlib import Path

import pytest

import squealpipe
from squealpipe import Parameters, Sweep, load, run_sweep, save
from squealpipe.store.checkout import commit
from squealpipe.store.identity import dataset_id
from tests.calls import CALLS

PARAMS = Parameters(mu=0.21, k1=1.3, belt_speed=-7.0)
MADE_BY = {
    (
        "A1",
        1e-12,
    ): "simulate summarize spectrum validity_map refine_validity_map hammering_map basin_map",
    (
        "A1",
        1e-9,
    ): "contact_boundary boundary_distance regime_chart smallest_disturbance "
    "infer_parameters assess",
    ("A1", "round-off"): "limit_cycle cycle_branch",
    ("A1, A3", 1e-9): "propensity",
    ("A2", "round-off"): "quasi_static_map",
    ("A3", "round-off"): "stability_map critical_friction_map",
    ("A4", "round-off"): "natural_frequencies periodic_orbit backbone",
}
MODEL_AND_TOLERANCE = {
    name: made for made, names in MADE_BY.items() for name in names.split()
}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.release] * (name == "assess"))  # 5 s
        for name in MODEL_AND_TOLERANCE
    ],
)
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
    told = (
        "made_by",
        "parameters",
        "model",
        "method",
        "tolerance",
        "arguments",
        "libraries",
    )
    bare = made.drop_attrs(deep=False).assign_attrs(schema=made.attrs["schema"])
    assert not set(told) & set(bare.attrs)
    assert dataset_id(bare) == back.attrs["dataset_id"]
    configured = {dataset_id(made.assign_attrs(config=text)) for text in ("{}", "[]")}
    assert len(configured | {dataset_id(bare)}) == 3


def test_every_public_function_that_returns_a_dataset_is_covered():
    other = {
        "SCENES",
        "Parameters",
        "Scene",
        "Sweep",
        "choose_model",
        "load",
        "save",
        "run_sweep",
    }
    # of a structure, not of Parameters: see tests/structures
    other |= {"Component", "Contact", "Face", "Rotation", "Structure"}
    other |= {"operating_map", "squealing_modes", "squeal_ladder"}
    other |= {"open_results", "labels", "System", "Switch", "convert", "plot"}
    other.add(
        "cycle_curve"
    )  # needs a special point: see the curves of tests/brake/cycles
    assert set(squealpipe.__all__) - other == set(MODEL_AND_TOLERANCE)


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
    done = subprocess.run(
        ["git", *who, *arguments], cwd=place, check=True, capture_output=True
    )
    commit.cache_clear()
    return done.stdout.decode()


def test_commit_is_our_own_or_none(tmp_path):
    """Not that of a repository around the checkout; another archive in a checkout is no change."""
    inside = tmp_path / "theirs/squealpipe-copy"
    for name in (
        "Snakefile",
        "squealpipe/__init__.py",
        "results/archive/a/manifest.json",
    ):
        (inside / name).parent.mkdir(parents=True, exist_ok=True)
        (inside / name).touch()
    for words in (["init"], ["add", "."], ["commit", "-m", "theirs"]):
        git(tmp_path / "theirs", *words)
    assert commit(inside) == "unknown"
    git(inside, "init")
    assert commit(inside) == "unknown", "nothing of ours is committed"
    git(inside, "add", ".")
    git(inside, "commit", "-m", "ours")
    (inside / "results/archive/a/manifest.json").unlink()
    assert git(inside, "rev-parse", "HEAD").startswith(commit(inside))
    (inside / "Snakefile").write_text("rule all:")
    commit.cache_clear()
    assert commit(inside).endswith("-dirty")
    assert commit(Path("/")) == "unknown"
    commit.cache_clear()
