"""Ctrl-C: a command stops within two seconds, whatever compiled code it is in."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import socket
import sys
import threading
from collections.abc import Iterator

from squealpipe.cli.console import SESSION
from squealpipe.cli.exit_codes import INTERRUPTED


def interrupted() -> str:
    """What is said after Ctrl-C."""
    return f"squealpipe: interrupted; {SESSION.advice()}"


@contextlib.contextmanager
def watched() -> Iterator[None]:
    """End the process if an interrupt has not reached Python's own handler in time.

    Python raises ``KeyboardInterrupt`` between two of its own instructions, so it waits for
    compiled code to return. A thread that the signal wakes at once does not.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    reader, writer = socket.socketpair()
    writer.setblocking(False)
    stopped = threading.Event()
    before = signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    watch = threading.Thread(target=_watch, args=(reader, stopped), daemon=True)
    watch.start()
    try:
        yield
    finally:
        stopped.set()
        signal.set_wakeup_fd(before)
        writer.close()
        watch.join()
        reader.close()


def _watch(reader: socket.socket, stopped: threading.Event) -> None:
    while received := reader.recv(16):
        SESSION.interrupted |= signal.SIGINT in received
        if SESSION.interrupted and not stopped.wait(SESSION.patience):
            for process in multiprocessing.active_children():
                process.terminate()
            print(interrupted(), file=sys.stderr, flush=True)
            os._exit(INTERRUPTED)
