"""Many dry runs of one workflow: Snakemake is imported once, each dry run is a fork.

Reads a JSON list of argument lists from standard input, prints a JSON list of [code, output].
"""

import json
import os
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import smart_open  # noqa: F401  imported before the forks, as are the next, so that none has to
import snakemake.cli

import squealpipe.config.settings
import squealpipe.study.claims.statements
import squealpipe.study.report.lineage  # noqa: F401
from squealpipe.rerun.sources import closure, read_source


def dry_run(arguments):
    with tempfile.NamedTemporaryFile() as file:
        child = os.fork()
        if child == 0:
            for stream in (1, 2):
                os.dup2(file.fileno(), stream)
            try:
                snakemake.cli.main(["--dry-run", "--nocolor", *arguments])
            except SystemExit as end:
                os._exit(int(end.code or 0))
            finally:
                os._exit(3)
        _, status = os.waitpid(child, 0)
        return os.waitstatus_to_exitcode(status), Path(file.name).read_text()


if __name__ == "__main__":
    snakemake.cli.get_argument_parser()  # finds the plugins
    for script in Path("workflow/scripts").glob("*/*.py"):
        for path in [script.resolve(), *closure(script.resolve())]:
            read_source(path)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        json.dump(list(pool.map(dry_run, json.load(sys.stdin))), sys.stdout)
