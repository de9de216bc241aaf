"""Remaining time of a study's jobs, from the time that each took when it last ran."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from squealpipe.study.durations import together
from squealpipe.text import duration


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
    _took: list[float] = field(default_factory=list)

    def start(self, job: int, rule: str, now: float) -> None:
        """A job runs from `now` on, s of any clock."""
        self._running[job] = (rule, now)

    def finish(self, job: int, now: float) -> None:
        """A job has ended; one that was not started here, such as the last target, is none."""
        if job not in self._running:
            return
        rule, started = self._running.pop(job)
        self.jobs[rule] -= 1
        self._took.append(now - started)

    def left(self, now: float) -> float | None:
        """Time left, s, by :func:`together`.

        A rule that never ran here is taken to last as long as those that have in this run, on
        average. None: nothing is known yet.
        """
        known = [self.seconds[rule] for rule in self.jobs if rule in self.seconds]
        usual = self._took or known
        if not usual:
            return None
        average = sum(usual) / len(usual)
        each = {rule: self.seconds.get(rule, average) for rule in self.jobs}
        running = [
            max(0.0, start + each[rule] - now) for rule, start in self._running.values()
        ]
        waiting = self.jobs - Counter(rule for rule, _ in self._running.values())
        return together(
            [*running, *(each[rule] for rule in waiting.elements())], self.cores
        )

    def words(self, now: float) -> str:
        """Return for instance ``, about 41 s left``; empty where nothing is known."""
        left = self.left(now)
        return "" if left is None else f", about {duration(left)} left"
