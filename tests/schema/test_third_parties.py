"""What another person needs from a file alone: title, references, licence, words, CF."""

import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from squealpipe import Parameters, load, natural_frequencies, save, simulate
from squealpipe.schema import Outcome, SchemaError, meanings

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """The scene of Fig. 2d, as a file."""
    run = simulate(Parameters(), 0.83 * np.pi, 0.83 * np.pi, t_end=20.0)
    return save(run, tmp_path_factory.mktemp("cf") / "F2d.nc")


@pytest.mark.release
def test_the_cf_checker_wants_a_date_alone(scene):
    """Time counts from the start of a run, in s; with a date xarray would make dates of it."""
    checker = Path(sys.executable).with_name("compliance-checker")
    command = [checker, "--test=cf:1.11", scene]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    lines = map(str.strip, done.stdout.splitlines())
    assert {line for line in lines if line.startswith(("*", "§"))} == {
        "§5.1 Independent Latitude, Longitude, Vertical, and Time Axes",
        "* Coordinate variable 'time' should have standard_name='time', found: 'None'",
    }


def test_a_run_says_what_it_is(scene):
    run = load(scene)
    assert "model A1 at alpha1 = 0.83 pi, alpha2 = 0.83 pi" in run.attrs["title"]
    assert run.attrs["license"] == "MIT"
    assert "Noise Control Engineering Journal, 2021" in run.attrs["references"]
    assert "-L2 cos alpha2" in run.attrs["comment"]
    assert (
        "3: step limit (too many steps: shorten t_end" in run.outcome.attrs["comment"]
    )


def test_only_outcomes_that_can_be_are_listed(scene):
    run = set(meanings(load(scene).outcome).values())
    assert {"converged", "step_limit", "singular_geometry"} <= run
    assert not run & {"complex_pair", "pole", "infeasible", "tongue_end"}
    linear = natural_frequencies(Parameters(), [1.0], [2.0])
    assert set(meanings(linear.outcome).values()) == {
        "converged",
        "singular_static_state",
        "complex_pair",
        "divergence",
        "rigid_mode",
    }


def test_an_outcome_that_cannot_be_is_refused(scene):
    from squealpipe.schema import find, validate

    wrong = load(scene)
    wrong["outcome"] = wrong.outcome.copy(data=np.int8(Outcome.pole))
    with pytest.raises(SchemaError, match="outcome holds flags"):
        validate(wrong, find("simulation"))


def test_the_data_dictionary_is_current():
    module = runpy.run_path(str(ROOT / "docs/build_dictionary.py"))
    assert module["TARGET"].read_text("utf-8") == module["page"](), (
        "run `make dictionary`"
    )
