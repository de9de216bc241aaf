"""A map joined from its parts equals the map made at once, bit for bit."""

import numpy as np
import pytest

from squealpipe.execution.scatter import join, scattered_rows
from squealpipe.tasks.dynamics.runs import validity_map
from squealpipe.tasks.linear.maps import stability_map
from tests.former import FORMER

ANGLES = np.linspace(0, np.pi, 21)


def test_maps_joined_from_rows_are_the_map_bit_for_bit():
    for task, options in ((stability_map, {}), (validity_map, {"t_end": 30.0})):
        rows = [scattered_rows(21, f"{i}-of-3") for i in (1, 2, 3)]
        parts = [task(FORMER, ANGLES[chosen], ANGLES, **options) for chosen in rows]
        assert join(parts).identical(task(FORMER, ANGLES, ANGLES, **options))


@pytest.mark.parametrize("count", [1, 2, 3, 7, 21])
def test_scattered_parts_cover_every_row_once(count):
    slices = [scattered_rows(21, f"{i}-of-{count}") for i in range(1, count + 1)]
    assert [row for part in slices for row in range(21)[part]] == list(range(21))
    sizes = [part.stop - part.start for part in slices]
    assert max(sizes) - min(sizes) <= 1


def test_foreign_parts_are_not_joined():
    a = stability_map(FORMER, ANGLES[:3], ANGLES)
    with pytest.raises(ValueError, match="not blocks of rows of one map"):
        join([a, stability_map(FORMER, ANGLES[3:], ANGLES[:4])])
    with pytest.raises(ValueError, match="no parts"):
        join([])
