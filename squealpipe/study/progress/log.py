"""Progress of a command or of a study's job as lines in a log."""

import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

from squealpipe.systems.inputs.words import duration
from squealpipe.systems.progress import shown

LOG_EVERY = 30.0
"""Time between two lines of progress in a log, s."""
QUIET = "SQUEALPIPE_QUIET"
"""Environment variable by which `squealpipe run -q` keeps its jobs from telling their progress."""


class Log:
    """Lines in a log: stages that last, progress with remaining time, and partial answers.

    Args:
        what: is computed, which begins each line.
    """

    def __init__(self, what: str) -> None:
        self.what = what
        self.begun = self.started = self.told = time.monotonic()
        self.said = False
        self.first: float | None = None
        self.later: threading.Timer | None = None

    @contextmanager
    def printed(self) -> Iterator[None]:
        """Print what is computed within the block."""
        with shown(self.tell, self.say, self.name):
            yield

    def _print(self, line: str) -> None:
        print(f"{self.what}: {line}", file=sys.stderr, flush=True)

    def name(self, stage: str) -> None:
        """Print the name of a stage that lasts for some seconds."""
        if self.later is not None:
            self.later.cancel()
        self.later, self.first = None, None
        if stage:
            seconds = 5.0
            self.later = threading.Timer(seconds, self._print, (f"{stage} …",))
            self.later.daemon = True
            self.later.start()

    def tell(self, share: float) -> None:
        """Print progress and remaining time, twice a minute."""
        now = time.monotonic()
        if self.first is None:  # what was there from before took no time
            self.first, self.started = share, now
        if now - self.told < LOG_EVERY or share <= self.first:
            return
        self.told = now
        left = (now - self.started) * (1 - share) / (share - self.first)
        self._print(f"{share:.0%} done, about {duration(left)} left")

    def say(self, line: str) -> None:
        """Print a partial answer: one soon, and others if nothing was printed for a while."""
        now = time.monotonic()
        soon = 3.0  # seconds, within which a quick command has ended
        if now - self.told >= LOG_EVERY or (not self.said and now - self.begun >= soon):
            self.told, self.said = now, True
            self._print(line)
