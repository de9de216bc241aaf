"""Matrices of Nastran and in the Harwell–Boeing format, from real and from written files."""

import gzip
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp

from squealpipe import Structure
from squealpipe.structures.harwell_boeing import read_mapping
from squealpipe.structures.readers import read_matrix

with np.printoptions():  # pyyeti sets other ones
    import pyyeti
    from pyyeti.nastran import bulk, op4

REAL = Path(pyyeti.__file__).parent / "tests"
"""Files that Nastran wrote, which pyyeti brings along."""
M = np.diag([2.0, 1.0, 3.0, 1.5])
K = np.array(
    [
        [4.0, -1.0, 0.0, 0.5],
        [-1.0, 3.0, -1.0, 0.0],
        [0.0, -1.0, 5.0, 0.0],
        [0.5, 0.0, 0.0, 2.0],
    ]
)
NAMES = ["5.1", "5.2", "7.1", "7.3"]
YAML = "mass: {mass}\nstiffness: {stiffness}\n"


def structure(folder, mass, stiffness):
    (folder / "pad.yaml").write_text(YAML.format(mass=mass, stiffness=stiffness))
    return Structure.read(folder / "pad.yaml")


def test_nastrans_own_output4_is_read_by_the_names_of_its_matrices(tmp_path):
    path = REAL / "nas2cam_extseout" / "outboard.op4"
    mass, stiffness = (read_matrix(path, key).matrix for key in ("mass", "stiffness"))
    assert mass.shape == stiffness.shape == (46, 46)
    # a free body: six motions without strain energy, and modes kept with a generalized mass of 1
    values = np.linalg.eigvalsh(stiffness.toarray())
    assert (np.abs(values) < 1e-6 * values[-1]).sum() >= 6
    read = structure(tmp_path, path, path)
    assert read.size == 46
    assert read.names is None


def test_nastrans_own_dmig_names_its_rows():
    path = REAL / "nastran_dmig_data" / "matrix_factory.pch"
    one = read_matrix(path, "stiffness", "patrn")
    assert one.labels[:3] == ["1.1", "1.2", "1.3"]
    assert one.labels[-1] == "12.0"
    # its first column holds 1, the second 2, …
    np.testing.assert_array_equal(
        one.matrix.toarray()[:, 1], np.full(len(one.labels), 2.0)
    )
    with pytest.raises(ValueError, match=r"it holds patrn, ident.*say which"):
        read_matrix(path, "stiffness")
    with pytest.raises(ValueError, match="rectangular"):
        read_matrix(path, "stiffness", "cmplx")


@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("sparse", ["dense", "bigmat", "nonbigmat"])
def test_output4_of_every_form_gives_the_matrices(tmp_path, binary, sparse):
    op4.write(
        tmp_path / "pad.op4", ["kaa", "maa"], [K, M], binary=binary, sparse=sparse
    )
    read = structure(tmp_path, "pad.op4", "pad.op4")
    np.testing.assert_allclose(read.stiffness.toarray(), K, rtol=1e-14)
    np.testing.assert_allclose(read.mass.toarray(), M, rtol=1e-14)


def test_dmig_gives_matrices_with_names(tmp_path):
    import pandas as pd

    index = pd.MultiIndex.from_tuples(
        [tuple(map(int, name.split("."))) for name in NAMES], names=["id", "dof"]
    )
    tables = {
        name: pd.DataFrame(matrix, index=index, columns=index)
        for name, matrix in (("MAAX", M), ("KAAX", K))
    }
    with (tmp_path / "pad.pch").open("w") as file:
        bulk.wtdmig(file, tables)
    read = structure(tmp_path, "pad.pch", "pad.pch")
    assert list(read.names) == NAMES
    np.testing.assert_allclose(read.stiffness.toarray(), K, rtol=1e-9)


def harwell_boeing(matrix, kind="RSA"):
    """By the format's documentation: pointers, rows and values of the columns' lower triangle."""
    columns = sp.csc_array(np.tril(matrix) if kind == "RSA" else matrix)
    pointers = "".join(f"{each + 1:10d}" for each in columns.indptr)
    rows = "".join(f"{each + 1:10d}\n" for each in columns.indices)
    values = "".join(f"{each:25.16E}\n" for each in columns.data)
    size, count = columns.shape[0], columns.nnz
    head = f"{'brake':72s}{'K':8s}\n{1 + 2 * count:14d}{1:14d}{count:14d}{count:14d}{0:14d}\n"
    head += f"{kind:14s}{size:14d}{size:14d}{count:14d}{0:14d}\n"
    head += f"{f'({size + 1}I10)':16s}{'(1I10)':16s}{'(1E25.16)':20s}\n"
    return head + pointers + "\n" + rows + values


def mapping(names):
    ways = {"1": "UX", "2": "UY", "3": "UZ", "4": "ROTX"}
    lines = ["     Matrix Eqn          Node           DOF"]
    for row, name in enumerate(names, 1):
        node, direction = name.split(".")
        lines.append(f"{row:15d}{node:>14s}{ways[direction]:>14s}")
    return "\n".join(lines) + "\n"


def test_triangles_of_ansys_are_completed_and_its_mapping_names_rows(tmp_path):
    for name, matrix in (("M", M), ("K", K)):
        (tmp_path / f"{name}.matrix").write_text(harwell_boeing(matrix))
        (tmp_path / f"{name}.mapping").write_text(mapping(NAMES))
    read = structure(tmp_path, "M.matrix", "K.matrix")
    assert list(read.names) == NAMES
    np.testing.assert_allclose(read.stiffness.toarray(), K, rtol=1e-15)
    # other equations, same structure
    order = [2, 0, 3, 1]
    (tmp_path / "K.matrix").write_text(harwell_boeing(K[np.ix_(order, order)]))
    (tmp_path / "K.mapping").write_text(mapping([NAMES[place] for place in order]))
    read = structure(tmp_path, "M.matrix", "K.matrix")
    np.testing.assert_allclose(read.stiffness.toarray(), K, rtol=1e-15)


def test_all_directions_of_ansys_have_their_numbers(tmp_path):
    words = ["UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ"]  # translations, then rotations
    lines = [f"{row} 9 {word}\n" for row, word in enumerate(words, 1)]
    (tmp_path / "K.mapping").write_text("".join(lines))
    assert read_mapping(tmp_path / "K.mapping") == [f"9.{axis}" for axis in range(1, 7)]


def test_whole_matrices_of_scipy_are_read_as_they_are(tmp_path):
    for name, matrix in (("M", M), ("K", K)):
        scipy.io.hb_write(tmp_path / f"{name}.rua", sp.csc_array(matrix))
    (tmp_path / "K.rua.gz").write_bytes(
        gzip.compress((tmp_path / "K.rua").read_bytes())
    )
    read = structure(tmp_path, "M.rua", "K.rua.gz")
    np.testing.assert_allclose(read.stiffness.toarray(), K, rtol=1e-15)


@pytest.mark.parametrize(
    ("file", "content", "words"),
    [
        ("K.hb", "nothing", "no header"),
        ("K.hb", harwell_boeing(K).replace("RSA", "CSA"), "type is 'CSA'"),
        ("K.hb", harwell_boeing(K)[:-60], "cut off"),
        ("K.pch", "$ nothing\n", "no DMIG cards"),
        ("K.op4", "nothing at all", "cut off"),
    ],
)
def test_damaged_files_are_named(tmp_path, file, content, words):
    (tmp_path / file).write_text(content)
    with pytest.raises(ValueError, match=words) as caught:
        read_matrix(tmp_path / file, "stiffness")
    assert file in str(caught.value)


def test_mapping_of_temperatures_is_refused(tmp_path):
    (tmp_path / "K.hb").write_text(harwell_boeing(K))
    (tmp_path / "K.mapping").write_text(mapping(NAMES).replace("UZ", "TEMP"))
    with pytest.raises(ValueError, match="row 4 is TEMP of node 7"):
        read_matrix(tmp_path / "K.hb", "stiffness")
    (tmp_path / "K.mapping").write_text(mapping(NAMES[:3]).replace("3 ", "4 ", 1))
    with pytest.raises(ValueError, match=r"rows|labelled"):
        structure(tmp_path, "K.hb", "K.hb")


@pytest.mark.release
def test_reading_leaves_numpys_print_options_as_they_are():
    """Those that pyyeti sets cut the numbers of CSV files to twelve digits."""
    path = REAL / "nas2cam_extseout" / "outboard.op4"
    code = (
        "import numpy as np; before = np.get_printoptions();"
        "from squealpipe.structures.readers import read_matrix;"
        f"read_matrix(__import__('pathlib').Path({str(path)!r}), 'mass');"
        "assert np.get_printoptions() == before"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
