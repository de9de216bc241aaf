"""A bundle of one archived run that another person can use alone: the archive and its code."""

import os
import zipfile
from pathlib import Path

from squealpipe.store.runs import locate, verify
from squealpipe.store.whole_files import whole_file

README = """\
# An archived run of squealpipe

- `run/data`: NetCDF-4, CF conventions, one file a dataset; `run/figures`, `run/report`;
  `run/config/resolved.yaml` is the whole configuration.
- `run/manifest.json`: SHA-256 of every file; `run/ro-crate-metadata.json`: what made what.
- `code`: workflow and package; `code/requirements.lock` pins what it needs.

To compute it again: install `code` with its lock and run
`snakemake --configfile ../run/config/resolved.yaml` in it; `squealpipe compare ../run results` then
states whether you find the same.
"""


def bundle(
    name: str | os.PathLike[str], *, output: str | os.PathLike[str] | None = None
) -> Path:
    """Write ``results/deposit/NAME.zip``; it appears whole or not at all."""
    archive, citation = locate(name).resolve(), Path("CITATION.cff")
    faults = verify(archive)
    if not faults.intact:
        raise ValueError("\n".join(faults.lines()))
    if not citation.is_file():
        raise FileNotFoundError(f"{citation} is missing: it names authors and licence")
    target = Path(output) if output else Path(f"results/deposit/{archive.name}.zip")
    contents: dict[str, bytes | Path]
    contents = {"README.md": README.encode(), citation.name: citation.read_bytes()}
    contents |= {
        f"run/{path.relative_to(archive)}": path for path in archive.rglob("*")
    }
    contents |= {
        f"code/{path}": path
        for source in map(
            Path,
            (
                "squealpipe",
                "workflow",
                "Snakefile",
                "pyproject.toml",
                "requirements.lock",
                "LICENSE",
                "README.md",
            ),
        )
        for path in [source, *source.rglob("*")]
        if "__pycache__" not in path.parts
    }
    with (
        whole_file(target) as draft,
        zipfile.ZipFile(draft, "w", zipfile.ZIP_DEFLATED) as file,
    ):
        for place, content in sorted(contents.items()):
            if isinstance(content, bytes) or content.is_file():
                # entries without a date: equal archives give equal bundles
                entry = zipfile.ZipInfo(f"{archive.name}/{place}")
                data = content if isinstance(content, bytes) else content.read_bytes()
                file.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return target
