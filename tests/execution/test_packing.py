"""Packed runs come back as they were."""

from __future__ import annotations

import numpy as np

from squealpipe.execution.packing import pack, unpack


def test_runs_of_equal_and_unequal_shape_come_back():
    generator = np.random.default_rng(3)
    runs = [
        {
            "single": np.asarray(generator.normal()),
            "same": generator.normal(size=(2, 3)),
            "ragged": generator.normal(size=(count, 2)),
            "flag": np.arange(count, dtype=np.int8),
        }
        for count in (3, 0, 1, 5)
    ]
    packed = pack(runs)
    assert len(packed) < 7
    for back, run in zip(unpack(packed), runs, strict=True):
        for name, array in run.items():
            np.testing.assert_array_equal(back[name], array)
            assert back[name].dtype == array.dtype
