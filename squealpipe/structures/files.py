"""A structure in a file: ``pad.yaml`` names matrices, contacts and numbers."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import scipy.sparse as sp

from squealpipe.laws.friction_laws import own_law_rules
from squealpipe.laws.numerals import decimal_sign, numeral, plain
from squealpipe.laws.rows import text_rows
from squealpipe.laws.tables import named
from squealpipe.store.yaml_files import read_yaml
from squealpipe.structures.contact import Contact
from squealpipe.structures.contact_table import read_contacts
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.matrices import real_square
from squealpipe.structures.meshes.face_entries import faces_in, read_pressures
from squealpipe.structures.meshes.faces import Face, Rotation
from squealpipe.structures.meshes.from_mesh import names_of, of_mesh
from squealpipe.structures.packed import plain_name
from squealpipe.structures.readers import Labelled, read_matrix
from squealpipe.structures.units import SI, Scales, scales_of
from squealpipe.systems.inputs.units import holds_units
from squealpipe.systems.inputs.values import brief, is_finite_number
from squealpipe.systems.inputs.words import suggestion
from squealpipe.validation import real_array

Form = TypeVar("Form", bound=ContactStructure)
MATRIX_KEYS = ("mass", "stiffness", "damping")
SCALAR_KEYS = ("mu", "belt_speed", "mu_static", "friction_speed")
CHANGING = ("damping", "stiffness")
"""Matrices that may have parts that change with speed."""


def read(path: str | PathLike[str], form: type[Form]) -> Form:
    """A structure from its file.

    The file has the keys ``mass`` and ``stiffness``, and where needed ``damping``: names of matrix
    files beside it, or ``{file: NAME, variable: NAME}``; ``speed_terms``, like ``{damping:
    [{matrix: DG.mtx, power: 1}], stiffness: [{matrix: KG.mtx, power: 2, factor: -1}]}``, matrices
    that are added times factor (1 without it) and a power of the speed; ``contacts``, a table (text
    or .xlsx) with the columns name, normal, tangential, stiffness, preload and optionally speed,
    ``mu`` and ``mu_static`` (of that contact; an empty cell leaves it to the structure), ``law``
    (in place of a stiffness: a file of a table, or ``0:0 0.01mm:90N``…) and
    ``tangential_stiffness`` (of a spring in series with friction), where a
    direction is ``12:1 40:-1``, degrees of freedom counted from 1, or ``31.2:1``, node and
    direction, where the matrix file has them; ``mu``, ``belt_speed``, ``friction_law``,
    ``mu_static``, ``friction_speed``, ``modal_damping`` and ``load`` (a file with one number a
    line, or 0) as of :class:`Structure`; ``units`` (``m-kg-s``; all numbers of a file with
    ``mm-t-s`` are in mm, t, s and N and become SI's; a rotation then counts as the displacement at
    an arm of one unit of length); ``triangle``: ``mirror`` where a file has one triangle of a
    symmetric matrix, ``keep`` where it is meant as it is.

    With ``mesh`` (a deck of CalculiX or Abaqus, or what meshio reads) ``contacts`` may be a mapping
    of faces, with the arguments of :class:`Face` each; ``degrees_of_freedom`` names a ``.dof`` file
    that does not have the matrices' name; ``rotation`` has ``axis``, ``through``, ``speed``
    (``20 rad/s``) and ``body``. ``belt_speed`` is then in rad/s.

    Args:
        path: the YAML file; names in it are relative to its folder.
        form: :class:`Structure`, or a class derived from it.

    Raises:
        FileNotFoundError: a file that does not exist.
        ValueError: a key, value or file that is wrong; names it.
    """
    source = Path(path).expanduser()
    content = _content(source)
    folder = source.parent
    scales = scales_of(content["units"]) if "units" in content else SI
    entries = {key: content[key] for key in MATRIX_KEYS if key in content}
    speed_terms = _speed_terms(content, source)
    matrices, labels = read_matrices(
        entries | {key: entry["matrix"] for key, entry in speed_terms.items()},
        folder,
        scales,
        content.get("triangle"),
    )
    if "degrees_of_freedom" in content:
        labels = names_of(
            _file_name("degrees_of_freedom", content["degrees_of_freedom"]), folder
        )
    arguments: dict[str, Any] = {key: matrices[key] for key in entries}
    if speed_terms:
        arguments["speed_terms"] = {
            what: [
                (matrices[key] * entry.get("factor", 1.0), entry["power"])
                for key, entry in speed_terms.items()
                if what in key
            ]
            for what in CHANGING
        }
    rotation = _rotation(content, scales)
    try:
        arguments |= _of_mesh(content, folder, scales, arguments, labels, rotation)
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from error
    if isinstance(content.get("contacts"), str):
        table = folder / content["contacts"]
        size = matrices["mass"].shape[0]
        turning = rotation is not None
        arguments["contacts"] = _contacts(table, labels, size, scales, turning=turning)
    arguments |= _numbers(content, folder, scales, rotation)
    if "load" in content:
        arguments["load"] = _load(content["load"], folder, scales)
    if labels is not None and "mesh" not in arguments:
        arguments["names"] = [str(label) for label in labels]
    try:
        return form(**arguments, rotation=rotation)
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from error


def _speed_terms(
    content: Mapping[str, Any], source: Path
) -> dict[str, Mapping[str, Any]]:
    """Return the entries of ``speed_terms``, checked, by names that say what they are part of."""
    given = content.get("speed_terms", {})
    hint = (
        "lists of matrix and power are needed, like {damping: [{matrix: DG.mtx, power: 1}]}; "
        "factor is optional"
    )
    if not isinstance(given, Mapping):
        raise ValueError(  # noqa: TRY004 (of all arguments mistakes are values)
            f"{source}: speed_terms = {brief(given)}: {hint}"
        )
    terms = {}
    for what, entries in given.items():
        if what not in CHANGING:
            near = suggestion(str(what), CHANGING)
            raise ValueError(f"{source}: speed_terms: {what!r}: {near}")
        for number, entry in enumerate(entries if isinstance(entries, list) else [0]):
            name = f"speed_terms: {what} {number + 1}"
            if not isinstance(entry, Mapping) or not (
                {"matrix", "power"} <= set(entry) <= {"matrix", "power", "factor"}
            ):
                raise ValueError(f"{source}: {name} = {brief(entry)}: {hint}")
            if not is_finite_number(entry.get("factor", 1.0)):
                raise ValueError(
                    f"{source}: {name}: factor = {brief(entry['factor'])}: a number is needed"
                )
            terms[name] = entry
    return terms


def _numbers(
    content: Mapping[str, Any], folder: Path, scales: Scales, rotation: Rotation | None
) -> dict[str, Any]:
    """Return friction, speeds and modal damping, in SI."""
    arguments: dict[str, Any] = {
        name: content[name]
        for name in (*SCALAR_KEYS, "modal_damping")
        if name in content
    }
    damping: Any = arguments.get("modal_damping")
    if is_finite_number(damping) and damping > 1:
        raise ValueError(
            f"modal_damping = {damping:g}: ratios above 1 leave no mode that oscillates; 1 % is "
            "0.01"
        )
    # the speed of what turns is an angular one
    turning = scales.speed if rotation is None else scales.rate
    for name, factor in (("friction_speed", scales.speed), ("belt_speed", turning)):
        if is_finite_number(arguments.get(name)):
            arguments[name] = float(arguments[name]) * factor
    if "friction_law" in content:
        arguments["friction_law"] = named(
            content["friction_law"], own_law_rules.columns, folder
        )
    return arguments


def _of_mesh(
    content: Mapping[str, Any],
    folder: Path,
    scales: Scales,
    matrices: Mapping[str, Any],
    labels: Sequence[Any] | None,
    rotation: Rotation | None,
) -> dict[str, Any]:
    """Return mesh and contacts of faces; nothing where the file names no mesh."""
    contacts = content.get("contacts")
    if "mesh" not in content:
        if isinstance(contacts, Mapping):
            raise ValueError(
                "contacts are faces of a mesh, which is missing; name it, like `mesh: brake.inp`"
            )
        if "contacts" in content and not isinstance(contacts, str):
            raise ValueError(
                f"contacts = {brief(contacts)}: the name of a file is needed, a table of them, "
                "or faces of a mesh by name"
            )
        return {}
    faces: dict[str, Face] = {}
    if contacts is not None and not isinstance(contacts, str):
        faces = faces_in(contacts, folder, scales)
    path = folder / _file_name("mesh", content["mesh"])
    whole = of_mesh(matrices["mass"], labels, path, faces, rotation, scales.length)
    return {"mesh": whole.mesh} | ({"contacts": whole.contacts} if faces else {})


def from_mesh(
    form: type[Form],
    matrices: Mapping[str, Any],
    mesh: Any,
    faces: Mapping[str, Face],
    rotation: Rotation | None,
    degrees_of_freedom: Any,
    units: str | None,
    arguments: Mapping[str, Any],
) -> Form:
    """A structure whose contacts are faces of a mesh; see :meth:`Structure.from_mesh`."""
    if not isinstance(faces, Mapping) or not all(
        isinstance(face, Face) for face in faces.values()
    ):
        raise ValueError(
            f"contacts = {brief(faces)}: {{name: Face}} is needed, like {{'lining': Face('PAD', "
            "against='DISC', stiffness=1e9, pressure=5e5)}"
        )
    if rotation is not None and not isinstance(rotation, Rotation):
        raise ValueError(f"rotation = {brief(rotation)}: a Rotation is needed")
    scales = SI if units is None else scales_of(units)
    entries = {key: matrix for key, matrix in matrices.items() if matrix is not None}
    in_si, labels = read_matrices(entries, Path(), scales)
    names = labels if degrees_of_freedom is None else names_of(degrees_of_freedom)
    with_pressures = {
        name: replace(face, pressures=read_pressures(Path(face.pressures)))
        if isinstance(face.pressures, str | PathLike)
        else face
        for name, face in faces.items()
    }
    whole = of_mesh(in_si["mass"], names, mesh, with_pressures, rotation, scales.length)
    return form(
        **in_si,
        **arguments,
        contacts=whole.contacts,
        mesh=whole.mesh,
        rotation=rotation,
    )


def _rotation(content: Mapping[str, Any], scales: Scales) -> Rotation | None:
    """Return the rotation that the file has."""
    if "rotation" not in content:
        return None
    given = content["rotation"]
    keys = ("axis", "through", "speed", "body")
    if not isinstance(given, Mapping):
        raise ValueError(  # noqa: TRY004 (of all arguments mistakes are values)
            f"rotation = {brief(given)}: {', '.join(keys)} are needed, like `rotation: {{axis: "
            "[0, 0, 1], through: [0, 0, 0], speed: 20 rad/s}`"
        )
    for key in given:
        if key not in keys:
            remedy = suggestion(str(key), keys)
            if str(key)[:1].isdigit():  # {speed: 100,5 rpm} is two entries
                remedy = "a comma begins another key; write a decimal point"
            raise ValueError(f"rotation: {key!r} is unknown; {remedy}")
    if "speed" not in given:
        raise ValueError("rotation: speed is missing; give it, like `speed: 20 rad/s`")
    arguments = dict(given)
    if is_finite_number(arguments["speed"]):
        arguments["speed"] *= scales.rate
    if "through" in arguments:
        if holds_units(arguments["through"]):
            raise ValueError(
                f"rotation: through = {brief(arguments['through'])}: plain numbers are needed, in "
                f"the length of the file's units (1 is {scales.length:g} m)"
            )
        through = real_array("rotation: through", arguments["through"])
        arguments["through"] = through * scales.length
    return Rotation(**arguments)


def _contacts(
    table: Path, labels: list[str] | None, size: int, scales: Scales, *, turning: bool
) -> list[Contact]:
    """Those of a table that has some."""
    contacts = read_contacts(table, labels, size, scales, turning=turning)
    if not contacts:
        raise ValueError(f"{table} has no row; leave `contacts` out if there are none")
    return contacts


def _file_name(key: str, given: Any) -> str:
    if not isinstance(given, str) or not given:
        raise ValueError(f"{key} = {brief(given)}: the name of a file is needed")
    return given


def _content(source: Path) -> dict[str, Any]:
    content = read_yaml(source)
    keys = (
        *MATRIX_KEYS,
        "speed_terms",
        *SCALAR_KEYS,
        "contacts",
        "modal_damping",
        "friction_law",
        "load",
        "units",
        "triangle",
        "mesh",
        "degrees_of_freedom",
        "rotation",
    )
    for key in content:
        if key not in keys:
            raise ValueError(
                f"{source}: {key!r} is unknown; {suggestion(str(key), keys)}"
            )
    for key in ("mass", "stiffness"):
        if key not in content:
            raise ValueError(
                f"{source} lacks {key}; name its matrix, like `{key}: {key}.mtx`"
            )
    return content


def read_matrices(
    entries: Mapping[str, Any], folder: Path, scales: Scales, triangle: Any = None
) -> tuple[dict[str, Any], list[str] | None]:
    """Return matrices in SI units, in one order, and the labels of their rows.

    Args:
        entries: by name (mass, stiffness, damping, or what ends in such a name and a number) a
            file, ``{file: NAME, variable: NAME}``, or a matrix.
        triangle: ``mirror`` or ``keep``, as of :func:`read`.
    """
    triangles = ("mirror", "keep")
    if triangle is not None and triangle not in triangles:
        raise ValueError(
            f"triangle = {triangle!r}: {suggestion(str(triangle), triangles)}"
        )
    # one triangle of a gyroscopic matrix has the other sign on the other side
    is_mirrored = triangle == "mirror"
    read_in = {
        key: _matrix(
            key,
            entry,
            folder,
            None
            if is_mirrored and key.startswith("speed_terms: damping")
            else triangle,
        )
        for key, entry in entries.items()
    }
    _refuse_orders(read_in)
    labels = next((each.labels for each in read_in.values() if each.labels), None)
    in_si = {}
    for key, each in read_in.items():
        part_of = next(name for name in MATRIX_KEYS if name in key)
        in_si[key] = _in_order(key, each, labels) * getattr(scales, part_of)
    return in_si, labels


def _matrix(key: str, entry: Any, folder: Path, triangle: str | None) -> Labelled:
    """Return one matrix, both of its triangles, as it is named or given."""
    file, variable = entry, None
    if isinstance(entry, Mapping):
        if set(entry) - {"file", "variable"} or "file" not in entry:
            raise ValueError(f"{key} = {dict(entry)!r}: file and variable are needed")
        file, variable = entry["file"], entry.get("variable")
    elif not isinstance(entry, str | PathLike):
        if np.ndim(entry) == 0 and not sp.issparse(entry):
            _file_name(key, entry)
        return Labelled(real_square(key, entry))
    path = folder / _file_name(key, str(file) if isinstance(file, PathLike) else file)
    meant = {".mas": "mass", ".sti": "stiffness"}.get(plain_name(path).suffix.lower())
    if {key, meant} == {"mass", "stiffness"}:
        raise ValueError(
            f"{key}: {path} is the {meant} that CalculiX writes; exchange the two names"
        )
    one = read_matrix(path, key, variable)
    whole = _completed(real_square(f"{key}: {path}", one.matrix), path, one, triangle)
    return one._replace(matrix=whole)


def _refuse_orders(read_in: Mapping[str, Labelled]) -> None:
    """Refuse rows without labels beside rows whose order is that of nodes."""
    sorted_ones = [key for key, each in read_in.items() if each.by_node]
    bare = [key for key, each in read_in.items() if each.labels is None]
    if sorted_ones and bare:
        raise ValueError(
            f"{sorted_ones[0]} names nodes and directions, {bare[0]} has rows alone, whose order "
            "nobody knows; write both in one format"
        )


def _completed(matrix: Any, path: Path, given: Labelled, triangle: str | None) -> Any:
    """The matrix with both triangles.

    Raises:
        ValueError: only one is there, or only a part of the other, and nobody says what is meant.
    """
    off = sp.coo_array(matrix - sp.diags_array(matrix.diagonal()))
    # assembly leaves round-off where there is nothing, on either side; each row has its own scale,
    # since a penalty or a rotation in other units makes single rows larger by any factor
    sizes, diagonal = abs(off), np.abs(matrix.diagonal())
    largest = np.maximum(
        sizes.max(axis=0).toarray().ravel(), sizes.max(axis=1).toarray().ravel()
    )
    scale = np.maximum(
        *(np.minimum(each[off.row], each[off.col]) for each in (largest, diagonal))
    )
    # entries below this share of the scale of their rows are round-off
    negligible = 1e-13
    significant = np.abs(off.data) > negligible * scale
    pattern = sp.csr_array(
        (np.ones(significant.sum(), int), (off.row[significant], off.col[significant])),
        off.shape,
    )
    single = pattern.nnz - pattern.multiply(pattern.T).nnz
    if not single or triangle == "keep":
        return matrix
    if single == pattern.nnz and (given.halved or triangle == "mirror"):
        return sp.csr_array(matrix + off.T)
    what = (
        "no entry off the diagonal has"
        if single == pattern.nnz
        else f"{single} entries lack"
    )
    raise ValueError(
        f"{path}: {what} one on the other side of the diagonal; if the file is whole, write "
        "`triangle: mirror` where it holds one triangle of a symmetric matrix, `triangle: keep` "
        "where it is meant as it is"
    )


def _in_order(key: str, given: Labelled, labels: list[str] | None) -> Any:
    """The matrix with its rows in the order of these labels."""
    if labels is None:
        return given.matrix
    if len(set(labels)) < len(labels):
        twice = [label for label, count in Counter(labels).items() if count > 1]
        raise ValueError(
            f"{key}: {twice[0]} (node.direction) is there twice, as are {len(twice) - 1} more; "
            "each row needs a name of its own. CalculiX repeats names where it expands shells into "
            "solids: mesh such bodies by C3D8, C3D20 or C3D10 instead"
        )
    if given.labels is None or given.labels == labels:
        size = given.matrix.shape[0]
        if size != len(labels):
            raise ValueError(
                f"{key} has {size} rows, but {len(labels)} have names (node.direction); give "
                "matrices and names that were written together"
            )
        return given.matrix
    place_of = {label: index for index, label in enumerate(labels)}
    if unknown := [label for label in given.labels if label not in place_of]:
        raise ValueError(
            f"{key} has {unknown[0]} (node.direction), which the mass has not; condense what has "
            "no mass in your program, or give it a small one"
        )
    if key in ("mass", "stiffness") and len(given.labels) < len(labels):
        missing = next(label for label in labels if label not in set(given.labels))
        raise ValueError(
            f"{key} lacks {missing} (node.direction), which the mass has; if its file is whole, "
            "add an entry of 0 on the diagonal"
        )
    places = np.array([place_of[label] for label in given.labels])
    entries = given.matrix.tocoo()
    size = len(labels)
    return sp.csr_array(
        (entries.data, (places[entries.row], places[entries.col])), (size, size)
    )


def _column(path: Path) -> np.ndarray:
    """Numbers of a text file, one a line or all in one, as people and programs write them.

    Raises:
        ValueError: a cell that is no number, or whose comma or point may separate thousands.
    """
    table = text_rows(path, lambda _: False)
    if len(table.rows) > 1 and max(len(row.cells) for row in table.rows) > 1:
        raise ValueError("it has several columns")
    cells = []
    for row in table.rows:
        for cell in filter(None, row.cells):
            number = numeral(cell)
            if number is None or number.unit:
                raise ValueError(f"line {row.number}: {brief(cell)} is no number")
            cells.append((f"line {row.number}", number.text))
    between = table.separator if len(table.rows) == 1 else "\n"
    sign = decimal_sign(cells, between)
    return np.array([[float(plain(text, sign)) for _, text in cells]])


def _load(given: Any, folder: Path, scales: Scales) -> Any:
    if given == 0:
        return 0.0
    if not isinstance(given, str):
        raise ValueError(f"load = {brief(given)}: the name of a file, or 0, is needed")  # noqa: TRY004
    path = folder / given
    if not path.is_file():
        raise FileNotFoundError(f"load: no file {path}")
    try:
        if path.suffix == ".mtx":
            entries = read_matrix(path, "load").matrix
            entries = entries.toarray() if sp.issparse(entries) else entries
        else:
            entries = _column(path)
    except ValueError as error:
        text = str(error).removeprefix("load: ").removeprefix(f"{path}: ")
        raise ValueError(
            f"load: {path}: {text}; one real number a line is needed"
        ) from error
    if 1 not in entries.shape or np.iscomplexobj(entries):
        raise ValueError(f"load: {path}: one real number a line is needed")
    return np.asarray(entries, dtype=float).ravel() * scales.force
