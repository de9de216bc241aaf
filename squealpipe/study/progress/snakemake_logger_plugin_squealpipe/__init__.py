"""One line a rule with the time that is left, instead of Snakemake's account of every job.

Snakemake finds this package by its name, in a folder that `squealpipe run` adds to its path.
"""

import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from logging import WARNING, LogRecord
from pathlib import Path

from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent
from snakemake_interface_logger_plugins.settings import LogHandlerSettingsBase

from squealpipe.study.durations import job_times
from squealpipe.study.progress.remaining import Remaining

NO_STEPS = {"total", "all"}
"""Names that Snakemake counts beside the rules that make something: the sum, the last target."""


@dataclass
class LogHandlerSettings(LogHandlerSettingsBase):
    """Options of this plugin on Snakemake's command line."""

    cores: int | None = field(
        default=None, metadata={"help": "cores that the jobs share", "type": int}
    )
    results: str = field(
        default="", metadata={"help": "folder of the study's results", "type": str}
    )


class LogHandler(LogHandlerBase):
    """Writes to stderr; warnings, errors and logs of failed jobs as Snakemake words them."""

    settings: LogHandlerSettings

    def __post_init__(self) -> None:
        """Before Snakemake says which jobs there are."""
        self.remaining: Remaining | None = None
        self.begun: set[str] = set()
        self.interrupted = False

    def emit(self, record: LogRecord) -> None:
        """Write the line of a record, if it has one."""
        about = vars(record)
        event = about.get("event")
        if event == LogEvent.RUN_INFO:
            line = self._all_jobs(about["stats"])
        elif event == LogEvent.JOB_INFO:
            line = self._started(about["jobid"], about["rule_name"])
        elif event == LogEvent.JOB_FINISHED and self.remaining is not None:
            self.remaining.finish(about["job_id"], time.monotonic())
            line = ""
        else:
            failed = event in {LogEvent.JOB_ERROR, LogEvent.GROUP_ERROR}
            line = self.format(record) if failed or record.levelno >= WARNING else ""
            line = self._told(line)
        if line:
            print(line, file=sys.stderr, flush=True)

    def _told(self, words: str) -> str:
        """Return what a user needs of an error; nothing once a job was interrupted."""
        if "died with <Signals.SIGINT" in words:
            self.interrupted = True
        if self.interrupted:
            return ""
        if not words.startswith("ConfigError in file"):
            return words
        # leave out the lines of the workflow that read the configuration
        lines = words.splitlines()[1:]
        return "\n".join(line for line in lines if not line.startswith('  File "'))

    def _all_jobs(self, stats: dict[str, int]) -> str:
        jobs = Counter({rule: n for rule, n in stats.items() if rule not in NO_STEPS})
        self.remaining = Remaining(
            jobs, job_times(Path(), self.settings.results), self.settings.cores or 1
        )
        return f"{len(jobs)} steps{self.remaining.words(time.monotonic())}"

    def _started(self, job: int, rule: str) -> str:
        if self.remaining is None or rule in NO_STEPS:
            return ""
        now = time.monotonic()
        first = rule not in self.begun
        self.begun.add(rule)
        line = ""
        if first:
            total = len(self.remaining.jobs)
            place = f"{len(self.begun):{len(str(total))}} of {total}"
            line = f"{place}  {rule}{self.remaining.words(now)}"
        self.remaining.start(job, rule, now)
        return line

    @property
    def writes_to_stream(self) -> bool:
        """It takes the place of Snakemake's own handler."""
        return True

    @property
    def writes_to_file(self) -> bool:
        """Snakemake's own log file stays."""
        return False

    @property
    def has_filter(self) -> bool:
        """Tell Snakemake that this handler chooses its messages by itself."""
        return True

    @property
    def has_formatter(self) -> bool:
        """Errors are worded by Snakemake."""
        return False

    @property
    def needs_rulegraph(self) -> bool:
        """No."""
        return False
