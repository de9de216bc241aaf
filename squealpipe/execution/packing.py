"""Runs of one task in few arrays: writing hundreds of small ones costs more than computing them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from squealpipe.store.chunks import Arrays

SHAPES = "shapes of "


def pack(runs: Sequence[Arrays]) -> Arrays:
    """Variables of all runs, stacked; of unequal length end to end, with a table of their shapes.

    Args:
        runs: variable → array, the same variables for every run.
    """
    packed: Arrays = {}
    for name in runs[0]:
        arrays = [run[name] for run in runs]
        if len({array.shape for array in arrays}) == 1:
            packed[name] = np.stack(arrays)
        else:
            packed[name] = np.concatenate([array.ravel() for array in arrays])
            packed[SHAPES + name] = np.array([array.shape for array in arrays])
    return packed


def unpack(packed: Arrays) -> list[Arrays]:
    """The runs again, as views."""
    names = [name for name in packed if not name.startswith(SHAPES)]
    columns = {name: _split(packed[name], packed.get(SHAPES + name)) for name in names}
    return [dict(zip(columns, run, strict=True)) for run in zip(*columns.values(), strict=True)]


def _split(array: np.ndarray, shapes: np.ndarray | None) -> list[np.ndarray]:
    if shapes is None:
        return list(map(np.asarray, array))
    ends = np.cumsum(np.prod(shapes, axis=1))
    pieces = np.split(array, ends[:-1])
    return [piece.reshape(shape) for piece, shape in zip(pieces, shapes, strict=True)]
