"""RO-Crate metadata of an archive: what each file is and what made it, for other tools."""

import json
import mimetypes
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from squealpipe.store.sealed import attributes


def describe(
    folder: Path,
    name: str,
    frozen_at: str,
    environment: Mapping[str, Any],
    sums: Mapping[str, Any],
) -> str:
    """Text of ``ro-crate-metadata.json``.

    Args:
        sums: path in the folder → its checksum and size.
    """
    # of the extra [study]; other commands on archives do without
    from rocrate.model.softwareapplication import SoftwareApplication
    from rocrate.rocrate import ROCrate

    crate = ROCrate()
    crate.name = f"squealpipe archive {name}"
    crate.description = (
        "Datasets, figures and report of a study of friction-induced vibration with contact loss, "
        "with the configuration and the environment that made them."
    )
    crate.license = "https://spdx.org/licenses/MIT"
    crate.root_dataset["datePublished"] = frozen_at
    software = {
        "name": "squealpipe",
        "softwareVersion": environment["packages"].get("squealpipe", "unknown"),
        "version": environment["commit"],
        "softwareRequirements": f"Python {environment['python']}",
    }
    files = {}
    for path, listed in sums.items():
        kind = {".nc": "application/x-netcdf", ".yaml": "application/yaml"}.get(
            Path(path).suffix
        ) or mimetypes.guess_type(path)[0]
        about = {"contentSize": str(listed["bytes"]), "sha256": listed["sha256"]}
        about["encodingFormat"] = kind or "application/octet-stream"
        if path.endswith(".nc"):
            stated = attributes(folder / path)
            about |= {
                "name": stated["title"],
                "identifier": stated.get("dataset_id", ""),
            }
        files[path] = crate.add_file(folder / path, path, properties=about)
    crate.add_action(
        crate.add(SoftwareApplication(crate, "#squealpipe", software)),
        "#run",
        object=[files[path] for path in files if path.startswith("config/")],
        result=[
            files[path] for path in files if path.startswith(("data/", "figures/"))
        ],
        properties={"name": "snakemake run of the study", "endTime": frozen_at},
    )
    return json.dumps(crate.metadata.generate(), indent=1, sort_keys=True) + "\n"
