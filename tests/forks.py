"""Tests run in forks of the one process that has imported and collected them.

    python -m pytest … -p tests.forks --forks 2

Each fork takes one file of tests after another, and sends what its tests report. One that crashes
fails the test that it ran; another one goes on with what it had taken.
"""

import multiprocessing
import warnings
from itertools import chain, pairwise
from multiprocessing import connection
from typing import Any

import pytest

from squealpipe.systems.compiled import compile_time

COMPILING = pytest.StashKey[float]()
"""CPU time that forks have spent on compiling, s."""
_context: Any = multiprocessing.get_context("fork")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Take the number of forks."""
    parser.addoption("--forks", type=int, default=0, help="processes that run tests")


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> bool | None:
    """Run the tests in forks; without any, or after errors of collection, leave it to pytest."""
    options = session.config.option
    if not options.forks or options.collectonly or session.testsfailed:
        return None
    forks = _Forks(session)
    try:
        for _ in range(options.forks):
            forks.start()
        forks.report()
    finally:
        forks.stop.value = True
    if session.shouldfail:
        raise session.Failed(session.shouldfail)
    if session.shouldstop:
        raise session.Interrupted(session.shouldstop)
    return True


class _Forks:
    """Processes that share the files of a session."""

    def __init__(self, session: pytest.Session) -> None:
        self.session = session
        files: dict[Any, list[int]] = {}
        for number, item in enumerate(session.items):
            files.setdefault(item.path, []).append(number)
        self.files = list(files.values())
        self.taken = _context.Value("i", 0)
        """Number of files that forks have taken."""
        self.takers = _context.RawArray("i", len(self.files))
        """The fork that has taken each file, counted from one."""
        self.stop = _context.RawValue("b", False)
        """Whether no test is to begin any more."""
        self.running: dict[Any, tuple[Any, Any, int, list[int]]] = {}
        """By channel: process, its test, number of the fork, tests that another one left."""
        self.started = 0
        session.config.stash[COMPILING] = 0.0
        _temporary(session).getbasetemp()  # in which each fork has its own

    def start(self, left: list[int] | None = None) -> None:
        """Start a fork, for tests that another one has left and for files that it takes."""
        self.started += 1
        receiver, sender = _context.Pipe(duplex=False)
        current, left = _context.RawValue("i", -1), left or []
        process = _context.Process(target=self._run, args=(sender, current, left))
        process.start()
        sender.close()
        self.running[receiver] = process, current, self.started, left

    def report(self) -> None:
        """Report what forks send until all have ended."""
        session, config = self.session, self.session.config
        while self.running:
            for channel in connection.wait(list(self.running)):
                try:
                    kind, content = channel.recv()
                except EOFError:
                    self._restart(channel)
                    continue
                if kind == "report":
                    report = config.hook.pytest_report_from_serializable(
                        config=config, data=content
                    )
                    config.hook.pytest_runtest_logreport(report=report)
                elif kind == "warning":
                    text, category, *place = content.pop("told")
                    # its own class may be that of a test, which cannot be sent
                    told = warnings.WarningMessage(
                        text, type(category, (Warning,), {}), *place
                    )
                    config.hook.pytest_warning_recorded.call_historic(
                        kwargs=content | {"warning_message": told}
                    )
                else:
                    config.stash[COMPILING] += content
                    self.running.pop(channel)[0].join()
            if session.shouldfail or session.shouldstop:
                self.stop.value = True

    def _restart(self, channel: Any) -> None:
        """Report that a fork has crashed, and start another one for what it had taken."""
        process, current, number, left = self.running.pop(channel)
        process.join()
        if current.value < 0:
            raise RuntimeError(f"a fork ended with exit code {process.exitcode}")
        item = self.session.items[current.value]
        report = pytest.TestReport(
            nodeid=item.nodeid,
            location=item.location,
            keywords={},
            outcome="failed",
            longrepr=f"{item.nodeid}: its process ended with exit code {process.exitcode}",
            when="call",
        )
        self.session.config.hook.pytest_runtest_logreport(report=report)
        for file, taker in zip(self.files, self.takers, strict=True):
            left = left + file if taker == number else left
        self.start(left[left.index(current.value) + 1 :])

    def _run(self, channel: Any, current: Any, left: list[int]) -> None:
        """Run tests in a fork."""
        # held open by another fork, a channel would not tell that the first process died
        for other in self.running:
            other.close()
        session, plugins = self.session, self.session.config.pluginmanager
        capture: Any = plugins.getplugin("capturemanager")
        capture.stop_global_capturing()  # into files that all forks share
        capture.start_global_capturing()
        capture.suspend_global_capture()
        reporter: Any = plugins.unregister(name="terminalreporter")
        plugins.register(_Sender(session.config, channel, reporter), "terminalreporter")
        folders = _temporary(session)
        folders._basetemp = folders.mktemp("fork")
        before = compile_time()
        try:
            for number, following in pairwise(chain(self._numbers(left), [None])):
                if self.stop.value or session.shouldfail or session.shouldstop:
                    break
                current.value = number
                item = session.items[number]
                item.ihook.pytest_runtest_protocol(
                    item=item,
                    nextitem=None if following is None else session.items[following],
                )
        except KeyboardInterrupt:
            pass  # the first process tells it
        session._setupstate.teardown_exact(None)
        session.config.hook.pytest_unconfigure(config=session.config)
        channel.send(("end", compile_time() - before))

    def _numbers(self, left: list[int]) -> Any:
        """Yield the numbers of tests that are left, and of those of files that are taken."""
        numbers = left
        while True:
            yield from numbers
            with self.taken.get_lock():
                place = self.taken.value
                self.taken.value += 1
            if place >= len(self.files):
                return
            self.takers[place] = self.started
            numbers = self.files[place]


def _temporary(session: pytest.Session) -> Any:
    return session.config._tmp_path_factory  # type: ignore[attr-defined]


class _Sender:
    """In a fork, in the place of what prints reports: sends them."""

    def __init__(self, config: pytest.Config, channel: Any, reporter: Any) -> None:
        self._config, self._channel = config, channel
        self._tw = reporter._tw  # to which pytest-timeout writes

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Send a report, but not that a test was set up or taken down in silence."""
        if (
            report.passed
            and report.when != "call"
            and not report.sections
            and self._config.option.durations is None
        ):
            return
        data = self._config.hook.pytest_report_to_serializable(
            config=self._config, report=report
        )
        self._channel.send(("report", data))

    def pytest_warning_recorded(
        self, warning_message: Any, when: str, nodeid: str, location: Any
    ) -> None:
        """Send a warning, but none of the collection, which the first process has told."""
        if when != "runtest":
            return
        told = (
            str(warning_message.message),
            warning_message.category.__name__,
            warning_message.filename,
            warning_message.lineno,
        )
        content = {"told": told, "when": when, "nodeid": nodeid, "location": location}
        self._channel.send(("warning", content))
