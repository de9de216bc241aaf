"""What every rule needs: where results go, which sources a script uses, its slice of the study."""

from pathlib import Path

from squealpipe.sources import closure

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
    """Package modules whose edit makes the script's result stale."""
    found = closure(ROOT / f"workflow/scripts/{script}.py")
    return [str(path.relative_to(ROOT)) for path in found]


def part(*paths):
    """Canonical slice of the study, the only configuration that a script sees."""
    return STUDY.slice(*paths)
