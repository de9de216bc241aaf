"""Gaps between faces of a mesh are told, and doubted where they are more than facets explain."""

import warnings

import numpy as np
import pytest

from squealpipe import Structure, load
from squealpipe.cli import run
from squealpipe.structures.meshes.gaps import gaps_of
from tests.structures.meshes.test_broken_inputs import DECK, pad_moved, write_brake

FACET = 2 * 0.09 * np.sin(np.pi / 8)  # m, longest edge at node 5001, of eight sectors


def read(folder, gap):
    """Read the brake whose pad was moved off the disc, and the warnings."""
    write_brake(folder)
    pad_moved(folder, (0.0, 0.0, gap))
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        structure = Structure.read(folder / "brake.yaml")
    return structure, [str(each.message) for each in told]


@pytest.mark.parametrize(
    ("gap", "words"),
    [
        (6e-3, "lining: gap 6 mm at most (node 5001), 6 mm in the mean, 8.7 % of its"),
        (-6e-3, "lining: bodies overlap by 6 mm at most (node 5001), 6 mm in the mean"),
    ],
)
def test_a_gap_that_no_facet_explains_is_doubted(tmp_path, gap, words):
    """A pad 3 mm above a disc of 10 mm facets was computed without a word."""
    structure, told = read(tmp_path, gap)
    assert len(told) == 1
    assert words in told[0]
    assert "move the bodies of the mesh together" in told[0]
    (face,) = gaps_of(structure.contacts)
    assert (face.largest, face.mean) == pytest.approx((gap, abs(gap)), rel=1e-9)
    assert face.facet == pytest.approx(FACET, rel=1e-9)


def test_small_gaps_are_told_by_modes_and_kept_in_files(tmp_path, monkeypatch, capsys):
    structure, told = read(tmp_path, 3e-3)
    assert not told
    monkeypatch.chdir(tmp_path)
    assert run(["modes", "brake.yaml", "--no-critical", "-o", "modes.nc"]) == 0
    said = capsys.readouterr().out
    assert "lining: gap 3 mm at most (node 5001), 3 mm in the mean" in said
    assert load("modes.nc").contact_gap.values == pytest.approx(np.full(9, 3e-3))
    structure.write_contacts("contacts.csv")
    text = (tmp_path / "brake.yaml").read_text()
    head = text[: text.index("contacts:")]
    rotation = text[text.index("rotation:") :]
    (tmp_path / "again.yaml").write_text(f"{head}contacts: contacts.csv\n{rotation}")
    again = Structure.read("again.yaml")
    assert list(gaps_of(again.contacts)) == list(gaps_of(structure.contacts))
    (tmp_path / "brake.inp").write_text(DECK)
    assert run(["modes", "brake.yaml", "--no-critical", "-o", "t.nc"]) == 0
    assert "lining: the faces touch" in capsys.readouterr().out
