"""The section ``modifications`` of a study of a structure."""

import numpy as np
import pytest
import xarray as xr

from squealpipe.cli import run
from squealpipe.store.mistakes import ConfigError
from squealpipe.study.configuration.settings import PAPER, read_study
from squealpipe.study.report.answer_content import answer_content
from squealpipe.study.structure_study import answered, modifications, read_structure

FILES = {
    "one.yaml": """
paper: false
structure: {file: structure.yaml, samples: 1}
modifications:
  weight: {added_mass: {1: 300 g, 2: 0.15}}
  strut:
    spring:
      1,2: 3 kN/mm
""",
    "structure.yaml": """
mass: mass.mtx
stiffness: stiffness.mtx
contacts: contacts.csv
modal_damping: 0.01
mu: 0.5
belt_speed: 2.0
""",
    "mass.mtx": """\
%%MatrixMarket matrix coordinate real symmetric
2 2 2
1 1 0.4
2 2 0.4
""",
    "stiffness.mtx": """\
%%MatrixMarket matrix coordinate real symmetric
2 2 3
1 1 4.0e7
2 1 -1.2e7
2 2 1.4e7
""",
    "contacts.csv": "name,normal,tangential,stiffness,preload\npad,2:1,1:1,3e7,2000\n",
}


@pytest.fixture
def config(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path / "one.yaml"


def _growth(weight, strut):
    """Growth of small motions about steady sliding with both, by own matrices, 1/s."""
    mass = np.diag([0.4 + weight, 0.4 + 0.5 * weight])
    joined = strut * np.array([[1.0, -1.0], [-1.0, 1.0]])
    stiffness = np.array([[4.0e7, -1.2e7], [-1.2e7, 1.4e7]]) + joined
    at_rest = stiffness + np.diag([0.0, 3e7])
    root = np.diag(np.diag(mass) ** -0.5)
    squares, modes = np.linalg.eigh(root @ at_rest @ root)
    of_modes = mass @ root @ modes
    damping = of_modes @ np.diag(2.0 * 0.01 * np.sqrt(squares)) @ of_modes.T
    sliding = stiffness + 3e7 * np.array([[0.0, 0.5], [0.0, 1.0]])
    solved = np.linalg.solve(mass, np.hstack([sliding, damping]))
    return np.linalg.eigvals(
        np.block([[np.zeros((2, 2)), np.eye(2)], [-solved]])
    ).real.max()


@pytest.mark.release
def test_modifications_of_a_study_are_cures_up_to_own_eigenvalues(config):
    settings = read_study(PAPER, config).slice("structure", "modifications")
    structure = read_structure(settings["structure"])
    answer = answered(
        structure, settings["structure"], xr.Dataset(), settings["modifications"], 1
    )
    assert _growth(0.0, 0.0) > 0.0
    highest = answer.highest_tried
    assert float(highest.sel(cure="weight")) == pytest.approx(0.3)
    assert float(highest.sel(cure="strut")) == pytest.approx(3e6)
    growth = {"weight": lambda a: _growth(a, 0.0), "strut": lambda a: _growth(0.0, a)}
    for name, of in growth.items():
        amounts = np.linspace(0.0, float(highest.sel(cure=name)), 3001)
        quiet = np.array([of(amount) < 0.0 for amount in amounts])
        edges = np.flatnonzero(np.diff(quiet.astype(int)))
        low, high = (
            getattr(answer, f"quiet_{end}").sel(cure=name).dropna("interval").values
            for end in ("low", "high")
        )
        ends = [*amounts[edges], *amounts[-1:][quiet[-1:]]]
        assert ends
        assert sorted([*low, *high]) == pytest.approx(ends, abs=amounts[1])
    told = str(answer_content(answer))
    assert "weight" in told
    assert "strut" in told


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("added_mass", "addedmass", "weight: .*did you mean 'added_mass'"),
        (
            "{1: 300 g, ",
            "{3: 300 g, ",
            r"added_mass\[3\]: the structure has 2 degrees of freedom",
        ),
        ("300 g", "300 m", "kg"),
    ],
)
def test_a_modification_that_cannot_be_is_told(config, old, new, message):
    config.write_text(config.read_text().replace(old, new))
    settings = read_study(PAPER, config).slice("structure", "modifications")
    structure = read_structure(settings["structure"])
    with pytest.raises(ValueError, match=message):
        modifications(structure, settings["modifications"])


def test_modifications_need_a_structure(tmp_path):
    path = tmp_path / "none.yaml"
    path.write_text("modifications: {weight: {added_mass: {1: 0.1}}}\n")
    with pytest.raises(ConfigError, match="modifications: a study of a structure"):
        read_study(PAPER, path)


@pytest.mark.parametrize("example", ["--structure", "--disc"])
def test_examples_show_modifications_that_can_be_used(tmp_path, example):
    path = tmp_path / "mine.yaml"
    assert run(["init", str(path), example, "-q"]) == 0
    before, mark, after = path.read_text().partition("# modifications:")
    shown = (mark + after).replace("\n# ", "\n").removeprefix("# ")
    path.write_text(before + shown)
    settings = read_study(PAPER, path).slice("structure", "modifications")
    named = modifications(
        read_structure(settings["structure"]), settings["modifications"]
    )
    assert len(named) >= 2
