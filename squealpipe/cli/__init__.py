"""The command line. Commands import numerics only when they run, so help comes at once."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence

from cyclopts import App, CycloptsError

from squealpipe.cli.backbone import backbone
from squealpipe.cli.exit_codes import INTERRUPTED, NOT_DONE
from squealpipe.cli.maps import map_angles
from squealpipe.cli.simulate import simulate
from squealpipe.cli.study import archive, claims, compare, explain, verify
from squealpipe.cli.sweep import sweep

HELP = """Friction-induced vibration with contact loss: from one run to the whole study.

Exit codes: 0 done; 1 done, and the answer is no (different, changed, another verdict, not
converged); 2 not done (wrong input, missing file, cannot compare); 130 interrupted.
"""
COMMANDS: dict[str, Callable[..., int]] = {
    "simulate": simulate,
    "map": map_angles,
    "backbone": backbone,
    "sweep": sweep,
    "explain": explain,
    "claims": claims,
    "archive": archive,
    "verify": verify,
    "compare": compare,
}


def application() -> App:
    """The command-line application."""
    app = App(
        name="squealpipe",
        help=HELP,
        help_epilogue="`squealpipe simulate 5pi/6 5pi/6` is a good first command; the whole "
        "study is `snakemake`.",
        help_format="markdown",
        version=_version,
        exit_on_error=False,
        print_error=False,
        result_action="return_int_as_exit_code_else_zero",
    )
    for place, (name, command) in enumerate(COMMANDS.items()):
        app.command(command, name=name, sort_key=place, help_epilogue="")
    return app


def _version() -> str:
    from squealpipe import __version__

    return str(__version__)


def run(arguments: Sequence[str]) -> int:
    """Run a command and return its exit code; errors become one message on standard error."""
    try:
        return int(application()(list(arguments)))
    except (CycloptsError, ValueError, OSError, RuntimeError) as error:
        print(f"squealpipe: {error}", file=sys.stderr)
        return NOT_DONE
    except KeyboardInterrupt:
        print("squealpipe: interrupted; a sweep run again goes on where it was", file=sys.stderr)
        return INTERRUPTED


def main() -> None:
    """Entry point of the command ``squealpipe``."""
    sys.exit(run(sys.argv[1:]))
