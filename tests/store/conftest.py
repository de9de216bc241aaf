"""A small run to freeze, verify and compare."""

import shutil

import numpy as np
import pytest
import yaml

from squealpipe.brake.linear.maps import stability_map
from squealpipe.parameters import Parameters
from squealpipe.store import produce
from squealpipe.store.rerun.key import file_key, state_key
from squealpipe.study.configuration.settings import Study

KEY = "0123456789abcdef"


def keys_of(root, results="results"):
    """File → the key that it must state, as the workflow would give it."""
    names = ("data/stability_map.nc", "figures/fig06.png")
    return {f"{results}/{name}": file_key(KEY, name) for name in names}


def write_run(root, *, points=13, mu=0.3, results="results"):
    """A checkout with a configuration and one dataset and figure made with it."""
    config = root / "workflow/config/paper.yaml"
    config.parent.mkdir(parents=True, exist_ok=True)
    given = {"results": results, "parameters": {"mu": mu}, "linear": {"points": points}}
    config.write_text(yaml.safe_dump(given))
    part = Study.model_validate(given).slice("parameters", "linear.points")
    angles = np.linspace(0, np.pi, points)
    produce(
        lambda: stability_map(Parameters(mu=mu), angles, angles),
        config=part,
        output=root / results / "data/stability_map.nc",
        key=KEY,
    )
    figure = root / results / "figures/fig06.png"
    figure.parent.mkdir(parents=True, exist_ok=True)
    figure.write_bytes(b"a picture")
    state_key(figure, KEY)
    return root


@pytest.fixture(name="write_run", scope="session")
def _write_run():
    return write_run


@pytest.fixture(name="keys_of", scope="session")
def _keys_of():
    return keys_of


@pytest.fixture(scope="module")
def finished_run(tmp_path_factory):
    """A run that no test changes: computed and archived once, copied for each."""
    return write_run(tmp_path_factory.mktemp("run") / "checkout")


@pytest.fixture
def run(finished_run, tmp_path):
    return shutil.copytree(finished_run, tmp_path / "checkout")
