"""Snakemake as a child that never outlives the command that started it."""

import json
import os
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

STOPS = [
    getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)
]
PATIENCE = 20.0
"""Time that interrupted jobs have to tidy up before they are killed, s."""
HOLDERS = Path(".snakemake/squealpipe")
LOCKS = Path(".snakemake/locks")


class StoppedError(BaseException):
    """The command was asked to end by a signal."""

    def __init__(self, number: int) -> None:
        super().__init__(f"stopped by {signal.Signals(number).name}")
        self.number = number


def run_to_its_end(command: Sequence[str], env: Mapping[str, str]) -> int:
    """Run Snakemake; it and its jobs end when this process is interrupted, stopped or killed.

    Returns:
        Its exit code.

    Raises:
        KeyboardInterrupt, StoppedError: a signal ended it; by then no process of it is left.
    """
    with (
        stops_raise(),
        _holder(),
        subprocess.Popen(command, env=dict(env), start_new_session=True) as made,
    ):
        done, code = _guard(made.pid), 1
        try:
            code = made.wait()
        finally:
            if code:  # its jobs may live on, its lock stay
                end_group(made.pid)
                made.wait()
                remove_stale_lock()
            os.write(done, b"done")
            os.close(done)
    return code


def remove_stale_lock() -> str:
    """Remove Snakemake's lock of a run that is dead; what to say about it, empty: nothing.

    A lock stays where a Snakemake works in the folder, or may do so on another machine.
    """
    holders = list(HOLDERS.glob("*.json"))
    if not _is_locked() or not holders:
        return ""
    stated = _stated(holders)
    elsewhere = [each for each in stated if each["host"] != socket.gethostname()]
    if not stated or elsewhere or _works_here():
        return ""
    shutil.rmtree(LOCKS)
    for path in holders:
        path.unlink(missing_ok=True)
    numbers = ", ".join(str(each["pid"]) for each in stated)
    return f"removed the lock of a run that was killed (process {numbers})"


def standing_lock() -> str:
    """Return the remedy for a lock that stays, for its holder may live; empty text if there is
    none.
    """
    if not _is_locked():
        return ""
    stated = _stated(HOLDERS.glob("*.json"))
    who = ", ".join(f"process {each['pid']} on {each['host']}" for each in stated)
    return (
        f"another run holds the lock of this folder ({who or 'not started by squealpipe'}); "
        f"wait for it or, if it is dead, delete the folder {LOCKS.resolve()}"
    )


def _is_locked() -> bool:
    return LOCKS.is_dir() and any(LOCKS.iterdir())


def _stated(holders: Iterable[Path]) -> list[dict[str, Any]]:
    """Read from files who holds the lock; a file that has gone or was cut off says nothing."""
    stated = []
    for path in holders:
        with suppress(FileNotFoundError, json.JSONDecodeError):
            stated.append(json.loads(path.read_text(encoding="utf-8")))
    return stated


def _works_here() -> bool:
    """Return whether a Snakemake of this machine works in this folder."""
    import psutil

    for process in psutil.process_iter(["cmdline", "cwd"]):
        about = process.info
        if about["cwd"] and Path(about["cwd"]) == Path.cwd():
            words = about["cmdline"] or []
            if any(Path(word).name == "snakemake" for word in words):
                return True
    return False


def end_group(number: int) -> None:
    """Interrupt all processes of a group, and kill what is left after a while."""
    until = time.monotonic() + PATIENCE
    with suppress(ProcessLookupError):
        os.killpg(number, signal.SIGINT)
        while time.monotonic() < until and not _only_zombies(number):
            time.sleep(0.1)
        os.killpg(number, signal.SIGKILL)


def _only_zombies(group: int) -> bool:
    """Return whether all processes of a group have ended; one may not have been waited for."""
    import psutil

    for process in psutil.process_iter(["status"]):
        with suppress(OSError):
            if (
                os.getpgid(process.pid) == group
                and process.info["status"] != psutil.STATUS_ZOMBIE
            ):
                return False
    return True


def _guard(group: int) -> int:
    """Start a process that ends a group when this one dies; an end of a pipe calls it off."""
    reader, writer = os.pipe()
    if os.fork():
        os.close(reader)
        os.set_inheritable(writer, False)
        return writer
    try:  # in the guard: nothing but system calls, files and psutil
        os.close(writer)
        os.setsid()
        for number in (signal.SIGINT, *STOPS):
            signal.signal(number, signal.SIG_IGN)
        if not os.read(reader, 4):
            end_group(group)
            remove_stale_lock()
    finally:
        os._exit(0)


@contextmanager
def stops_raise() -> Iterator[None]:
    """Have a signal to stop raise :class:`StoppedError`, unless it is ignored (nohup)."""

    def stop(number: int, _: object) -> None:
        raise StoppedError(number)

    heeded = [
        stop for stop in STOPS if signal.getsignal(stop) != signal.SIG_IGN
    ]  # nohup
    before = {number: signal.signal(number, stop) for number in heeded}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _holder() -> Iterator[None]:
    """State beside Snakemake's lock who holds it, so that a later run sees whether it lives."""
    path = HOLDERS / f"{os.getpid()}.json"
    about = {"pid": os.getpid(), "host": socket.gethostname()}
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(about), encoding="utf-8")
    except OSError as error:
        with suppress(OSError):
            path.unlink(missing_ok=True)
        raise OSError(
            f"cannot write {path.resolve()}: {error.strerror}; free space or fix permissions, "
            "then run the same command again, or run it in another folder"
        ) from error
    try:
        yield
    finally:
        path.unlink(missing_ok=True)
