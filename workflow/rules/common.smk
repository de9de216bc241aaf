"""What every rule needs: where results go, which sources a script uses, its slice of the study."""

import os
from pathlib import Path

from squealpipe.sources import closure

# Our matrices are small: several threads of linear algebra in a job only wait for one another,
# and for the jobs beside it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

ROOT = Path(workflow.basedir)
TARGETS = []
FIGURES = {}


def data(name):
    """Path of a dataset."""
    return f"{RESULTS}/data/{name}.nc"


def figure(name):
    """PNG and SVG of a figure; the figure becomes a target and part of the report."""
    paths = [f"{RESULTS}/figures/{name}.{suffix}" for suffix in ("png", "svg")]
    FIGURES[name] = paths
    TARGETS.extend(paths)
    return paths


def sources(script):
    """The script and the package modules whose edit makes its result stale.

    As inputs they are judged by checksum; Snakemake's own trigger for scripts goes by date and
    would take a fresh checkout for an edit (so the profiles leave it out).
    """
    path = ROOT / f"workflow/scripts/{script}.py"
    return [str(found.relative_to(ROOT)) for found in [path, *closure(path)]]


def part(*paths):
    """Canonical slice of the study, the only configuration that a script sees."""
    return STUDY.slice(*paths)


def cores_for(size, enough):
    """All cores for a job of ``enough`` cells or more; smaller jobs run beside one another."""
    return workflow.cores if size >= enough else 1
