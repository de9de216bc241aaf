"""How far a long job is, how fast it goes and when it will end: in the terminal and in a log."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from types import TracebackType
from typing import Self, TextIO

QUIET = 2.0
"""Seconds in which a job may end without a word."""

_silent: ContextVar[bool] = ContextVar("silent", default=False)
_observer: ContextVar[Callable[[float], None] | None] = ContextVar("observer", default=None)


@contextmanager
def silenced(silent: bool = True) -> Iterator[None]:
    """Nothing is reported to the terminal inside; logs still are written."""
    token = _silent.set(silent)
    try:
        yield
    finally:
        _silent.reset(token)


@contextmanager
def observed(observer: Callable[[float], None]) -> Iterator[None]:
    """Have a single long integration inside tell the time that it has reached, now and then."""
    token = _observer.set(observer)
    try:
        yield
    finally:
        _observer.reset(token)


def observer() -> Callable[[float], None] | None:
    """Who wants to know, if anybody."""
    return _observer.get()


class Progress:
    """Counts work done and reports it now and then.

    A terminal gets one line that is rewritten, any other stream and the log file a line every
    ``interval`` seconds, so that logs stay short.

    Args:
        total: amount of work, in ``unit``.
        label: what is worked on.
        unit: what is counted.
        stream: where to report; standard error by default.
        log: file to which the same lines are appended.
        interval: seconds between two lines.
        done: work that was already there, which the rate must not count.
    """

    def __init__(
        self,
        total: float,
        label: str,
        *,
        unit: str = "cells",
        stream: TextIO | None = None,
        log: str | Path | None = None,
        interval: float = 5.0,
        done: float = 0,
    ) -> None:
        self.total, self.label, self.unit = total, label, unit
        self.start_at, self.done = done, done
        self.stream = sys.stderr if stream is None else stream
        self.log = None if log is None else Path(log)
        self.interval = interval
        self.started = time.perf_counter()
        self._next_line = QUIET
        self._next_rewrite = QUIET
        self._spoke = False

    def __enter__(self) -> Self:
        if self.log is not None:
            self.log.parent.mkdir(parents=True, exist_ok=True)
            self._append(f"{self.label}: {self.done:g} of {self.total:g} {self.unit} at the start")
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        left = kind in {KeyboardInterrupt, GeneratorExit}
        ending = (
            "finished" if kind is None else "interrupted" if left else f"stopped by {kind.__name__}"
        )
        line = f"{self.line()}, {ending}"
        self._append(line)
        if self._spoke:
            self.stream.write(("\r\x1b[K" if self._terminal() else "") + line + "\n")
            self.stream.flush()

    def advance(self, amount: float = 1) -> None:
        """Count work as done, and report if it is time."""
        self.done += amount
        elapsed = time.perf_counter() - self.started
        if _silent.get():
            if elapsed >= self._next_line:
                self._next_line = elapsed + self.interval
                self._append(self.line())
            return
        if self._terminal() and elapsed >= self._next_rewrite:
            self._next_rewrite = elapsed + 0.2
            self._speak("\r\x1b[K" + self.line())
        if elapsed >= self._next_line and self.done < self.total:
            self._next_line = elapsed + self.interval
            self._append(self.line())
            if not self._terminal():
                self._speak(self.line() + "\n")

    def line(self) -> str:
        """For instance ``validity map: 1200 of 8281 cells (14 %), 410 cells/s, 17 s left``."""
        elapsed = time.perf_counter() - self.started
        share = self.done / self.total if self.total else 1.0
        text = f"{self.label}: {self.done:g} of {self.total:g} {self.unit} ({share:.0%})"
        fresh = self.done - self.start_at
        if fresh <= 0 or elapsed <= 0:
            return text
        rate = fresh / elapsed
        left = (self.total - self.done) / rate
        return f"{text}, {rate:.3g} {self.unit}/s, " + (
            f"{duration(left)} left" if left > 0 else f"{duration(elapsed)} taken"
        )

    def _terminal(self) -> bool:
        return self.stream.isatty()

    def _speak(self, text: str) -> None:
        self._spoke = True
        self.stream.write(text)
        self.stream.flush()

    def _append(self, text: str) -> None:
        if self.log is not None:
            with self.log.open("a", encoding="utf-8") as file:
                file.write(f"{time.strftime('%Y-%m-%dT%H:%M:%S')} {text}\n")


def counted(items: Sequence[str], label: str, *, unit: str) -> Iterator[str]:
    """The items, one after another, with progress."""
    with Progress(len(items), label, unit=unit) as progress:
        for item in items:
            yield item
            progress.advance()


@contextmanager
def elapsing(label: str, interval: float = 5.0) -> Iterator[None]:
    """Tell every ``interval`` seconds for how long a job of unknown length has worked."""
    if _silent.get():
        yield
        return
    ended, started = threading.Event(), time.perf_counter()

    def tell() -> None:
        while not ended.wait(interval):
            sys.stderr.write(f"{label}: {duration(time.perf_counter() - started)} so far\n")

    thread = threading.Thread(target=tell, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


def duration(seconds: float) -> str:
    """Seconds for people: 0.4 s, 17 s, 3 min 20 s, 2 h 5 min, 12 days."""
    if seconds < 10:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 120:
        return f"{whole} s"
    if whole < 7200:
        return f"{whole // 60} min {whole % 60} s"
    if whole < 172_800:
        return f"{whole // 3600} h {whole % 3600 // 60} min"
    return f"{whole // 86_400} days"
