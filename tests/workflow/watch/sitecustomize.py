"""Files that each script of a workflow really opens in its checkout, one list a script.

A module is opened by its byte code, also where there is none yet.

Python imports this module first in every process in whose path it lies.
"""

import os
import sys
from pathlib import Path

FOLDER = Path(os.environ["SQUEALPIPE_READ"])
ROOT = f"{Path.cwd()}{os.sep}"
SEEN = set()


def watch(event, arguments):
    if event != "open" or not isinstance(arguments[0], str):
        return
    path = os.path.abspath(arguments[0])  # noqa: PTH100 (a Path would open links)
    what = path.removeprefix(ROOT) if path.startswith(ROOT) else ""
    script = getattr(sys, "argv", [""])[0]
    if not what or what in SEEN or ".snakemake/scripts/" not in script:
        return
    SEEN.add(what)
    # appended in one piece, so that forked processes may do so, too
    log = os.open(FOLDER / Path(script).name, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.write(log, f"{what}\n".encode())
    os.close(log)


FOLDER.mkdir(parents=True, exist_ok=True)
sys.addaudithook(watch)
