"""Matrices of Nastran: OUTPUT4 files (.op4) and DMIG cards in punch files (.pch), read by pyyeti.

OUTPUT4 has no names of rows; DMIG has those of nodes and directions, with direction 0 of scalar
points. What pyyeti 1.4.7 does with them was looked at in the files of MSC and NX Nastran that it
comes with: symmetric DMIG are completed, symmetric OUTPUT4 are written whole.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp


def read_op4(path: Path, choose: Callable[[list[str]], str]) -> Any:
    """Return one matrix of an OUTPUT4 file, sparse.

    Args:
        choose: returns the name of the matrix that is meant, of those in the file.

    Raises:
        ValueError: it is not square.
    """
    # importing pyyeti sets legacy print options of NumPy, which cut the numbers of CSV files
    with np.printoptions():
        from pyyeti.nastran import op4  # type: ignore[import-untyped]

    content = op4.load(str(path), sparse=True)
    if not content:
        raise ValueError("no matrix is in it")
    # Nastran writes matrices that it lacks as 1 × 1
    present = [name for name, each in content.items() if each[0].shape != (1, 1)]
    matrix, form, _ = content[choose(present or list(content))]
    # numbers of the two forms of matrices in OUTPUT4 that a structure can have
    symmetric = 6
    square = 1
    if form not in (symmetric, square):
        raise ValueError(f"the matrix has form {form}; a square one (1 or 6) is needed")
    return sp.coo_array(matrix)


def read_dmig(path: Path, choose: Callable[[list[str]], str]) -> tuple[Any, list[str]]:
    """Return one matrix of DMIG cards, sparse, and the names of its rows.

    Args:
        choose: returns the name of the matrix that is meant, of those in the file.
    """
    with np.printoptions():  # as above
        from pyyeti.nastran import bulk

    with path.open("rb") as file:
        if b"DMIG" not in file.read():
            raise ValueError("it has no DMIG cards; ask for them by EXTSEOUT(DMIGPCH)")
    content = bulk.rddmig(str(path), square=True)
    table = content[choose(list(content))]
    if not table.columns.equals(table.index):
        raise ValueError(
            "the matrix is rectangular; a square one (form 1 or 6) is needed"
        )
    names = [f"{node}.{direction}" for node, direction in table.index]
    return sp.coo_array(np.asarray(table)), names
