"""Matrices in the Harwell–Boeing format, as Ansys writes them by HBMAT, read by scipy.

scipy 1.17 refuses symmetric matrices, which hold their lower triangle; here it reads them as what
they hold, and the other triangle is mirrored afterwards. Ansys's mapping says node and direction of
each row. No file of Ansys was to be had: the tests write them by the format's documentation.
"""

import re
import tempfile
from pathlib import Path
from typing import Any

import scipy.io
import scipy.sparse as sp


def read_harwell_boeing(path: Path) -> tuple[Any, bool]:
    """Return a matrix, and whether it is one triangle of a symmetric one.

    Raises:
        ValueError: a complex matrix or one of elements, which a structure cannot have.
    """
    lines = path.read_text(encoding="latin-1").splitlines(keepends=True)
    if len(lines) < 3:
        raise ValueError("it has no header; write it as text (HBMAT,,,,ASCII)")
    kind = lines[2][:3].upper()
    if kind not in ("RSA", "RUA"):
        raise ValueError(
            f"its type is {kind!r}; a real and assembled one is needed (RSA, RUA)"
        )
    lines[2] = "RUA" + lines[2][3:]
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "matrix.hb"
        plain.write_text("".join(lines), encoding="latin-1")
        matrix = scipy.io.hb_read(plain, spmatrix=False)
    return sp.coo_array(matrix), kind == "RSA"


def read_mapping(path: Path) -> list[str]:
    """Return the names ``node.direction`` of the rows, from Ansys's mapping file.

    Raises:
        ValueError: a row without a node and a direction.
    """
    names: dict[int, str] = {}
    # Ansys's names of directions
    directions = {"UX": 1, "UY": 2, "UZ": 3, "ROTX": 4, "ROTY": 5, "ROTZ": 6}
    for line in path.read_text(encoding="latin-1").splitlines():
        match = re.fullmatch(r"\s*(\d+)\s+(\d+)\s+(\w+)\s*", line)
        if match is None:  # a heading
            continue
        direction = directions.get(match[3].upper())
        if direction is None:
            raise ValueError(
                f"{path}: row {match[1]} is {match[3]} of node {match[2]}; "
                f"{', '.join(directions)} are known"
            )
        names[int(match[1])] = f"{match[2]}.{direction}"
    if sorted(names) != list(range(1, len(names) + 1)):
        raise ValueError(
            f"{path}: rows 1 to {max(names, default=0)} are needed, each with its node and "
            f"direction; {len(names)} are there"
        )
    return [names[row] for row in range(1, len(names) + 1)]
