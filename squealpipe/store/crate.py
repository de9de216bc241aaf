"""RO-Crate metadata of an archive: what each file is and what made it, for other tools."""

import json
import mimetypes
from pathlib import Path
from typing import Any

from squealpipe.store.netcdf import load
from squealpipe.store.runs import regular_files
from squealpipe.store.whole_files import checksum

METADATA = "ro-crate-metadata.json"
TYPES = {".nc": "application/x-netcdf", ".yaml": "application/yaml", ".lock": "text/plain"}


def describe(folder: Path, name: str, frozen_at: str) -> str:
    """Text of ``ro-crate-metadata.json`` for a folder whose files are all in place."""
    # of the extra [study]; other commands on archives do without
    from rocrate.model.contextentity import ContextEntity
    from rocrate.rocrate import ROCrate

    crate = ROCrate()
    crate.name = f"squealpipe archive {name}"
    crate.description = (
        "Datasets, figures and report of a study of friction-induced vibration with contact loss, "
        "with the configuration and the environment that made them."
    )
    crate.license = "https://spdx.org/licenses/MIT"
    crate.root_dataset["datePublished"] = frozen_at
    environment = json.loads((folder / "environment.json").read_text(encoding="utf-8"))
    instrument = crate.add(
        ContextEntity(
            crate,
            "#squealpipe",
            {
                "@type": "SoftwareApplication",
                "name": "squealpipe",
                "softwareVersion": environment["packages"].get("squealpipe", "unknown"),
                "version": environment["commit"],
                "softwareRequirements": f"Python {environment['python']}",
            },
        )
    )
    files = {
        path.relative_to(folder).as_posix(): crate.add_file(
            path, path.relative_to(folder).as_posix(), properties=file_properties(path)
        )
        for path in regular_files(folder)
    }
    made = [entity for path, entity in files.items() if path.startswith(("data/", "figures/"))]
    given = [entity for path, entity in files.items() if path.startswith("config/")]
    crate.add(
        ContextEntity(
            crate,
            "#run",
            {
                "@type": "CreateAction",
                "name": "snakemake run of the study",
                "endTime": frozen_at,
                "instrument": instrument,
                "object": given,
                "result": made,
            },
        )
    )
    return json.dumps(crate.metadata.generate(), indent=1, sort_keys=True) + "\n"


def file_properties(path: Path) -> dict[str, Any]:
    """Size, checksum and type of a file; of a dataset also title and id."""
    kind = TYPES.get(path.suffix) or mimetypes.guess_type(path.name)[0]
    properties: dict[str, Any] = {
        "contentSize": str(path.stat().st_size),
        "sha256": checksum(path),
        "encodingFormat": kind or "application/octet-stream",
    }
    if path.suffix == ".nc":
        attributes = load(path).attrs
        properties["name"] = str(attributes["title"])
        properties["identifier"] = str(attributes.get("dataset_id", ""))
    return properties
