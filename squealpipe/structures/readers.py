"""Matrices from files that other programs write, with the names of their degrees of freedom.

Matrix Market, ``.npz`` of scipy.sparse or of arrays, ``.npy``, MATLAB ``.mat`` (5 and 7.3), Abaqus
``*MATRIX OUTPUT`` and ``*SUBSTRUCTURE MATRIX OUTPUT``, CalculiX ``.sti``, ``.mas`` and ``.dof``,
Nastran ``.op4`` and DMIG (``.pch``), Harwell–Boeing with Ansys's mapping; each also packed by gzip.
"""

import io
import re
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import scipy.io
import scipy.sparse as sp

from squealpipe.structures.harwell_boeing import read_harwell_boeing, read_mapping
from squealpipe.structures.matrix_market import UNENDED, read_matrix_market
from squealpipe.structures.nastran_matrices import read_dmig, read_op4
from squealpipe.structures.packed import plain_name, text_of, unpacked


class ChoiceError(ValueError):
    """A file holds several matrices, or not the one that is named."""


class Labelled(NamedTuple):
    """A matrix with the labels ``node.direction`` of its rows, None where the file has none.

    Attributes:
        halved: the format has one triangle of symmetric matrices.
        by_node: its rows are in the order of nodes, as the file has none.
    """

    matrix: Any
    labels: list[str] | None = None
    halved: bool = False
    by_node: bool = False


def read_matrix(path: Path, key: str, variable: str | None = None) -> Labelled:
    """A matrix from a file; its ending says which program wrote it.

    Args:
        key: ``mass``, ``stiffness`` or ``damping``, for files that hold several.
        variable: name in a MATLAB or ``.npz`` file that holds several.

    Raises:
        FileNotFoundError: no such file.
        ValueError: it is cut off, or not of its form; names the file.
    """
    if not path.is_file():
        raise FileNotFoundError(f"{key}: no file {path}")
    with unpacked_matrix(path, key) as plain:
        return _read(plain, path, key, variable)


@contextmanager
def unpacked_matrix(path: Path, key: str) -> Iterator[Path]:
    """Yield the path of the plain file, as :func:`unpacked` does."""
    try:
        with unpacked(path) as plain:
            yield plain
    except ValueError as error:
        text = str(error)
        raise ValueError(
            text if text.startswith(f"{key}: ") else f"{key}: {text}"
        ) from error


def _read(plain: Path, path: Path, key: str, variable: str | None) -> Labelled:
    """Return a matrix from a plain file.

    Args:
        path: the file as it was named; others stand beside it.
    """
    # Ansys writes its matrices as .matrix
    harwell_boeing = (".hb", ".rsa", ".rua", ".matrix")
    readers: dict[str, Callable[[], Labelled]] = {
        ".mtx": lambda: _mtx(plain, key),
        ".npz": lambda: Labelled(_npz(plain, key, variable)),
        ".npy": lambda: Labelled(np.load(plain, allow_pickle=False)),
        ".mat": lambda: Labelled(_matlab(plain, key, variable)),
        ".sti": lambda: _calculix(plain, path),
        ".mas": lambda: _calculix(plain, path),
        ".op4": lambda: Labelled(
            read_op4(plain, lambda names: _chosen(names, key, variable))
        ),
        ".pch": lambda: Labelled(
            *read_dmig(plain, lambda names: _chosen(names, key, variable))
        ),
        **dict.fromkeys(harwell_boeing, lambda: _harwell_boeing(plain, path)),
    }
    with plain.open("rb") as file:
        start = file.read(3)
    # first bytes of files that no reader of matrices takes, and what to do
    first_bytes = {
        b"\xef\xbb\xbf": "begins with a byte order mark; save it as UTF-8 without one",
        b"\xff\xfe": "is UTF-16; save it as UTF-8 without byte order mark",
    }
    for mark, remedy in first_bytes.items():
        if start.startswith(mark):
            raise ValueError(f"{key}: {path} {remedy}")
    ending = plain_name(path).suffix.lower()
    if ending not in readers:
        raise ValueError(
            f"{key}: {path} ends in {ending!r}; matrices are read from {', '.join(readers)}, also "
            "where gzip has packed them (.gz)"
        )
    # libraries raise these on files that are cut off or of another form
    errors_of_readers = (
        OSError,
        ValueError,
        KeyError,
        TypeError,
        IndexError,
        EOFError,
        NotImplementedError,
        AssertionError,
        RuntimeError,
        zipfile.BadZipFile,
        zlib.error,
    )
    try:
        return _without_gaps(readers[ending](), key)
    except ImportError as error:
        extra = "install squealpipe[fe] to read it"
        raise ValueError(f"{key}: {path} needs {error.name}; {extra}") from error
    except ChoiceError as error:
        raise ValueError(f"{key}: {path}: {error}") from error
    except errors_of_readers as error:
        raise ValueError(
            f"{key}: {path} is cut off, or not what its ending says: {error}"
        ) from error


def _mtx(path: Path, key: str) -> Labelled:
    """Matrix Market or Abaqus; both end in ``.mtx``."""
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = (line for line in file if line.strip() and not line.startswith("**"))
        first = next(lines, "").lstrip()
    if first.lower().startswith("%%matrixmarket"):
        return Labelled(read_matrix_market(path))
    if first.startswith("%"):
        hint = (
            "the first line of a Matrix Market file is like "
            "%%MatrixMarket matrix coordinate real general"
        )
        raise ValueError(hint)
    if first.startswith("*"):
        return _substructure(path, key)
    return _abaqus(path)


def _without_gaps(one: Labelled, key: str) -> Labelled:
    """A matrix that a program wrote whole: each entry once, with a diagonal but of damping.

    Raises:
        ValueError: an entry is there twice, or the diagonal has a gap.
    """
    if not one.halved:
        return one
    entries = sp.coo_array(one.matrix)
    size = entries.shape[0]
    places = entries.row.astype(np.int64) * size + entries.col
    unique, counts = np.unique(places, return_counts=True)

    def name(place: int) -> str:
        return one.labels[place] if one.labels else str(place + 1)

    if (counts > 1).any():
        row, column = divmod(int(unique[counts > 1][0]), size)
        raise ValueError(
            f"the entry of {name(row)} and {name(column)} is there twice; leave the sum of both"
        )
    bare = np.setdiff1d(np.arange(size), entries.row[entries.row == entries.col])
    if bare.size and key != "damping":
        raise ValueError(
            f"{name(int(bare[0]))} has no entry on the diagonal; if the file is whole, add one of 0"
        )
    return one


def _abaqus(path: Path) -> Labelled:
    """Formats MATRIX INPUT and LABELS (node, direction, twice, value) and COORDINATE of Abaqus."""
    rows = _numbers(path)
    if rows.shape[1] == 3:
        return Labelled(_of_triplets(rows), None, True)
    if rows.shape[1] != 5:
        raise ValueError(f"{rows.shape[1]} numbers a line; 3 or 5 are expected")
    whole = rows[:, :4].astype(int)
    if (whole != rows[:, :4]).any():
        raise ValueError("nodes and directions must be whole numbers")
    places = sorted(
        {tuple(each) for each in np.concatenate([whole[:, :2], whole[:, 2:]]).tolist()}
    )
    place_of = {place: number for number, place in enumerate(places)}
    row, column = (
        [place_of[tuple(each)] for each in whole[:, part].tolist()]
        for part in (slice(0, 2), slice(2, 4))
    )
    size = len(places)
    matrix = sp.coo_array((rows[:, 4], (row, column)), (size, size))
    return Labelled(matrix, [f"{node}.{way}" for node, way in places], True, True)


def _substructure(path: Path, key: str) -> Labelled:
    """Abaqus ``*SUBSTRUCTURE MATRIX OUTPUT``: mass and stiffness in one file."""
    from abaqus_mtx_parser import parse_mtx  # type: ignore[import-untyped]

    content = parse_mtx(str(path))
    matrix = getattr(content, key, None)
    if matrix is None:
        raise ValueError(f"it has no {key}")
    labels = [f"{node}.{way}" for node in content.nodes for way in content.dof[node]]
    return Labelled(matrix, labels)


def _calculix(plain: Path, path: Path) -> Labelled:
    """Row, column, value of one triangle; labels from the ``.dof`` file beside."""
    beside = plain_name(path).with_suffix(".dof")
    labels = None
    for each in (beside, beside.with_name(f"{beside.name}.gz")):
        if each.is_file():
            labels = read_names(each)
            break
    return Labelled(_of_triplets(_numbers(plain), len(labels or ())), labels, True)


def _harwell_boeing(plain: Path, path: Path) -> Labelled:
    """A matrix in the Harwell–Boeing format; labels from Ansys's mapping beside it."""
    matrix, halved = read_harwell_boeing(plain)
    mapping = plain_name(path).with_suffix(".mapping")
    labels = read_mapping(mapping) if mapping.is_file() else None
    return Labelled(matrix, labels, halved)


def read_names(path: Path) -> list[str]:
    """Return the names ``node.direction`` of the rows: a ``.dof`` file, or Ansys's mapping."""
    if plain_name(path).suffix.lower() == ".mapping":
        return read_mapping(path)
    return [_without_zeros(word, path) for word in text_of(path).split()]


def _without_zeros(label: str, path: Path) -> str:
    """``12.1`` of ``12.10000``, which some versions write."""
    match = re.fullmatch(r"(\d+)\.(\d+)", label)
    if match is None:
        raise ChoiceError(
            f"{path} has {label[:20]!r}; node and direction are needed, like 12.1"
        )
    return f"{int(match[1])}.{match[2].rstrip('0') or '0'}"


def _numbers(path: Path) -> np.ndarray:
    """Lines of numbers, separated by commas or blanks, each as many."""
    content = path.read_bytes()
    if content and not content.endswith(b"\n"):  # a number may be cut off in its digits
        raise ValueError(UNENDED)
    # exponents of Fortran, and commas
    plain = content.translate(bytes.maketrans(b"dDE,\t", b"eee  "))
    if not plain.translate(None, b"0123456789+-.e \r\n"):
        try:
            table = pd.read_csv(
                io.BytesIO(plain),
                sep=r"\s+",
                header=None,
                dtype=float,
                float_precision="round_trip",
            ).to_numpy()
        except ValueError:  # the slower reader says which line is wrong
            return _numbers_by_line(content)
        if np.isfinite(table).all():
            return np.asarray(table)
    return _numbers_by_line(content)


def _numbers_by_line(content: bytes) -> np.ndarray:
    """Read lines of numbers and comments one by one, to say which line is wrong."""
    rows = []
    text = content.decode("utf-8", errors="replace")
    for number, line in enumerate(io.StringIO(text, newline=None), 1):
        words = line.replace(",", " ").split()
        if not words or words[0].startswith(("*", "#")):
            continue
        try:
            rows.append([float(word.upper().replace("D", "E")) for word in words])
        except ValueError:
            raise ValueError(
                f"line {number} is no row of numbers: {line.strip()}"
            ) from None
        if len(rows[-1]) != len(rows[0]):
            raise ValueError(
                f"line {number} has {len(words)} numbers, not {len(rows[0])}"
            )
    if not rows:
        raise ValueError("it has no numbers")
    return np.array(rows)


def _of_triplets(rows: np.ndarray, size: int = 0) -> Any:
    """The matrix of row, column (from 1) and value."""
    if rows.shape[1] != 3:
        raise ValueError(
            f"{rows.shape[1]} numbers a line; row, column and value are expected"
        )
    places = rows[:, :2].astype(int)
    if (places != rows[:, :2]).any() or places.min() < 1:
        raise ValueError(
            "rows and columns must be whole numbers from 1 on; add 1 where a program counts from 0"
        )
    size = max(size, int(places.max()))
    return sp.coo_array(
        (rows[:, 2], (places[:, 0] - 1, places[:, 1] - 1)), (size, size)
    )


def _npz(path: Path, key: str, variable: str | None) -> Any:
    """Read one sparse matrix of scipy.sparse, or one of several arrays by its name."""
    with np.load(path, allow_pickle=False) as file:
        if "format" not in file.files:
            return file[_chosen(file.files, key, variable)]
    return sp.load_npz(path)


def _matlab(path: Path, key: str, variable: str | None) -> Any:
    try:
        content = scipy.io.loadmat(path, spmatrix=False)
    except NotImplementedError:  # version 7.3 is HDF5
        return _matlab_hdf5(path, key, variable)
    names = [name for name in content if not name.startswith("__")]
    return content[_chosen(names, key, variable)]


def _matlab_hdf5(path: Path, key: str, variable: str | None) -> Any:
    """A matrix of MATLAB 7.3: columns first, sparse ones by columns."""
    import h5py  # type: ignore[import-untyped]

    with h5py.File(path, "r") as file:
        names = [name for name in file if not name.startswith("#")]
        entry = file[_chosen(names, key, variable)]
        if isinstance(entry, h5py.Group):
            columns = entry["jc"][()]
            shape = int(entry.attrs["MATLAB_sparse"]), len(columns) - 1
            parts = (_number(entry["data"][()]), entry["ir"][()], columns)
            return sp.csc_array(parts, shape=shape)
        return _number(entry[()]).T


def _number(values: np.ndarray) -> np.ndarray:
    """Numbers of HDF5, whose complex ones are pairs."""
    if values.dtype.names == ("real", "imag"):
        return np.asarray(values["real"] + 1j * values["imag"])
    return values


def _chosen(names: list[str], key: str, variable: str | None) -> str:
    """Return the variable asked for, else the only one, else one with a usual name (mass, M)."""
    if variable is None and len(names) == 1:
        return names[0]
    if variable in names:
        return str(variable)
    usual = {
        # Nastran's names follow the set of degrees of freedom
        "mass": ("M", "mxx", "maa", "mgg", "maax"),
        "damping": ("C", "bxx", "baa", "bgg", "baax"),
        "stiffness": ("K", "kxx", "kaa", "kgg", "kaax"),
    }
    called = [name for name in (key, *usual.get(key, ())) if name in names]
    if variable is None and len(called) == 1:
        return str(called[0])
    listed = ", ".join(names)
    raise ChoiceError(
        f"it holds {listed}; say which, like {{file: brake.mat, variable: {names[0]}}}"
        if variable is None and names
        else f"it has no variable {variable!r} but {listed or 'none'}"
    )
