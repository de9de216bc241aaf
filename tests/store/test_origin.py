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

PARAMS = Parameters(mu=0.21, k1=1.3, belt_speed=-7.0)
ANGLES = np.linspace(0.3, 2.0, 3)
RUN = squealpipe.simulate(PARAMS, 0.4, 1.1, t_end=1.0, model="A1-no-stick", tol=1e-9)
MAP = (PARAMS, ANGLES, ANGLES)
BOUNDARY = squealpipe.contact_boundary(
    PARAMS, [0.8, 0.9, 1.0], [2.7, 2.8, 2.9], t_end=5.0, tol=1e-9
)
MODEL_AND_TOLERANCE = {
    "simulate": (RUN, "A1-no-stick", 1e-9),
    "validity_map": (squealpipe.validity_map(*MAP, t_end=1), "A1", 1e-12),
    "hammering_map": (squealpipe.hammering_map(*MAP, t_end=1), "A1", 1e-12),
    "refine_validity_map": (
        squealpipe.refine_validity_map(PARAMS, resolution=5, coarse=3, t_end=1),
        "A1",
        1e-12,
    ),
    "quasi_static_map": (squealpipe.quasi_static_map(*MAP), "A2", "round-off"),
    "stability_map": (squealpipe.stability_map(*MAP), "A3", "round-off"),
    "natural_frequencies": (squealpipe.natural_frequencies(*MAP), "A4", "round-off"),
    "periodic_orbit": (
        squealpipe.periodic_orbit(PARAMS, 0.9, 2.8, mode=1, y_peak=1.5),
        "A4",
        "round-off",
    ),
    "backbone": (squealpipe.backbone(PARAMS, 0.9, 2.8, mode=1, y_peak_max=1.2), "A4", "round-off"),
    "critical_friction_map": (squealpipe.critical_friction_map(*MAP), "A3", "round-off"),
    "smallest_disturbance": (
        squealpipe.smallest_disturbance(PARAMS, 0.9, 2.8, t_end=5.0, directions=8),
        "A1",
        1e-9,
    ),
    "propensity": (
        squealpipe.propensity(
            PARAMS,
            0.9,
            2.8,
            samples=64,
            t_end=1.0,
            distributions={"mu": {"distribution": "uniform", "low": 0.1, "high": 0.2}},
        ),
        "A1, A3",
        1e-9,
    ),
    "basin_map": (squealpipe.basin_map(PARAMS, 0.9, 2.8, t_end=5.0), "A1", 1e-12),
    "contact_boundary": (BOUNDARY, "A1", 1e-9),
    "regime_chart": (
        squealpipe.regime_chart(PARAMS, [0.8, 0.9, 1.0], [2.7, 2.8, 2.9], t_end=5.0, tol=1e-9),
        "A1",
        1e-9,
    ),
    "boundary_distance": (
        squealpipe.boundary_distance(BOUNDARY, {"alpha1": 0.9, "alpha2": 2.8}),
        "A1",
        1e-9,
    ),
    "limit_cycle": (squealpipe.limit_cycle(PARAMS, 0.9, 2.8, t_settle=20.0), "A1", "round-off"),
    "cycle_branch": (
        squealpipe.cycle_branch(
            PARAMS, 0.9, 2.8, parameter="mu", to=PARAMS.mu + 0.1, start="onset", n_points=2
        ),
        "A1",
        "round-off",
    ),
    "summarize": (squealpipe.summarize(RUN), "A1-no-stick", 1e-9),
    "infer_parameters": (squealpipe.infer_parameters(PARAMS, samples=2, workers=1), "A1", 1e-9),
}


@pytest.mark.parametrize("name", MODEL_AND_TOLERANCE)
def test_attributes_tell_what_made_it_and_survive_the_file(name, tmp_path):
    made, model, tolerance = MODEL_AND_TOLERANCE[name]
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
    assert json.loads(RUN.attrs["arguments"])["alpha2"] == 1.1
    assert json.loads(MODEL_AND_TOLERANCE["backbone"][0].attrs["arguments"])["y_peak_max"] == 1.2
    assert plain(np.linspace(0, 1, 9)) == {"first": 0.0, "last": 1.0, "number": 9}
    assert json.dumps(plain(np.longdouble(1.5))) == "1.5"
    assert plain({"a": (1, 2.5, "x")}) == {"a": ["1", "2.5", "x"]}


def test_sweeps_tell_their_task_and_what_stays_fixed():
    sweep = Sweep(
        task="backbone",
        params=PARAMS,
        vary={"k3": [0.5, 0.7]},
        fixed={"alpha1": 0.9, "alpha2": 2.8, "mode": 1, "y_peak_max": 1.1, "mu": 0.4},
    )
    attrs = run_sweep(sweep).attrs
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
