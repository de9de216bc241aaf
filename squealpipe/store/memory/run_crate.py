"""Workflow Run RO-Crate of a deposit: which run made each dataset, from what, with which code.

Profiles: https://w3id.org/ro/wfrun/workflow and https://w3id.org/workflowhub/workflow-ro-crate.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from rocrate.model.contextentity import ContextEntity
from rocrate.rocrate import ROCrate

from squealpipe.store.crate import file_properties
from squealpipe.store.netcdf import attributes
from squealpipe.store.runs import regular_files

PROFILES = (
    "https://w3id.org/ro/wfrun/process/0.5",
    "https://w3id.org/ro/wfrun/workflow/0.5",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0",
)
WORKFLOW = "code/Snakefile"
CONFIGURATION = "run/config/resolved.yaml"


def describe_deposit(folder: Path, metadata: dict[str, Any]) -> str:
    """Text of ``ro-crate-metadata.json`` for a bundle whose other files are in place.

    Args:
        folder: of the bundle, with the archive in ``run/`` and the code in ``code/``.
        metadata: title, description, licence, creators and date, as Zenodo gets them.
    """
    crate = ROCrate()
    root = crate.root_dataset
    crate.name, crate.description = metadata["title"], metadata["description"]
    crate.license = f"https://spdx.org/licenses/{metadata['license']}"
    root["datePublished"] = metadata["publication_date"]
    root["keywords"] = metadata["keywords"]
    root["conformsTo"] = [_entity(crate, profile, "CreativeWork") for profile in PROFILES]
    root["author"] = [
        _entity(crate, f"#author-{place}", "Organization", name=person["name"])
        for place, person in enumerate(metadata["creators"])
    ]
    files: dict[str, Any] = {}
    for path in regular_files(folder):
        name = path.relative_to(folder).as_posix()
        if name == WORKFLOW:
            files[name] = crate.add_workflow(
                path, name, main=True, lang="snakemake", properties=file_properties(path)
            )
        else:
            files[name] = crate.add_file(path, name, properties=file_properties(path))
    hidden = folder / ".zenodo.json"
    files[hidden.name] = crate.add_file(hidden, hidden.name, properties=file_properties(hidden))
    engine = _entity(crate, "#snakemake", "SoftwareApplication", name="Snakemake")
    files[WORKFLOW]["softwareRequirements"] = engine
    datasets = {name: files[name] for name in files if name.startswith("run/data/")}
    drawn = [files[name] for name in files if name.startswith(("run/figures/", "run/report/"))]
    steps = [_dataset_run(crate, folder / name, datasets[name], datasets) for name in datasets]
    whole = _entity(
        crate,
        "#study",
        "CreateAction",
        name=f"snakemake run of {metadata['title']}",
        endTime=metadata["publication_date"],
        instrument=files[WORKFLOW],
        object=[files[CONFIGURATION]] if CONFIGURATION in files else [],
        result=[*datasets.values(), *drawn],
    )
    root["mentions"] = [whole, *steps]
    return json.dumps(crate.metadata.generate(), indent=1, sort_keys=True) + "\n"


def _dataset_run(
    crate: ROCrate, path: Path, entity: Any, datasets: dict[str, Any]
) -> ContextEntity:
    """The run that made one dataset, as its own attributes tell it."""
    attrs = attributes(path)
    inputs = [f"run/data/{name.partition('/data/')[2]}" for name in json.loads(attrs["inputs"])]
    key = entity.id.removeprefix("run/data/").removesuffix(".nc")
    package = f"#squealpipe-{attrs.get('commit', 'unknown')}"
    instrument = crate.get(package) or _entity(
        crate,
        package,
        "SoftwareApplication",
        name="squealpipe",
        softwareVersion=str(attrs.get("package_version", "")),
        version=str(attrs.get("commit", "")),
        softwareRequirements=str(attrs.get("libraries", "")),
    )
    configuration = _entity(
        crate,
        f"#configuration-{attrs.get('config_hash', key)}",
        "PropertyValue",
        name="configuration",
        value=str(attrs.get("config", "")),
    )
    return _entity(
        crate,
        f"#run-{key}",
        "CreateAction",
        name=f"computation of {key}",
        endTime=str(attrs.get("history", ""))[:20],
        instrument=instrument,
        object=[configuration, *(datasets[name] for name in inputs if name in datasets)],
        result=[entity],
        description=f"{attrs.get('platform', '')}; {attrs.get('wall_time_s', 0):.3g} s",
    )


def _entity(crate: ROCrate, key: str, kind: str, /, **properties: Any) -> ContextEntity:
    return crate.add(ContextEntity(crate, key, {"@type": kind, **properties}))
