"""A map joined from blocks of rows equals the map made at once, bit for bit."""

import numpy as np
import pytest

from squealpipe.execution.row_blocks import join, map_in_blocks, row_blocks, scattered_rows
from squealpipe.store.chunks import Checkpoint
from squealpipe.tasks.dynamics.runs import validity_map
from squealpipe.tasks.linear.maps import stability_map
from tests.former import FORMER

ANGLES = np.linspace(0, np.pi, 21)


def identical(a, b):
    assert a.attrs == b.attrs
    assert set(a.variables) == set(b.variables)
    for name in a.variables:
        assert a[name].values.tobytes() == b[name].values.tobytes(), name


@pytest.mark.parametrize("block", [1, 50, 10_000])
def test_linear_map_in_blocks_is_the_map(block):
    params = FORMER.with_(mu=0.5)
    whole = stability_map(params, ANGLES, ANGLES)
    parts = map_in_blocks(
        lambda rows: stability_map(params, rows, ANGLES), ANGLES, 21, label="map", block=block
    )
    identical(parts, whole)


def test_validity_map_in_blocks_is_the_map(tmp_path):
    params = FORMER
    whole = validity_map(params, ANGLES, ANGLES, t_end=30.0)
    checkpoint = Checkpoint(directory=tmp_path)

    def make(rows):
        return validity_map(params, rows, ANGLES, t_end=30.0)

    def never(rows):
        raise AssertionError("all blocks are kept")

    for task in (make, never):
        made = map_in_blocks(task, ANGLES, 21, label="m", checkpoint=checkpoint, block=100)
        identical(made, whole)


@pytest.mark.parametrize("count", [1, 2, 3, 7, 21])
def test_scattered_parts_cover_every_row_once(count):
    slices = [scattered_rows(21, f"{i}-of-{count}") for i in range(1, count + 1)]
    assert [row for part in slices for row in range(21)[part]] == list(range(21))
    sizes = [part.stop - part.start for part in slices]
    assert max(sizes) - min(sizes) <= 1


@pytest.mark.parametrize("item", ["0-of-3", "4-of-3", "a-of-3", "3", "1-of-", ""])
def test_malformed_parts_are_refused(item):
    with pytest.raises(ValueError, match="i-of-n"):
        scattered_rows(21, item)


def test_more_parts_than_rows_are_refused():
    with pytest.raises(ValueError, match="at most 21 parts"):
        scattered_rows(21, "1-of-30")


def test_blocks_follow_from_the_grid():
    assert row_blocks(5, 10, block=25) == [slice(0, 2), slice(2, 4), slice(4, 5)]
    assert row_blocks(3, 10**6, block=25) == [slice(0, 1), slice(1, 2), slice(2, 3)]


def test_foreign_parts_are_not_joined():
    a = stability_map(FORMER, ANGLES[:3], ANGLES)
    with pytest.raises(ValueError, match="not blocks of rows of one map"):
        join([a, stability_map(FORMER, ANGLES[3:], ANGLES[:4])])
    with pytest.raises(ValueError, match="no parts"):
        join([])
