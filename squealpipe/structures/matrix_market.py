"""Matrix Market files: scipy reads them, and their lines are checked first.

The reader of scipy skips what it does not know: a comma in a number, the exponent of ``1.5D+03``,
what stands behind an entry, and in integers all that follows the first sign that is no digit
(``3e2`` is 3). If a file says ``symmetric`` but holds both triangles, it adds them up. Here all of
these are refused, but for integers, which are read as floats (``3e2`` is 300). Plain files are
checked by a fast reader of tables; only others line by line.
"""

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd  # type: ignore[import-untyped]
import scipy.io
import scipy.sparse as sp

UNENDED = "its last line has no end; add one if the file is whole"


def read_matrix_market(path: Path) -> Any:
    """Return the matrix of a Matrix Market file, dense (``array``) or sparse (``coordinate``).

    Raises:
        ValueError: it is cut off, has lines that are no entries, states positions without values
            (``pattern``), or says that it is symmetric and holds both triangles.
    """
    banner, body = _parted(path.read_bytes())
    content = banner + body
    rows, columns, stated, form, field, symmetry = scipy.io.mminfo(io.BytesIO(content))
    if field == "pattern":
        raise ValueError("it says where entries are but not what they are (pattern)")
    if form == "array":
        stated = {
            "general": rows * columns,
            "skew-symmetric": rows * (rows - 1) // 2,
        }.get(symmetry, rows * (rows + 1) // 2)
    _check_entries(content, stated, form, field)
    matrix = scipy.io.mmread(io.BytesIO(content), spmatrix=False)
    if symmetry != "general" and sp.issparse(matrix):
        once = sp.csr_array(matrix)  # entries at one place are added up
        if once.nnz < matrix.nnz:
            raise ValueError(
                f"its first line says {symmetry}, but entries are there twice; if it holds both "
                "triangles, write `general` in place of that word"
            )
    return matrix


def _parted(content: bytes) -> tuple[bytes, bytes]:
    """Return the first line in words that scipy knows, with integers called real; and the rest."""
    first, end, body = content.lstrip().partition(b"\n")
    first = re.sub(rb"(?i)^%%matrixmarket", b"%%MatrixMarket", first)
    return re.sub(rb"(?i)\b(unsigned-)?integer\b", b"real", first) + end, body


def _check_entries(content: bytes, stated: int, form: str, field: str) -> None:
    """Check that there are as many entries as stated; scipy fills what is cut off with zeros.

    Raises:
        ValueError: a line is no entry, there are more or fewer than stated, or the last line has no
            end.
    """
    width = 2 * (form == "coordinate") + (2 if field == "complex" else 1)
    if _is_table(content, stated, width, places=form == "coordinate"):
        return
    # slower, but it says which line is wrong
    number_pattern = (
        r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[iI]nf(?:inity)?|[nN]a[nN])"
    )
    parts = [number_pattern] * (2 if field == "complex" else 1)
    if form == "coordinate":
        # an index of a row or column, from 1
        place_pattern = r"0*[1-9]\d*"
        parts = [place_pattern, place_pattern, *parts]
    entry = re.compile(r"\s*" + r"\s+".join(parts) + r"\s*")
    lines, last = -1, "\n"  # the first is that of sizes
    text = content.decode("utf-8", errors="replace")
    for number, last in enumerate(io.StringIO(text, newline=None), 1):
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


def _is_table(content: bytes, stated: int, width: int, *, places: bool) -> bool:
    """Tell whether the lines below the sizes are as many entries as stated, in plain numbers."""
    start = 0
    while content.startswith((b"%", b"\n", b"\r"), start):
        start = content.find(b"\n", start) + 1
        if not start:
            return False
    body = content[content.find(b"\n", start) + 1 :]
    if not body.endswith(b"\n") or body.translate(None, b"0123456789+-.eE \r\n"):
        return False
    kinds: dict[int, type] = dict.fromkeys(range(width), float)
    if places:
        kinds |= {0: int, 1: int}
    try:
        table = pd.read_csv(
            io.BytesIO(body), sep=r"\s+", header=None, dtype=kinds, engine="c"
        )
    except ValueError:
        return False
    if table.shape != (stated, width) or not np.isfinite(table.to_numpy(float)).all():
        return False
    return not places or bool((table[[0, 1]] >= 1).to_numpy().all())
