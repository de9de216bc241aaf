"""The disc brake that ships, against what CalculiX assembled and an own assembly in scipy."""

import gzip
from pathlib import Path

import numpy as np
import pytest

from squealpipe.cli import run
from squealpipe.structures import Structure, disc_brake
from squealpipe.structures.files import read_matrices
from squealpipe.structures.shipped_disc import brake_mesh, deck
from squealpipe.structures.units import scales_of
from squealpipe.study.structure_study import read_structure

CALCULIX = Path(__file__).parent / "meshes/calculix_brake"


@pytest.fixture(scope="module")
def brake():
    return disc_brake()


def test_matrices_are_those_of_calculix(brake):
    parts, names = read_matrices(
        {"mass": "brake.mas.gz", "stiffness": "brake.sti.gz"},
        CALCULIX,
        scales_of("mm-t-s"),
    )
    places = [names.index(name) for name in brake.names]
    for name, ours in (("mass", brake.mass), ("stiffness", brake.stiffness)):
        theirs = parts[name][places][:, places]
        size = np.sqrt(theirs.diagonal())
        off = (ours - theirs).tocoo()
        assert (np.abs(off.data) / (size[off.row] * size[off.col])).max() < 1e-12


def test_the_deck_is_that_of_the_files():
    """But for how numbers are written, and for the set of nodes on which a shim lies."""
    before, _, after = deck(brake_mesh()).partition("*NSET, NSET=BACK\n")
    ours = before.splitlines() + ("*" + after.partition("*")[2]).splitlines()
    packed = (CALCULIX / "brake.inp.gz").read_bytes()
    theirs = gzip.decompress(packed).decode().splitlines()
    assert len(ours) == len(theirs)
    for one, other in zip(ours, theirs, strict=True):
        assert one == other or [*map(float, one.split(","))] == [
            *map(float, other.split(","))
        ]


@pytest.mark.release
def test_modes_at_rest_and_with_friction():
    """CalculiX has 3e-7 of the lowest frequencies, without contact."""
    for mu, growth, frequency in (
        (0.4, 24.940579, 2851.938816),
        (0.6, 98.243300, 2853.365890),
    ):
        modes = disc_brake(mu=mu).complex_modes(frequency_max=3000, critical=False)
        assert modes.growth_rate[modes.unstable].values == pytest.approx(
            [growth], rel=1e-6
        )
        assert modes.frequency[modes.unstable].values == pytest.approx(
            [frequency], rel=1e-9
        )
    still = disc_brake(mu=0.0).complex_modes(n_modes=4, critical=False)
    lowest = [1918.1344, 2242.7044, 2259.5127, 2302.5501]
    assert still.frequency.values == pytest.approx(lowest, abs=6e-5)
    assert not still.unstable.any()


def test_numbers_of_the_brake_are_arguments():
    one = disc_brake(pressure="1 MPa", stiffness="5e6 N/mm", mu="30 %", speed="60 rpm")
    assert one.belt_speed == pytest.approx(2 * np.pi)
    assert one.stiffnesses.sum() == pytest.approx(5e9)
    assert one.preloads.sum() == pytest.approx(3047.5255, abs=5e-5)
    assert set(one.mu_of_contacts) == {0.3}
    with pytest.raises(ValueError, match="pressure"):
        disc_brake(pressure=0.0)


def test_files_of_a_study_are_the_brake(tmp_path):
    assert run(["init", str(tmp_path / "mine.yaml"), "--disc"]) == 0
    assert run(["init", str(tmp_path / "other.yaml"), "--disc", "--own"]) == 2
    assert (
        read_structure(
            {"file": tmp_path / "mine/structure.yaml", "frequency_max": 4e3}
        ).mu
        == 0.6
    )
    read = Structure.read(tmp_path / "mine/structure.yaml")
    given = disc_brake(mu=0.6, modal_damping=0.001)
    assert read.names == given.names
    assert abs(read.mass - given.mass).max() < 1e-12 * given.mass.max()
    assert abs(read.stiffness - given.stiffness).max() < 1e-12 * given.stiffness.max()
    assert np.allclose(read.normals, given.normals)
    assert np.allclose(read.tangentials, given.tangentials)
    assert np.allclose(read.preloads, given.preloads)
