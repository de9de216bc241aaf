"""Output of every command: its exit codes, its verbosity, and its progress."""

import os
import re
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class ExitCodes:
    """Exit codes of all commands, as docs/guide.md lists them."""

    done: int = 0
    """The command did what was asked."""
    answer_is_no: int = 1
    """Done, with a negative answer: different, changed, another verdict, not converged."""
    not_done: int = 2
    """The command could not do it: wrong input, a missing file."""
    interrupted: int = 130
    """Stopped by Ctrl-C; shells use the same code, 128 plus the number of the signal."""


TRACEBACK = "SQUEALPIPE_TRACEBACK"
"""Environment variable that asks for tracebacks, as -v does."""


NOTHING_KEPT = "nothing was kept"


@dataclass
class _Session:
    """One command's settings.

    Attributes:
        quiet: print answers and errors alone.
        verbose: print tracebacks and warnings.
        typed: physical parameters that stood on the command line.
        held: what ends with the command: names that it keeps to write to.
        remedy: what to do after an interruption.
        closing: what is left to do when the answer is printed, as to draw its picture.
    """

    quiet: bool = False
    verbose: bool = False
    typed: set[str] = field(default_factory=set)
    held: ExitStack = field(default_factory=ExitStack)
    remedy: str = NOTHING_KEPT
    closing: list[Callable[[], None]] = field(default_factory=list)


current_session = _Session()


@contextmanager
def session(arguments: Sequence[str]) -> Iterator[list[str]]:
    """Apply -q and -v, which every command takes, and give the other arguments."""
    arguments = _options_first(arguments)
    end = arguments.index("--") if "--" in arguments else len(arguments)
    meanings = {
        "-q": "quiet",
        "--quiet": "quiet",
        "-v": "verbose",
        "--verbose": "verbose",
    }
    switches = {
        meanings[argument] for argument in arguments[:end] if argument in meanings
    }
    kept = [argument for argument in arguments[:end] if argument not in meanings]
    current_session.quiet = "quiet" in switches
    current_session.verbose = "verbose" in switches or os.environ.get(
        TRACEBACK, "0"
    ) not in {"", "0"}
    current_session.typed, current_session.remedy, current_session.closing = (
        set(),
        NOTHING_KEPT,
        [],
    )
    with warnings.catch_warnings(), ExitStack() as current_session.held:
        if not current_session.verbose and not sys.warnoptions:
            warnings.simplefilter("ignore")
        yield [*map(_from_home, kept), *arguments[end:]]


def _options_first(arguments: Sequence[str]) -> list[str]:
    """Options that follow negative angles, ``-- -0.2pi 0.3pi --t-end 2``, before the ``--``."""
    words = list(arguments)
    if "--" not in words:
        return words
    end = words.index("--")
    rest = words[end + 1 :]
    first = next(
        (at for at, word in enumerate(rest) if re.match(r"--?[A-Za-z]", word)), 0
    )
    return [*words[:end], *rest[first:], "--", *rest[:first]] if first else words


def _from_home(argument: str) -> str:
    """A path that begins with ``~``, which shells leave as it is in ``--output=~/run.nc``."""
    flag, equals, value = argument.rpartition("=")
    if not value.startswith("~") or (equals and not flag.startswith("-")):
        return argument
    return f"{flag}{equals}{os.path.expanduser(value)}"  # noqa: PTH111 (keeps what is no path)


def say(line: str) -> None:
    """Print what a user may want to know while a command works; nothing under -q."""
    if not current_session.quiet:
        print(line)


def answer(*lines: str) -> None:
    """Print what was asked for, under -q too."""
    print(*lines, sep="\n")


@contextmanager
def working(what: str) -> Iterator[None]:
    """Show elapsed and remaining time: on a terminal always, in a log by a line now and then."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TimeElapsedColumn

    from squealpipe.study.progress.log import Log
    from squealpipe.systems.progress import shown

    console = Console(stderr=True)
    if not console.is_terminal:
        with nullcontext() if current_session.quiet else Log(what).printed():
            yield
        return
    columns: tuple[Any, ...] = (
        SpinnerColumn(),
        *Progress.get_default_columns(),
        "after",
        TimeElapsedColumn(),
    )
    with Progress(
        *columns, console=console, transient=True, disable=current_session.quiet
    ) as progress:
        task = progress.add_task(what, total=None)
        begun = False

        def say_above(line: str) -> None:
            if not current_session.quiet:
                progress.console.print(line, highlight=False, markup=False)

        def tell(share: float) -> None:
            nonlocal begun
            # the speed is that of what comes after: a resumed sweep begins at a share
            show: Callable[..., None] = progress.update if begun else progress.reset
            show(task, completed=share, total=1.0)
            begun = True

        def name(stage: str) -> None:
            nonlocal begun
            begun = False
            progress.update(task, description=f"{what}: {stage}" if stage else what)

        with shown(tell, say_above, name):
            yield


@contextmanager
def keeping_on_interrupt() -> Iterator[Callable[[], bool]]:
    """Let a first Ctrl-C end the work with its results so far; yield a test whether it came."""
    from squealpipe.systems.progress import ask_to_stop, stop_is_asked

    def stop(*_: object) -> None:
        if stop_is_asked():
            raise KeyboardInterrupt
        ask_to_stop()
        print(
            "squealpipe: stopping soon and keeping the results so far; press Ctrl-C again to stop "
            "at once",
            file=sys.stderr,
        )

    if (
        threading.current_thread() is not threading.main_thread()
    ):  # no signals elsewhere
        yield lambda: False
        return
    before = signal.signal(signal.SIGINT, stop)
    try:
        yield stop_is_asked
    finally:
        signal.signal(signal.SIGINT, before)
        ask_to_stop(stops=False)
