"""Structures from files of other programs: each is read right or refused."""

import gzip
import time
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import scipy.sparse as sp

from squealpipe import Contact, Structure, load
from squealpipe.cli import run
from squealpipe.ranges import sweep_config
from squealpipe.store.rerun.key import rule_key
from squealpipe.structures import elastic_pad
from squealpipe.study.sweep import planned

MASS = np.array([[2.0, 0.5, 0.0], [0.5, 3.0, 0.25], [0.0, 0.25, 1.0]])
STIFFNESS = np.array([[40.0, -10.0, -5.0], [-10.0, 30.0, -8.0], [-5.0, -8.0, 20.0]])
CONTACTS = (
    "name,normal,tangential,stiffness,preload,speed\nedge,2:1 3:-0.5,1:1,4.0,1.5,-2\n"
)
LABELS = ["3.1", "3.2", "17.1"]
BY_NODE = CONTACTS.replace("2:1 3:-0.5,1:1", "3.2:1 17.1:-0.5,3.1:1")
"""The same contact where the matrices name nodes and directions."""


def put(
    folder,
    text="mass: M.mtx\nstiffness: K.mtx\ncontacts: contacts.csv\n",
    contacts=CONTACTS,
):
    (folder / "contacts.csv").write_text(contacts)
    (folder / "pad.yaml").write_text(text)


def structure_of(folder, *given, **options):
    put(folder, *given, **options)
    return Structure.read(folder / "pad.yaml")


def assert_read(structure, scale=1.0):
    assert structure.mass.toarray() == pytest.approx(MASS * scale)
    assert structure.stiffness.toarray() == pytest.approx(STIFFNESS * scale)


def lower(matrix, write):
    """One line an entry of the lower triangle."""
    return "".join(
        write(i, j, matrix[i, j])
        for i in range(3)
        for j in range(i + 1)
        if matrix[i, j]
    )


def as_calculix(folder):
    for name, matrix in (("pad.mas", MASS), ("pad.sti", STIFFNESS)):
        (folder / name).write_text(
            lower(matrix, lambda i, j, v: f"{i + 1} {j + 1} {v:.15e}\n")
        )
    (folder / "pad.dof").write_text("\n".join(LABELS) + "\n")
    return "mass: pad.mas\nstiffness: pad.sti\ncontacts: contacts.csv\n"


def as_abaqus(folder):
    def line(i, j, value):
        return (
            ",".join([*LABELS[i].split("."), *LABELS[j].split("."), f" {value:.15e}"])
            + "\n"
        )

    (folder / "M.mtx").write_text(lower(MASS, line))
    (folder / "K.mtx").write_text("** rows of MATRIX INPUT\n" + lower(STIFFNESS, line))
    return "mass: M.mtx\nstiffness: K.mtx\ncontacts: contacts.csv\n"


def as_abaqus_substructure(folder):
    pytest.importorskip("abaqus_mtx_parser", reason="needs the extra [fe]")

    def rows(matrix):
        values = [f"{v:.12e}" for v in matrix[np.tril_indices(3)]]
        return "".join(f" {', '.join(values[i : i + 4])}\n" for i in range(0, 6, 4))

    (folder / "pad.mtx").write_text(
        "** Z1, 3 nodes\n*USER ELEMENT,NODES=3,LINEAR\n** ELEMENT NODES\n**  3,  17,  20\n 1\n"
        f"*MATRIX,TYPE=STIFFNESS\n{rows(STIFFNESS)}*MATRIX,TYPE=MASS\n{rows(MASS)}"
    )
    return "mass: pad.mtx\nstiffness: pad.mtx\ncontacts: contacts.csv\n"


def as_scipy(folder):
    sp.save_npz(folder / "M.npz", sp.csr_array(MASS))
    sp.save_npz(folder / "K.npz", sp.csr_array(STIFFNESS))
    return "mass: M.npz\nstiffness: K.npz\ncontacts: contacts.csv\n"


def as_matlab(folder):
    content = {"M": sp.csc_array(MASS), "K": STIFFNESS}
    scipy.io.savemat(folder / "pad.mat", content)
    return (
        "mass: {file: pad.mat, variable: M}\nstiffness: {file: pad.mat, variable: K}\n"
        "contacts: contacts.csv\n"
    )


def as_matlab_73(folder):
    h5py = pytest.importorskip("h5py", reason="needs the extra [fe]")
    path, sparse = folder / "pad.mat", sp.csc_array(MASS)
    with h5py.File(path, "w", userblock_size=512) as file:
        file["K"] = STIFFNESS.T
        group = file.create_group("M")
        group["data"], group["ir"], group["jc"] = (
            sparse.data,
            sparse.indices,
            sparse.indptr,
        )
        group.attrs["MATLAB_sparse"] = np.uint64(3)
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    with path.open("r+b") as file:
        file.write(head)
    return (
        "mass: {file: pad.mat, variable: M}\nstiffness: {file: pad.mat, variable: K}\n"
        "contacts: contacts.csv\n"
    )


def as_matrix_market(folder):
    scipy.io.mmwrite(folder / "M.mtx", sp.coo_array(MASS), symmetry="symmetric")
    scipy.io.mmwrite(folder / "K.mtx", STIFFNESS)
    return "mass: M.mtx\nstiffness: K.mtx\ncontacts: contacts.csv\n"


def as_numpy(folder):
    np.savez(folder / "pad.npz", M=MASS, K=STIFFNESS, C=0.0 * MASS)
    return "mass: pad.npz\nstiffness: pad.npz\ncontacts: contacts.csv\n"


def as_numpy_by_name(folder):
    np.savez(folder / "pad.npz", m1=MASS, k1=STIFFNESS)
    np.save(folder / "K.npy", STIFFNESS)
    return (
        "mass: {file: pad.npz, variable: m1}\nstiffness: K.npy\n"
        "contacts: contacts.csv\n"
    )


FORMS = (
    as_matrix_market,
    as_scipy,
    as_numpy,
    as_numpy_by_name,
    as_matlab,
    as_matlab_73,
    as_calculix,
    as_abaqus,
    as_abaqus_substructure,
)


@pytest.mark.parametrize("form", FORMS)
def test_each_programs_form_is_read(tmp_path, form):
    contacts = BY_NODE if form in (as_calculix, as_abaqus) else CONTACTS
    if form is as_abaqus_substructure:  # three nodes with a direction each
        contacts = BY_NODE.replace("17.1", "20.1").replace("3.2", "17.1")
    structure = structure_of(tmp_path, form(tmp_path), contacts)
    assert_read(structure)
    (edge,) = structure.contacts
    assert structure.normals[:, 0] == pytest.approx([0.0, 1.0, -0.5])
    assert structure.tangentials[:, 0] == pytest.approx([1.0, 0.0, 0.0])
    assert (edge.stiffness, edge.preload, edge.speed) == (4.0, 1.5, -2.0)


def test_a_row_is_refused_where_the_matrices_name_nodes(tmp_path):
    text = as_abaqus(tmp_path)
    with pytest.raises(ValueError, match=r"2 is a row, .* write 3\.2 if row 2"):
        structure_of(tmp_path, text)


BANNER = "%%MatrixMarket matrix"


@pytest.mark.parametrize(
    "text",
    [
        f"{BANNER} coordinate integer general\n2 2 2\n1 1 3e2\n2 2 250.7\n",
        f"{BANNER} coordinate unsigned-integer general\n2 2 2\n1 1 3e2\n2 2 250.7\n",
        f"{BANNER} array integer general\n2 2\n3e2\n0\n0\n250.7\n",
        f" {BANNER} coordinate real general\n2 2 2\n1 1 300\n2 2 250.7\n",
        f"\n{BANNER.lower()} coordinate real general\n2 2 2\n1 1 3.e+2\n2 2 2507E-1\n",
    ],
)
def test_numbers_of_a_matrix_market_file_are_those_that_stand_there(tmp_path, text):
    (tmp_path / "K.mtx").write_text(text)
    np.save(tmp_path / "M.npy", np.eye(2))
    (tmp_path / "pad.yaml").write_text("mass: M.npy\nstiffness: K.mtx\n")
    structure = Structure.read(tmp_path / "pad.yaml")
    assert structure.stiffness.toarray().tolist() == [[300.0, 0.0], [0.0, 250.7]]


def test_a_load_of_integers_keeps_its_exponents(tmp_path):
    text = as_matrix_market(tmp_path) + "load: f.mtx\n"
    array = f"{BANNER} array integer general\n3 1\n-3e2\n250.7\n1\n"
    (tmp_path / "f.mtx").write_text(array)
    assert structure_of(tmp_path, text).load.tolist() == [-300.0, 250.7, 1.0]


def test_bytes_at_one_place_are_added_up_as_numbers(tmp_path):
    twice = np.array([100, 100, 100], np.int8), ([0, 0, 1], [0, 0, 1])
    stiffness = sp.coo_array(twice, (2, 2))
    sp.save_npz(tmp_path / "K.npz", stiffness)
    np.save(tmp_path / "M.npy", np.eye(2, dtype=np.uint8))
    (tmp_path / "pad.yaml").write_text("mass: M.npy\nstiffness: K.npz\n")
    for structure in (
        Structure(np.eye(2), stiffness),
        Structure.read(tmp_path / "pad.yaml"),
    ):
        assert structure.stiffness.diagonal().tolist() == [200.0, 100.0]


@pytest.mark.parametrize("penalty", [1e12, 1e18, 1e20, 1e36])
def test_one_triangle_is_known_as_one_beside_a_penalty(tmp_path, penalty):
    whole = STIFFNESS + np.diag([0.0, 0.0, penalty])
    scipy.io.mmwrite(tmp_path / "K.mtx", sp.coo_array(np.tril(whole)))
    scipy.io.mmwrite(tmp_path / "M.mtx", sp.coo_array(MASS))
    text = "mass: M.mtx\nstiffness: K.mtx\n"
    (tmp_path / "pad.yaml").write_text(text)
    with pytest.raises(ValueError, match="triangle: mirror"):
        Structure.read(tmp_path / "pad.yaml")
    (tmp_path / "pad.yaml").write_text(text + "triangle: mirror\n")
    mirrored = Structure.read(tmp_path / "pad.yaml")
    assert np.array_equal(mirrored.stiffness.toarray(), whole)


def test_assembly_leaves_round_off_on_one_side_that_is_no_entry(tmp_path):
    noisy = STIFFNESS * [[1.0, 1e6, 1.0]] * [[1.0], [1e6], [1.0]]  # other units
    noisy[0, 2] = 1e-15
    noisy[2, 0] = 0.0
    scipy.io.mmwrite(tmp_path / "K.mtx", sp.coo_array(noisy))
    scipy.io.mmwrite(tmp_path / "M.mtx", sp.coo_array(np.eye(3)))
    (tmp_path / "pad.yaml").write_text("mass: M.mtx\nstiffness: K.mtx\n")
    assert Structure.read(tmp_path / "pad.yaml").size == 3


def test_a_structure_with_many_contacts_is_made_in_little_memory():
    size, number = 20_000, 40
    contacts = [
        Contact(f"p{i}", {2 * i: 1.0}, {2 * i + 1: 1.0}, 1e5, 10.0)
        for i in range(number)
    ]
    started = time.process_time()
    structure = Structure(sp.eye_array(size), sp.eye_array(size), contacts=contacts)
    # a square factor of its directions would have 3.2 GB and take minutes
    assert time.process_time() - started < 5.0
    assert structure.size == size


def test_millimetres_tonnes_and_seconds_become_si(tmp_path):
    text = as_matrix_market(tmp_path) + "belt_speed: 2000.0\n"
    whole = structure_of(tmp_path, text + "units: mm-t-s\n")
    assert_read(whole, scale=1e3)  # t to kg, and N/mm to N/m
    assert whole.belt_speed == pytest.approx(2.0)
    assert whole.contacts[0].stiffness == pytest.approx(4e3)
    assert whole.contacts[0].preload == pytest.approx(1.5)
    plain = structure_of(tmp_path, text).complex_modes(mu=0.3)
    assert whole.complex_modes(mu=0.3).frequency.values == pytest.approx(
        plain.frequency.values
    )


def test_milliseconds_become_si(tmp_path):
    """In m, t and ms forces are in GN: every factor has a power of a thousand of its own."""
    per_force, per_speed = 1e9, 1e3
    for name, matrix, unit in (
        ("M", MASS, 1e3),
        ("C", 1e-4 * STIFFNESS, per_force / per_speed),
        ("K", STIFFNESS, per_force),
    ):
        scipy.io.mmwrite(tmp_path / f"{name}.mtx", matrix / unit, precision=17)
    files = "mass: M.mtx\ndamping: C.mtx\nstiffness: K.mtx\ncontacts: contacts.csv\n"
    speed = 2.0 / per_speed
    whole = structure_of(tmp_path, files + f"belt_speed: {speed}\nunits: m-t-ms\n")
    assert_read(whole)
    assert whole.damping.toarray() == pytest.approx(1e-4 * STIFFNESS, rel=1e-14)
    assert whole.belt_speed == pytest.approx(2.0)
    plain = structure_of(tmp_path, as_matrix_market(tmp_path))
    force = whole.contacts[0].preload / plain.contacts[0].preload
    assert force == pytest.approx(per_force)


def replaced(path, old, new):
    content = path.read_text()
    assert old in content
    path.write_text(content.replace(old, new, 1))


def one_triangle(folder):
    scipy.io.mmwrite(folder / "K.mtx", sp.coo_array(np.triu(STIFFNESS)))


def complex_entries(folder):
    scipy.io.mmwrite(folder / "K.mtx", sp.coo_array(STIFFNESS * (1 + 0.02j)))


def not_a_number(folder):
    scipy.io.mmwrite(folder / "K.mtx", np.where(STIFFNESS == 30.0, np.nan, STIFFNESS))


def cut_off(folder):
    content = (folder / "K.mtx").read_text().splitlines()
    (folder / "K.mtx").write_text("\n".join(content[:-3]))


def cut_within_the_last_number(folder):
    content = (folder / "K.mtx").read_text()
    (folder / "K.mtx").write_text(content.rstrip()[:-2])


def empty_table(folder):
    (folder / "contacts.csv").write_text(CONTACTS.splitlines()[0])


def negative_mass(folder):
    scipy.io.mmwrite(folder / "M.mtx", sp.coo_array(-MASS), symmetry="symmetric")


def another_size(folder):
    scipy.io.mmwrite(folder / "K.mtx", STIFFNESS[:2, :2])


def without_mass(folder):
    scipy.io.mmwrite(folder / "M.mtx", sp.coo_array(np.diag([1.0, 0.0, 2.0])))


def wrong_units(folder):
    replaced(folder / "pad.yaml", "contacts:", "units: mm-N-s\ncontacts:")


def unknown_key(folder):
    replaced(folder / "pad.yaml", "stiffness:", "stifness:")


def no_such_row(folder):
    replaced(folder / "contacts.csv", "1:1,", "7:1,")


def both_triangles_of_a_symmetric_file(folder):
    scipy.io.mmwrite(folder / "K.mtx", sp.coo_array(STIFFNESS), symmetry="general")
    replaced(folder / "K.mtx", "general", "symmetric")


def coordinates(folder, first):
    banner = "%%MatrixMarket matrix coordinate real general\n3 3 3\n"
    (folder / "K.mtx").write_text(banner + first + "2 2 1.0\n3 3 1.0\n")


def exponents_of_fortran(folder):
    coordinates(folder, "1 1 4.0D+01\n")


def decimal_commas(folder):
    coordinates(folder, "1 1 40,5\n")


def rows_from_zero(folder):
    coordinates(folder, "0 0 1.0\n")


def without_values(folder):
    banner = "%%MatrixMarket matrix coordinate pattern general\n3 3 3\n"
    (folder / "K.mtx").write_text(banner + "1 1\n2 2\n3 3\n")


def without_banner(folder):
    replaced(folder / "K.mtx", "%%MatrixMarket matrix array real symmetric\n", "")


def packed_and_cut_off(folder):
    content = gzip.compress((folder / "K.mtx").read_bytes())
    (folder / "K.mtx").write_bytes(content[:-9])


def with_a_byte_order_mark(folder):
    content = (folder / "K.mtx").read_text()
    (folder / "K.mtx").write_text(content, encoding="utf-8-sig")


def two_columns_of_load(folder):
    (folder / "load.txt").write_text("1 2\n3 4\n5 6\n")
    replaced(folder / "pad.yaml", "contacts:", "load: load.txt\ncontacts:")


def complex_load(folder):
    scipy.io.mmwrite(folder / "f.mtx", np.full((3, 1), 1 + 1j))
    replaced(folder / "pad.yaml", "contacts:", "load: f.mtx\ncontacts:")


def more_cells_than_columns(folder):
    replaced(folder / "contacts.csv", "-2\n", "-2,7\n")


def cells_below_no_name(folder):
    replaced(folder / "contacts.csv", "\n", ",,\n")
    replaced(folder / "contacts.csv", "-2\n", "-2,7,\n")


def units_in_the_header(folder):
    replaced(folder / "contacts.csv", "stiffness", "stiffness (N/mm)")


def without_a_header(folder):
    (folder / "contacts.csv").write_text(CONTACTS.splitlines()[1] + "\n")


def row_between_rows(folder):
    replaced(folder / "contacts.csv", "1:1,", "19e-1:1,")


def no_name_of_a_file(folder):
    replaced(folder / "pad.yaml", "contacts.csv", "")


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (both_triangles_of_a_symmetric_file, "write `general`"),
        (exponents_of_fortran, "line 3 is no entry: .*an e"),
        (decimal_commas, "line 3 is no entry: .*decimal point"),
        (rows_from_zero, "line 3 is no entry: .*from 1"),
        (without_values, "pattern"),
        (without_banner, "%%MatrixMarket matrix coordinate"),
        (packed_and_cut_off, "stiffness: .*packed by gzip but damaged"),
        (with_a_byte_order_mark, "UTF-8 without"),
        (two_columns_of_load, "one real number a line"),
        (complex_load, "one real number a line"),
        (more_cells_than_columns, "7 cells, but the header 6"),
        (cells_below_no_name, "8 cells, but the header"),
        (units_in_the_header, "did you mean 'stiffness'. Units stand in"),
        (without_a_header, "first row must name the columns"),
        (row_between_rows, "1 to 3 in files"),
        (no_name_of_a_file, "the name of a file is needed"),
        (one_triangle, "triangle: mirror"),
        (complex_entries, "complex entries"),
        (not_a_number, "finite numbers"),
        (cut_off, "cut off"),
        (cut_within_the_last_number, "last line has no end"),
        (empty_table, "leave `contacts` out"),
        (negative_mass, "change its sign"),
        (another_size, "3 × 3"),
        (without_mass, "no.* mass|mass is singular"),
        (wrong_units, "no mass"),
        (unknown_key, "stiffness"),
        (no_such_row, "1 to 3 in files"),
    ],
)
def test_a_bad_file_is_refused_with_its_remedy(tmp_path, spoil, words):
    put(tmp_path, as_matrix_market(tmp_path))
    spoil(tmp_path)
    with pytest.raises(ValueError, match=words):
        Structure.read(tmp_path / "pad.yaml")


def last_lines_lost(folder, form):
    content = (folder / form).read_text().splitlines(keepends=True)
    (folder / form).write_text("".join(content[:-2]))


def a_line_twice(folder, form):
    content = (folder / form).read_text().splitlines(keepends=True)
    (folder / form).write_text("".join([*content, content[-1]]))


@pytest.mark.parametrize(
    ("form", "file"), [(as_abaqus, "K.mtx"), (as_calculix, "pad.sti")]
)
@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (last_lines_lost, "17.1 (has no entry|.*lacks)|lacks 17.1"),
        (a_line_twice, "twice"),
    ],
)
def test_formats_without_a_number_of_entries_are_read_whole_or_not(
    tmp_path, form, file, spoil, words
):
    text = form(tmp_path)
    spoil(tmp_path, file)
    with pytest.raises(ValueError, match=words):
        structure_of(tmp_path, text)


def test_labels_that_name_two_rows_or_no_order_are_refused(tmp_path):
    text = as_calculix(tmp_path)
    (tmp_path / "pad.dof").write_text("3.1\n3.1\n17.1\n")
    with pytest.raises(ValueError, match=r"3\.1 .* twice"):
        structure_of(tmp_path, text)
    (tmp_path / "pad.dof").write_text("3.1\nx.2\n17.1\n")
    with pytest.raises(ValueError, match=r"pad\.dof has 'x\.2'"):
        structure_of(tmp_path, text)
    text = as_abaqus(tmp_path)
    scipy.io.mmwrite(tmp_path / "K.mtx", STIFFNESS)
    with pytest.raises(ValueError, match="write both in one format"):
        structure_of(tmp_path, text)


@pytest.mark.parametrize(
    "table",
    [
        CONTACTS.replace(",", ";").encode("utf-16"),
        ("# of the pad\r\n\r\n" + CONTACTS.replace(",", "\t")).encode("utf-8-sig"),
        CONTACTS.replace("2:1 3:-0.5", '"2: 1, 3: -0.5"').encode(),
    ],
)
def test_a_table_of_contacts_is_read_as_spreadsheets_write_it(tmp_path, table):
    structure_of(tmp_path, as_matrix_market(tmp_path))
    (tmp_path / "contacts.csv").write_bytes(table)
    (edge,) = Structure.read(tmp_path / "pad.yaml").contacts
    assert edge.normal == {1: 1.0, 2: -0.5}
    assert (edge.stiffness, edge.preload, edge.speed) == (4.0, 1.5, -2.0)


def test_a_column_across_asks_for_the_damping_of_friction_along_it(tmp_path):
    text = as_matrix_market(tmp_path)
    lines = CONTACTS.splitlines()
    table = f"{lines[0]},across\n{lines[1]},3:1\n"
    (edge,) = structure_of(tmp_path, text, table).contacts
    assert edge.transverse_damping
    assert edge.across == {2: 1.0}


def test_the_remedies_for_one_triangle_work(tmp_path):
    text = as_matrix_market(tmp_path)
    one_triangle(tmp_path)
    assert_read(structure_of(tmp_path, text + "triangle: mirror\n"))
    kept = structure_of(tmp_path, text + "triangle: keep\n")
    assert kept.stiffness.toarray() == pytest.approx(np.triu(STIFFNESS))


def test_a_cut_off_file_of_one_triangle_never_becomes_half_a_matrix(tmp_path):
    text = as_abaqus(tmp_path)
    lines = (tmp_path / "K.mtx").read_text().splitlines()
    (tmp_path / "K.mtx").write_text("\n".join(lines[:-1])[:-9])
    with pytest.raises(ValueError, match=r"K\.mtx"):
        structure_of(tmp_path, text)


@pytest.mark.usefixtures("real_pictures")
def test_the_command_writes_what_python_computes(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    structure = structure_of(tmp_path, as_matrix_market(tmp_path))
    assert run(["modes", "pad.yaml", "--mu", "0:0.8:5", "-o", "modes.nc"]) == 0
    assert "modes are unstable somewhere" in capsys.readouterr().out
    written = load("modes.nc")
    computed = structure.complex_modes(mu=np.linspace(0, 0.8, 5))
    assert np.array_equal(written.growth_rate, computed.growth_rate)
    assert written.mu.dims == ("mu",)
    assert (tmp_path / "modes.png").stat().st_size > 10000


def test_the_terminal_shows_modes_up_to_20_khz_and_says_so(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    np.save("M.npy", np.eye(3))
    np.save("K.npy", np.diag([1e8, 4e8, 1e13]))  # the last at 503 kHz, of a mesh
    Path("pad.yaml").write_text("mass: M.npy\nstiffness: K.npy\n")
    assert run(["modes", "pad.yaml", "-o", "modes.nc"]) == 0
    told = capsys.readouterr().out
    assert "modes up to 20 kHz. Whether modes above grow is not examined" in told
    assert "up to 20 kHz are unstable; those above were not examined" in told
    assert load("modes.nc").sizes["mode"] == 2
    more = ["--frequency-max", "1 MHz", "-o", "all.nc"]
    assert run(["modes", "pad.yaml", *more]) == 0
    assert load("all.nc").sizes["mode"] == 3


@pytest.mark.usefixtures("real_pictures")
def test_modes_over_factors_are_a_command_and_a_task_of_sweeps(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    structure = structure_of(tmp_path, as_matrix_market(tmp_path))
    computed = structure.complex_modes(
        mu=np.linspace(0, 0.8, 3), edge_stiffness=[0.5, 2.0]
    )
    over = ["--vary", "edge_stiffness=0.5,2"]
    assert run(["modes", "pad.yaml", "--mu", "0:0.8:3", *over, "-o", "modes.nc"]) == 0
    assert (tmp_path / "modes.png").stat().st_size > 10000
    task = "pad.yaml:complex_modes"
    assert run(["sweep", task, "--vary", "mu=0:0.8:3", *over, "-o", "sweep.nc"]) == 0
    for file in ("modes.nc", "sweep.nc"):
        written = load(file)
        assert written.growth_rate.dims == ("mu", "edge_stiffness", "mode")
        assert np.array_equal(written.growth_rate, computed.growth_rate)


def test_a_sweep_of_a_structure_is_checked_when_planned_and_follows_all_its_files(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    structure_of(tmp_path, as_matrix_market(tmp_path))

    def config(task="pad.yaml:complex_modes", vary=None, **fixed):
        vary = {"mu": [0.1, 0.2]} if vary is None else vary
        return sweep_config(task=task, vary=vary, fixed=fixed, parameters={"mu": 0.3})

    before = rule_key(config(), [])
    scipy.io.mmwrite(tmp_path / "K.mtx", 2.0 * STIFFNESS)
    assert rule_key(config(), []) != before
    for faulty, words in (
        (config("pad.yaml:modes"), "write pad.yaml:complex_modes"),
        (config(frequency=1.0), "did you mean 'frequency_max'"),
        (config(vary={"n_modes": [1, 2]}), "cannot be varied"),
        (config(vary={"mu": [0.2, 0.1]}), "ascend"),
        (config(frequency_max=-1.0), "greater than 0"),
    ):
        with pytest.raises(ValueError, match=words):
            planned(faulty)
    with pytest.raises(FileNotFoundError):
        planned(config("none.yaml:complex_modes"))


@pytest.mark.parametrize(
    ("matrix", "labels"),
    [
        *[(ending, ".dof") for ending in (".sti", ".mas", ".sti.gz")],
        *[(ending, ".mapping") for ending in (".matrix", ".hb", ".rsa", ".rua")],
    ],
)
def test_labels_beside_a_matrix_are_part_of_the_key(
    tmp_path, monkeypatch, matrix, labels
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pad.yaml").write_text(f"stiffness: K{matrix}\n")
    (tmp_path / f"K{matrix}").write_text("1 1 2.0\n")
    (tmp_path / f"K{labels}").write_text("7.1\n")
    before = rule_key({"file": "pad.yaml"}, [])
    (tmp_path / f"K{labels}").write_text("7.2\n")
    assert rule_key({"file": "pad.yaml"}, []) != before


def test_contacts_that_are_open_are_named():
    pad = elastic_pad(elements=(6, 2), contacts=3)
    _, *others = pad.contacts
    pulled = pad.with_(load=pad.load + 600.0 * pad.normals[:, 0])
    modes = pulled.complex_modes(frequency_max=60e3)
    assert modes.attrs["open_contacts"] == "p1"
    assert modes.normal_force.sel(contact="p1") == 0
    alone = pad.with_(contacts=others).complex_modes(frequency_max=60e3)
    assert modes.frequency.values == pytest.approx(alone.frequency.values, rel=1e-9)


def test_a_terminal_is_told_in_its_words_what_is_wrong_before_anything_is_computed(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    text = as_calculix(tmp_path)
    contacts = BY_NODE.replace("speed", "speed,mu").replace("-2\n", "-2,0.5\n")
    structure_of(tmp_path, text, contacts)
    assert run(["modes", "pad.yaml", "--mu", "0", "-o", "modes.nc"]) == 2
    assert (
        "--mu 0.0: every contact has a mu of its own, so that none has the structure's; vary one, "
        "like --mu edge=…, or leave mu out"
    ) in capsys.readouterr().err

    def computed(*_):
        raise AssertionError

    monkeypatch.setattr("squealpipe.cli.structures.as_asked", computed)
    assert run(["assess", "pad.yaml", "--modify", "w=added_mass 99999.1 0.1"]) == 2
    assert "w: added_mass['99999.1']" in capsys.readouterr().err


def test_contacts_that_are_open_in_steady_sliding_are_named(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    text = as_calculix(tmp_path) + "load: 0\n"
    more = "open,17.1:-1,3.2:1,4.0,0,1\n"
    structure_of(tmp_path, text, BY_NODE + more)
    assert run(["modes", "pad.yaml", "--no-critical", "-o", "modes.nc"]) == 0
    opened = load("modes.nc").attrs["open_contacts"]
    assert opened == "open"
    assert (
        "1 of 2 contacts are open in steady sliding and left out there: open"
        in capsys.readouterr().out
    )
