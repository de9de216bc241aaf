"""A bundle of one archived run that another person can use alone, with its metadata, checked.

The metadata of all formats come from ``CITATION.cff`` and the archive's manifest.
"""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import zipfile
from pathlib import Path
from typing import Any, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from rocrate.rocrate import ROCrate

from squealpipe.store.archive import verify
from squealpipe.store.memory.run_crate import describe_deposit
from squealpipe.store.netcdf import StoreError
from squealpipe.store.runs import locate, read_manifest, regular_files
from squealpipe.store.whole_files import checksum

CITATION, ZENODO, DATACITE = "CITATION.cff", ".zenodo.json", "datacite.json"
CRATE = "ro-crate-metadata.json"
RUN, CODE = "run", "code"
SOURCES = ("squealpipe", "workflow", "Snakefile", "pyproject.toml", "requirements.lock", "LICENSE")
FIRST = (1980, 1, 1, 0, 0, 0)
"""Date of every file in the bundle, so equal contents give an equal bundle."""


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", populate_by_name=True)


class Creator(_Strict):
    """One author of the deposit."""

    name: str = Field(min_length=1)


class ZenodoMetadata(_Strict):
    """What Zenodo needs of a dataset."""

    upload_type: Literal["dataset"]
    title: str = Field(min_length=1)
    creators: list[Creator] = Field(min_length=1)
    description: str = Field(min_length=20)
    license: str = Field(min_length=1)
    access_right: Literal["open"]
    keywords: list[str]
    version: str = Field(min_length=1)
    publication_date: str = Field(pattern=r"^\d{4}-\d{2}-\d{2}$")


class _Title(_Strict):
    title: str = Field(min_length=1)


class _ResourceType(_Strict):
    general: Literal["Dataset"] = Field(alias="resourceTypeGeneral")
    kind: str = Field(alias="resourceType")


class _Description(_Strict):
    text: str = Field(alias="description", min_length=20)
    kind: Literal["Abstract"] = Field(alias="descriptionType")


class _Rights(_Strict):
    identifier: str = Field(alias="rightsIdentifier", min_length=1)


class _Subject(_Strict):
    subject: str


class DataCiteMetadata(_Strict):
    """The mandatory properties of DataCite 4, but the DOI, which the archive service gives."""

    titles: list[_Title] = Field(min_length=1)
    creators: list[Creator] = Field(min_length=1)
    publisher: str = Field(min_length=1)
    year: int = Field(alias="publicationYear", ge=2021)
    types: _ResourceType
    descriptions: list[_Description]
    rights: list[_Rights] = Field(alias="rightsList", min_length=1)
    subjects: list[_Subject]
    version: str
    schema_version: Literal["http://datacite.org/schema/kernel-4"] = Field(alias="schemaVersion")


def bundle(
    name: str | os.PathLike[str],
    *,
    output: str | os.PathLike[str] | None = None,
    root: str | os.PathLike[str] = ".",
) -> tuple[Path, dict[str, Any]]:
    """Write ``results/deposit/NAME.zip``, checked; it appears whole or not at all.

    Args:
        name: of an archive.
        output: the file to write.
        root: the checkout.

    Returns:
        The bundle and Zenodo's metadata of it.

    Raises:
        FileNotFoundError: there is no such archive, or no ``CITATION.cff``.
        ValueError: the archive is not intact, or the bundle would not be valid; all faults.
    """
    base, archive = Path(root), locate(name, root)
    found = verify(archive)
    if not found.intact:
        raise ValueError("\n".join(found.lines()))
    target = Path(output) if output else base / f"results/deposit/{archive.name}.zip"
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".deposit.") as draft:
        folder = Path(draft) / archive.name
        metadata = _fill(folder, archive, base)
        faults = check(folder)
        if faults:
            raise ValueError(f"the bundle of {archive} is not valid:\n" + "\n".join(faults))
        packed = Path(draft) / "bundle.zip"
        _pack(folder, packed)
        try:
            packed.replace(target)
        except OSError as error:
            raise StoreError(f"cannot write {target}: {error.strerror}") from error
    return target, metadata


def check(folder: Path) -> list[str]:
    """What is wrong with an unpacked bundle, in metadata, provenance or checksums."""
    faults: list[str] = []
    for name, model in ((ZENODO, ZenodoMetadata), (DATACITE, DataCiteMetadata)):
        try:
            model.model_validate_json((folder / name).read_text(encoding="utf-8"))
        except (OSError, ValidationError) as error:
            faults.append(f"{name}: {error}")
    try:
        citation = yaml.safe_load((folder / CITATION).read_text(encoding="utf-8"))
        needed = {"cff-version", "message", "title", "authors"}
        faults += [f"{CITATION}: {key} is missing" for key in sorted(needed - set(citation))]
    except (OSError, ValueError, TypeError, yaml.YAMLError) as error:
        faults.append(f"{CITATION}: {error}")
    faults += [] if faults else _crate_faults(folder)
    if (folder / RUN).is_dir():
        found = verify(folder / RUN)
        faults += [] if found.intact else found.lines()
    else:
        faults.append(f"{RUN}: the archive is missing")
    return faults


def _fill(folder: Path, archive: Path, base: Path) -> dict[str, Any]:
    shutil.copytree(archive, folder / RUN)
    for name in SOURCES:
        source, copy = base / name, folder / CODE / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        if source.is_dir():
            shutil.copytree(source, copy, ignore=shutil.ignore_patterns("__pycache__", ".*"))
        elif source.is_file():
            shutil.copyfile(source, copy)
    citation_file = base / CITATION
    if not citation_file.is_file():
        raise FileNotFoundError(f"{citation_file} is missing: authors and licence come from it")
    shutil.copyfile(citation_file, folder / CITATION)
    citation = yaml.safe_load(citation_file.read_text(encoding="utf-8"))
    manifest = read_manifest(archive)
    metadata = _zenodo(citation, manifest)
    for name, content in ((ZENODO, metadata), (DATACITE, _datacite(metadata))):
        text = json.dumps(content, indent=1, ensure_ascii=False) + "\n"
        (folder / name).write_text(text, encoding="utf-8")
    (folder / "README.md").write_text(_readme(metadata, archive.name), encoding="utf-8")
    (folder / CRATE).write_text(describe_deposit(folder, metadata), encoding="utf-8")
    return metadata


def _zenodo(citation: dict[str, Any], manifest: dict[str, Any]) -> dict[str, Any]:
    name, frozen = str(manifest.get("name", "")), str(manifest.get("frozen", ""))
    people = [
        author.get("name") or f"{author.get('family-names')}, {author.get('given-names')}"
        for author in citation.get("authors", [])
    ]
    return {
        "upload_type": "dataset",
        "title": f"{citation['title']}: run {name}",
        "creators": [{"name": str(person)} for person in people],
        "description": "Datasets, figures, report, configuration, environment and code of the run "
        f"{name!r}, frozen {frozen[:10]} at commit {manifest.get('commit', 'unknown')}, with the "
        "provenance of every dataset as a Workflow Run RO-Crate.",
        "license": str(citation.get("license", "")),
        "access_right": "open",
        "keywords": list(map(str, citation.get("keywords", []))),
        "version": str(citation.get("version", "")),
        "publication_date": frozen[:10],
    }


def _datacite(metadata: dict[str, Any]) -> dict[str, Any]:
    return {
        "titles": [{"title": metadata["title"]}],
        "creators": metadata["creators"],
        "publisher": "Zenodo",
        "publicationYear": int(metadata["publication_date"][:4] or 0),
        "types": {"resourceTypeGeneral": "Dataset", "resourceType": "simulation results"},
        "descriptions": [{"description": metadata["description"], "descriptionType": "Abstract"}],
        "rightsList": [{"rightsIdentifier": metadata["license"]}],
        "subjects": [{"subject": word} for word in metadata["keywords"]],
        "version": metadata["version"],
        "schemaVersion": "http://datacite.org/schema/kernel-4",
    }


def _readme(metadata: dict[str, Any], name: str) -> str:
    return (
        f"# {metadata['title']}\n\n{metadata['description']}\n\n"
        f"- `{RUN}/data`: NetCDF-4, CF conventions, one file a dataset; `{RUN}/figures`, "
        f"`{RUN}/report`; `{RUN}/config/resolved.yaml` is the whole configuration.\n"
        f"- `{RUN}/manifest.json`: SHA-256 of every file.\n"
        f"- `{CODE}`: workflow and package; `{CODE}/requirements.lock` pins what it needs.\n"
        f"- `{CRATE}`: what made what.\n\n"
        f"To compute it again: install `{CODE}` with its lock and run "
        f"`snakemake --configfile ../{RUN}/config/resolved.yaml` in it; "
        f"`squealpipe compare ../{RUN} results` tells whether you find the same ({name}).\n"
    )


def _crate_faults(folder: Path) -> list[str]:
    """Files that the crate lists are there and are what it says; every dataset has its run."""
    crate = ROCrate(folder)
    faults = []
    made = {
        item.id
        for action in crate.contextual_entities
        if action.type == "CreateAction"
        for item in action.get("result", [])
    }
    for path in regular_files(folder):
        name = path.relative_to(folder).as_posix()
        entity = crate.get(name)
        if name in {CRATE, "README.md"}:
            continue
        if entity is None:
            faults.append(f"{CRATE}: {name} is not described")
        elif entity.get("sha256") != checksum(path):
            faults.append(f"{CRATE}: the checksum of {name} is another")
        if name.startswith(f"{RUN}/data/") and name not in made:
            faults.append(f"{CRATE}: no run made {name}")
    if crate.mainEntity is None:
        faults.append(f"{CRATE}: no workflow is named")
    return faults


def _pack(folder: Path, target: Path) -> None:
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as file:
        for path in sorted(item for item in folder.rglob("*") if item.is_file()):
            name = (Path(folder.name) / path.relative_to(folder)).as_posix()
            entry = zipfile.ZipInfo(name, date_time=FIRST)
            entry.external_attr = 0o644 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            file.writestr(entry, path.read_bytes())
