"""The section ``operating`` of a study of a structure."""

import numpy as np
import pytest

from squealpipe import Structure, operating_map
from squealpipe.cli import run
from squealpipe.store.mistakes import ConfigError
from squealpipe.store.rerun.key import files_named_in
from squealpipe.study.configuration.settings import PAPER, read_study
from squealpipe.study.figures import declared
from squealpipe.study.report.structure import operating
from squealpipe.study.structure_study import operating_sweep
from squealpipe.study.sweep import run_sweep

SECTION = """
operating:
  pressure: [0.5, 2]
  speed: 7.2 km/h
  temperature: 20:300:2
  mu_of: {temperature: friction.csv}
  measured: noises.csv
  band_edges: 1 kHz,1.7 kHz,4 kHz
"""


@pytest.fixture
def config(tmp_path):
    path = tmp_path / "pads.yaml"
    assert run(["init", str(path), "--structure", "-q"]) == 0
    table = "temperature [°C];mu\n20;0,1\n300;0,5\n"
    (tmp_path / "friction.csv").write_text(table, encoding="utf-8")
    noises = "pressure;temperature [°C];frequency [Hz]\n0.5;20;\n2;300;900\n"
    (tmp_path / "noises.csv").write_text(noises, encoding="utf-8")
    path.write_text(path.read_text() + SECTION)
    return path


def test_the_section_makes_the_map_of_the_function_and_its_figure(config):
    settings = read_study(PAPER, config).slice("structure", "operating")
    named = {name.rpartition("/")[2] for name in files_named_in(settings)}
    assert {"structure.yaml", "friction.csv", "noises.csv"} <= named
    sweep = operating_sweep(settings["structure"], settings["operating"])
    points = run_sweep(sweep, workers=1)
    direct = operating_map(
        Structure.read(settings["structure"]["file"]),
        pressure=[0.5, 2.0],
        speed=[2.0],
        temperature=[20.0, 300.0],
        mu_of={"temperature": {20.0: 0.1, 300.0: 0.5}},
        measured=config.parent / "noises.csv",
        band_edges=[1000.0, 1700.0, 4000.0],
        workers=1,
    )
    assert points.equals(direct)
    assert np.isnan(points.frequency.values[:, :, 0]).all()
    assert (int(points.misses), int(points.quiet_agreed)) == (1, 1)
    assert points.schema == "operating_map over temperature"
    said = operating(points)
    assert any(line.startswith("Measured: 0 of 1 noises") for line in said)
    datasets = {"structure/operating": points}
    assert all(declared.texts("operating_points", datasets))
    assert len(declared.draw("operating_points", datasets).axes) == 4


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "friction.csv}",
            "frction.csv}",
            "operating.mu_of.temperature = 'frction.csv'",
        ),
        ("noises.csv", "noise.csv", "operating.measured = 'noise.csv'"),
        ("speed:", "sped:", "operating.sped: unknown key; did you mean 'speed'"),
    ],
)
def test_what_cannot_be_read_is_told_with_its_key(config, old, new, message):
    config.write_text(config.read_text().replace(SECTION, SECTION.replace(old, new)))
    with pytest.raises(ConfigError) as error:
        read_study(PAPER, config)
    assert message in str(error.value)


def test_operating_points_need_a_structure(tmp_path):
    path = tmp_path / "none.yaml"
    path.write_text("operating: {speed: 2}\n")
    with pytest.raises(ConfigError, match="operating: a study of a structure alone"):
        read_study(PAPER, path)
