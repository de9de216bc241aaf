"""Matrix Market files: scipy reads them, and their lines are checked first.

The reader of scipy skips what it does not know: a comma in a number, the exponent of ``1.5D+03``,
what stands behind an entry; and of a file that says ``symmetric`` but holds both triangles it adds
up both.
"""

import re
from pathlib import Path
from typing import Any

import scipy.io
import scipy.sparse as sp

BANNER = (
    "the first line of a Matrix Market file is like "
    "%%MatrixMarket matrix coordinate real general"
)
UNENDED = "its last line has no end; add one if the file is whole"
PLACE = r"0*[1-9]\d*"
NUMBER = r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[iI]nf(?:inity)?|[nN]a[nN])"


def read_matrix_market(path: Path) -> Any:
    """A matrix from a Matrix Market file.

    Raises:
        ValueError: it is cut off, or has lines that are no entries.
    """
    rows, columns, stated, form, field, symmetry = scipy.io.mminfo(path)
    if field == "pattern":
        raise ValueError("it says where entries are but not what they are (pattern)")
    if form == "array":
        stated = {
            "general": rows * columns,
            "skew-symmetric": rows * (rows - 1) // 2,
        }.get(symmetry, rows * (rows + 1) // 2)
    _check_entries(path, stated, form, field)
    matrix = scipy.io.mmread(path)
    if symmetry != "general" and sp.issparse(matrix):
        once = sp.csr_array(matrix)  # entries at one place are added up
        if once.nnz < matrix.nnz:
            raise ValueError(
                f"its first line says {symmetry}, but entries are there twice; if it holds both "
                "triangles, write `general` in place of that word"
            )
    return matrix


def _check_entries(path: Path, stated: int, form: str, field: str) -> None:
    """Count the entries: an array that is cut off is filled with zeros when read."""
    parts = [NUMBER] * (2 if field == "complex" else 1)
    if form == "coordinate":
        parts = [PLACE, PLACE, *parts]
    entry = re.compile(r"\s*" + r"\s+".join(parts) + r"\s*")
    lines, last = -1, "\n"  # the first is that of sizes
    with path.open(encoding="utf-8", errors="replace") as file:
        for number, last in enumerate(file, 1):
            if not last.strip() or last.startswith("%"):
                continue
            if lines >= 0 and not entry.fullmatch(last):
                raise ValueError(
                    f"line {number} is no entry: {last.strip()[:60]!r}; rows and columns count "
                    "from 1, and numbers are like -1.5e+03, with a decimal point and an e"
                )
            lines += 1
    if lines != stated:
        raise ValueError(f"{lines} entries, but its size says {stated}")
    if not last.endswith("\n"):
        raise ValueError(UNENDED)
