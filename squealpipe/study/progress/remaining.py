"""Remaining time of a study's jobs, from the time that each took when it last ran."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from squealpipe.study.durations import together
from squealpipe.systems.inputs.words import duration


@dataclass
class Remaining:
    """Time left.

    Attributes:
        jobs: rule → number of its jobs that are not finished.
        seconds: rule → what one of its jobs took last, s.
        cores: that the jobs share.
    """

    jobs: Counter[str]
    seconds: Mapping[str, float]
    cores: int
    _running: dict[int, tuple[str, float]] = field(default_factory=dict)
    _took: dict[str, float] = field(default_factory=dict)

    def start(self, job: int, rule: str, now: float) -> None:
        """A job runs from `now` on, s of any clock."""
        self._running[job] = (rule, now)

    def finish(self, job: int, now: float) -> None:
        """A job has ended; one that was not started here, such as the last target, is none."""
        if job not in self._running:
            return
        rule, started = self._running.pop(job)
        self.jobs[rule] -= 1
        self._took[rule] = now - started

    def left(self, now: float) -> float | None:
        """Time left, s, by :func:`together`.

        None if a rule that is left has never run: rules take from a second to half an hour, so
        that those that have run say nothing about it.
        """
        each = {**self._took, **self.seconds}
        if any(count and rule not in each for rule, count in self.jobs.items()):
            return None
        running = [
            max(0.0, start + each[rule] - now) for rule, start in self._running.values()
        ]
        waiting = self.jobs - Counter(rule for rule, _ in self._running.values())
        return together(
            [*running, *(each[rule] for rule in waiting.elements()), 0.0], self.cores
        )

    def words(self, now: float) -> str:
        """Return for instance ``, about 41 s left``; empty where nothing is known."""
        left = self.left(now)
        return "" if left is None else f", about {duration(left)} left"
