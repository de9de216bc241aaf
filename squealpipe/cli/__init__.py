"""The command line. Commands import numerics only when they run, so help comes at once."""

import atexit
import contextlib
import gc
import os
import sys
import traceback
from collections.abc import Callable, Sequence
from functools import cache
from importlib import metadata

from cyclopts import App, CycloptsError
from cyclopts.exceptions import UnusedCliTokensError

from squealpipe.cli import benchmark
from squealpipe.cli.archives import deposit, find, list_runs
from squealpipe.cli.arguments import by_name
from squealpipe.cli.assess import assess
from squealpipe.cli.claims import claims
from squealpipe.cli.console import TRACEBACK, ExitCodes, current_session, session
from squealpipe.cli.files import convert, plot, spectrum
from squealpipe.cli.inputs import read_brake
from squealpipe.cli.listen import animate, listen
from squealpipe.cli.maps import basin, disturbance, map_angles, refine
from squealpipe.cli.models import choose, infer, propensity
from squealpipe.cli.motions import backbone, branch, cycle, simulate
from squealpipe.cli.project import init
from squealpipe.cli.project import run as run_study
from squealpipe.cli.structures import ladder, modes, operating, squeal
from squealpipe.cli.study import archive, compare, explain, verify
from squealpipe.cli.sweep import sweep
from squealpipe.study.supervised import StoppedError, stops_raise

HELP = """Friction-induced vibration with contact loss: from one run to the whole study.

Exit codes: 0 done; 1 done, with a negative answer (different, changed, another verdict, not
converged); 2 not done (wrong input, missing file, cannot compare); 130 interrupted.

Every command takes -q (print answers and errors alone) and -v (tracebacks and warnings).
"""
COMMANDS: dict[str, Callable[..., int]] = {
    "assess": assess,
    "simulate": simulate,
    "map": map_angles,
    "backbone": backbone,
    "sweep": sweep,
    "propensity": propensity,
    "cycle": cycle,
    "branch": branch,
    "basin": basin,
    "disturbance": disturbance,
    "modes": modes,
    "squeal": squeal,
    "ladder": ladder,
    "operating": operating,
    "choose": choose,
    "infer": infer,
    "refine": refine,
    "plot": plot,
    "spectrum": spectrum,
    "listen": listen,
    "animate": animate,
    "convert": convert,
    "init": init,
    "run": run_study,
    "explain": explain,
    "claims": claims,
    "archive": archive,
    "verify": verify,
    "compare": compare,
    "list": list_runs,
    "find": find,
    "deposit": deposit,
}


@cache
def application() -> App:
    """The command-line application."""
    app = App(
        name="squealpipe",
        help=HELP,
        help_epilogue="`squealpipe simulate 5pi/6 5pi/6` is a good first command; the whole "
        "study is `squealpipe run`.",
        help_format="markdown",
        version=lambda: metadata.version("squealpipe"),
        config=[read_brake],
        exit_on_error=False,
        print_error=False,
        suppress_keyboard_interrupt=False,
        result_action="return_int_as_exit_code_else_zero",
    )
    for index, (name, command) in enumerate(COMMANDS.items()):
        app.command(command, name=name, sort_key=index, help_epilogue="")
    peers = App(name="benchmark", sort_key=len(COMMANDS), help_epilogue="")
    peers.default(benchmark.run)
    peers.command(benchmark.compare, name="compare")
    peers.command(benchmark.problems, name="problems")
    peers.command(benchmark.score, name="score")
    peers.command(benchmark.results, name="results")
    app.command(peers)
    app.register_install_completion_command()
    return app


def run(arguments: Sequence[str]) -> int:
    """Run a command and return its exit code; errors become one message on standard error."""
    with session(arguments) as left:
        try:
            code = int(application()(list(map(by_name, left))))
            sys.stdout.flush()
            for finishing in current_session.closing:
                finishing()
        except BrokenPipeError:  # the reader, for instance `head`, has enough
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return ExitCodes.done
        except SystemExit as left_by_rich:
            if isinstance(left_by_rich.__context__, BrokenPipeError):
                return ExitCodes.done
            raise
        except KeyboardInterrupt:
            print(f"squealpipe: interrupted; {current_session.remedy}", file=sys.stderr)
            return ExitCodes.interrupted
        except StoppedError as stop:
            print(f"squealpipe: {stop}; {current_session.remedy}", file=sys.stderr)
            return 128 + stop.number
        except Exception as error:  # noqa: BLE001 (one line, not a trace)
            with contextlib.suppress(BrokenPipeError):  # nobody reads it
                if current_session.verbose:
                    traceback.print_exc()
                print(f"squealpipe: {_message(error)}", file=sys.stderr)
            return ExitCodes.not_done
        return code


def _message(error: Exception) -> str:
    """An error in a sentence."""
    if isinstance(error, UnusedCliTokensError):
        return f"too many arguments: {' '.join(error.unused_tokens or [])}"
    # errors whose message says what to do; others are bugs, and show a traceback
    if isinstance(
        error, (CycloptsError, ValueError, OSError, RuntimeError, MemoryError)
    ):
        return str(error)
    what = " ".join(f"{type(error).__name__}: {error}".split())
    return f"unexpected error ({what}); -v or {TRACEBACK}=1 shows where"


def main() -> None:
    """Entry point of the command ``squealpipe``."""
    # a command makes some 400,000 objects, nearly all of them modules that last to its end: looking
    # for cyclic garbage among them takes 0.3 s while they are loaded, and 0.5 s as Python ends
    gc.set_threshold(200_000)
    atexit.register(gc.freeze)
    sys.stdout.reconfigure(errors="replace")  # type: ignore[union-attr]  # no Greek: question marks
    try:
        with stops_raise():  # what is held or half done is put away first
            code = run(sys.argv[1:])
    finally:
        _flush()
    sys.exit(code)


def _flush() -> None:
    """Let Python's own last flush succeed: where a reader is gone its exit code would be 120."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
