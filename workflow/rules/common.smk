"""What rules share: where results go, its slice of the study."""

import os
import sys
import time
from pathlib import Path

from squealpipe.brake.models.refusals import extensions
from squealpipe.parameters import Parameters, parameters_of
from squealpipe.reading import READINGS
from squealpipe.store.rerun.key import STARTED

# Our matrices are small: several threads of linear algebra in a job only wait for one another,
# and for the jobs beside it.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

TARGETS = []
READING = STUDY.reading if STUDY.paper else "along_plus_x"  # a study of one's own: as given
CORRECTED = READINGS[READING].corrected
# what the paper shows is computed in the study's reading, and beside it in the corrected physics
# where that differs: folder of datasets → reading
SHOWN = {"": READING} | ({"corrected/": CORRECTED} if CORRECTED != READING else {})
BEYOND = [*SHOWN][-1]  # folder of the corrected physics

# Jobs publish nothing if the code is edited after the keys of the rules were taken from it.
os.environ[STARTED] = str(time.time())


def data(name):
    """Path of a dataset."""
    return f"{RESULTS}/data/{name}.nc"


def rule_name(*parts):
    """Name of a rule from words and a dataset's place: map, corrected/, linear."""
    return "_".join(Path(*parts).parts)


def from_root(path):
    """A file of the checkout as an input: relative to it, or absolute where the folder is another."""
    whole = ROOT / path
    return str(whole.relative_to(ROOT) if Path.cwd() == ROOT else whole)


def settings(*paths, read_as=None):
    """Canonical slice of the study, the only configuration that a script sees.

    ``read_as`` is the reading whose belt the parameters get: that of the corrected physics, if
    none is given.
    """
    given = STUDY.slice(*paths)
    return given | {"read_as": read_as or CORRECTED} if "parameters" in given else given



def all_cores_for(size, enough):
    """All cores for a job of ``enough`` cells or more, one for a smaller one."""
    return workflow.cores if size >= enough else 1


def cores_for(size, enough):
    """Half of the cores for a job of ``enough`` cells or more, one for a smaller one.

    Two such jobs side by side keep all cores busy where one of them starts, ends or is serial.
    """
    return (all_cores_for(size, enough) + 1) // 2


# Jobs that take all cores go first, when no core has to wait for the others to become free; then
# long ones, so that short ones fill the cores to the end.
FIRST, LONG = 20, 5


_given = parameters_of(STUDY.slice("parameters"))
PAPERS_FRICTION = not extensions(_given)
"""Whether the levels that carry neither dashpots nor other laws of friction can be part of it."""

LEFT_OUT = [] if PAPERS_FRICTION else ["free periodic motions (backbones) in the explorer"]
"""What the report of a study of one's own names as left out."""

if not PAPERS_FRICTION and workflow.is_main_process:
    beyond = [name for name in _given.as_dict() if name not in Parameters(mu=_given.mu).as_dict()]
    left_out = (
        "model A4 and harmonic balance (backbones, orbits, natural frequencies, the explorer), the "
        "model ladder, time stepping, exact boundaries of A3, and the inference from the paper's "
        "statements"
        if STUDY.paper
        else "free periodic motions (backbones) in the explorer"
    )
    print(
        "Left out, for they carry neither dashpots nor any laws but Coulomb's with one μ and a "
        f"linear contact: {left_out}. Without {', '.join(beyond)} they are part of the study.",
        file=sys.stderr,
    )
