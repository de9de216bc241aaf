"""Start the jobs of a study from one process that has imported the libraries.

Idea: NumPy, SciPy, xarray, numba, Matplotlib and the modules of this package that most jobs share
take 2 s of CPU time to import; a study has forty jobs. One process imports them once, and each
job is a fork of it. Snakemake starts jobs as before, by a command; a prefix of the command hands it
to that process, lends it the streams and the environment of the command, and ends as the job ends.

Source: the fork server of Python's ``multiprocessing``, which takes no commands of other processes.

Invariant: a job sees what a process of its own would see, and publishes nothing if a module that it
has loaded changed since the workflow began (``refuse_edited``). A job ends if its command is
killed, all end with Snakemake, and a command that finds no such process becomes the job itself.

Cost: 20 ms a job, and once the imports.
"""

import atexit
import contextlib
import os
import shlex
import signal
import socket
import sys
import time
from importlib import import_module
from typing import Any

from squealpipe.study import job_command


def start_server() -> str:
    """Start the process from which jobs are forked; it ends with this one.

    Returns:
        What to put before the command of a job; empty where there is no such process.
    """
    import subprocess
    import tempfile

    if sys.platform != "linux":  # elsewhere libraries do not outlive a fork
        return ""
    folder = tempfile.TemporaryDirectory(
        prefix="squealpipe-", ignore_cleanup_errors=True
    )
    address = os.path.join(folder.name, "jobs")  # noqa: PTH118 (the command imports little)
    try:
        listening = socket.socket(socket.AF_UNIX)
        listening.bind(address)
    except OSError:  # the folder's path is too long for a socket
        folder.cleanup()
        return ""
    listening.listen(128)
    number = str(listening.fileno())
    server = subprocess.Popen(
        [sys.executable, "-P", __file__, number],
        stdin=subprocess.PIPE,
        pass_fds=[listening.fileno()],
    )
    listening.close()

    def end() -> None:
        if server.stdin:
            server.stdin.close()
        server.wait()
        folder.cleanup()

    atexit.register(end)
    # isolated and without site packages: 10 ms
    words = [sys.executable, "-I", "-S", job_command.__file__, address]
    return f"exec {shlex.join(words)} "


def _import_libraries() -> None:
    """Import what most jobs import, and do once what each would do at first use."""
    for name in (
        "lazy_loader",
        "matplotlib.backends.backend_agg",
        "matplotlib.backends.backend_svg",
        "matplotlib.patheffects",
        "matplotlib.pyplot",
        "netCDF4",
        "pandas",
        "pint",
        "pydantic.functional_validators",
        "pydantic.validate_call_decorator",
        "scipy.interpolate",
        "scipy.io",
        "scipy.optimize",
        "scipy.sparse.linalg",
        "scipy.stats",
        "snakemake.io",
        "snakemake.iocontainers",
        "snakemake.logging",
        "snakemake.shell",
        "yaml",
        "squealpipe.study.job",
        "squealpipe.brake.a1.ensemble",
        "squealpipe.brake.a4.exact_branches",
        "squealpipe.brake.dynamics.motion",
        "squealpipe.brake.dynamics.runs",
        "squealpipe.plotting.style",
        "squealpipe.study.figures.declared",
    ):
        with contextlib.suppress(ImportError):  # of a library that is left out
            import_module(name)
    import_module("xarray").backends.list_engines()
    import_module("numba").cfunc("float64(float64)")(lambda x: x)
    import_module("squealpipe.schema").all_schemas()
    import_module("matplotlib.mathtext").MathTextParser("path").parse("$x$")
    # jobs state the commit with which the study began: four calls of git, 20 ms in each
    import_module("squealpipe.store.checkout").commit()
    # and the versions of libraries, 8 ms in each; most run A1, whose equations take 40 ms to trace
    import_module("squealpipe.systems.datasets.versions").versions()
    params = import_module("squealpipe.parameters").Parameters()
    import_module("squealpipe.brake.a1.motion_system").brake_of(params)


class _Server:
    """The process from which jobs are forked.

    Attributes:
        jobs: number of a job's process → connection to its command, None of one that was killed.
    """

    def __init__(self, listening: socket.socket) -> None:
        import selectors

        self.listening = listening
        self.jobs: dict[int, socket.socket | None] = {}
        # a job that ends wakes the server by this pipe
        self.ended, self._end_of_a_job = os.pipe()
        os.set_blocking(self._end_of_a_job, False)
        self.selector = selectors.DefaultSelector()
        self.readable = selectors.EVENT_READ
        for stream in (sys.stdin, listening, self.ended):
            self.selector.register(stream, self.readable)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(self._end_of_a_job)
        # whether an interrupt ends a job is the job's affair
        self._interrupted = signal.signal(signal.SIGINT, signal.SIG_IGN)

    def serve(self) -> dict[str, Any] | None:
        """Return a job to run, in a fork; None, in the server, once Snakemake has ended."""
        while True:
            for ready, _ in self.selector.select():
                if ready.fileobj is sys.stdin:
                    self._end_all()
                    return None
                if ready.fileobj is self.listening:
                    job = self._accept()
                    if job is not None:
                        return job
                elif ready.fileobj == self.ended:
                    os.read(self.ended, 4096)
                    self._report()
                else:  # its command was killed
                    self._end(ready.data)

    def _accept(self) -> dict[str, Any] | None:
        """Fork a job; return it in the fork, None in the server."""
        command, _ = self.listening.accept()
        head, streams, _, _ = socket.recv_fds(command, job_command.HEAD, 3)
        with command.makefile("rb") as reading:
            content = reading.read(int.from_bytes(head, "big"))
        number = os.fork() if content else 0
        if content and number == 0:
            self._leave()
            script, folder, *variables = os.fsdecode(content).split("\0")
            environment = dict(variable.split("=", 1) for variable in variables)
            return {
                "script": script,
                "folder": folder,
                "environment": environment,
                "streams": streams,
            }
        for stream in streams:
            os.close(stream)
        if content:
            self.jobs[number] = command
            self.selector.register(command, self.readable, number)
        return None

    def _report(self) -> None:
        """Tell the commands of jobs that have ended how they ended."""
        while self.jobs:
            number, status = os.waitpid(-1, os.WNOHANG)
            if number == 0:
                break
            command = self.jobs.pop(number)
            if command:
                self.selector.unregister(command)
                with contextlib.suppress(OSError):
                    command.sendall(b"%d" % os.waitstatus_to_exitcode(status))
                command.close()

    def _end(self, number: int) -> None:
        """End a job whose command has ended."""
        command = self.jobs[number]
        if command:
            self.selector.unregister(command)
            command.close()
        self.jobs[number] = None
        os.kill(number, signal.SIGTERM)

    def _end_all(self) -> None:
        """End all jobs, at last by force."""
        until = time.monotonic() + 20.0  # s that they have to tidy up
        for number in self.jobs:
            os.kill(number, signal.SIGTERM)
        while self.jobs and time.monotonic() < until:
            time.sleep(0.05)
            self._report()
        for number in self.jobs:
            os.kill(number, signal.SIGKILL)

    def _leave(self) -> None:
        """Give up, in a fork, what is the server's."""
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        signal.signal(signal.SIGINT, self._interrupted)
        self.selector.close()
        self.listening.close()
        os.close(self.ended)
        os.close(self._end_of_a_job)
        for command in self.jobs.values():
            if command:
                command.close()


def serve(listening: str) -> None:
    """Import the libraries, and fork jobs until Snakemake ends."""
    import gc

    # among what is imported there is little garbage: to look for it takes a fifth of the time
    gc.disable()
    done: list[bool] = []
    atexit.register(_end_at_once, done)  # the first is called last
    server = _Server(socket.socket(fileno=int(listening)))
    with contextlib.suppress(Exception):  # jobs tell what is wrong with a library
        _import_libraries()
    gc.freeze()  # a job need not look through all that is loaded
    gc.enable()
    gc.set_threshold(200_000)  # nor often through what it makes
    parent = os.getpid()
    job = server.serve()
    if job is None:
        import shutil
        from pathlib import Path

        from squealpipe.study.durations import record_cost

        # a Snakemake that was killed has not done so
        shutil.rmtree(Path(server.listening.getsockname()).parent, ignore_errors=True)
        record_cost("imports", "1-of-1", time.process_time())
    else:
        _become(job, parent)
    done.append(True)


def _end_at_once(done: list[bool]) -> None:
    """End this process before Python takes apart all that is loaded, which takes 0.15 s.

    Args:
        done: empty unless all has gone well; what has not ends as Python ends it.
    """
    if done:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(0)


def _become(job: dict[str, Any], server: int) -> None:
    """Run a job's script in this process, as if Python had been started with it."""
    import ctypes
    import runpy

    # 1: PR_SET_PDEATHSIG of Linux's <sys/prctl.h>
    ctypes.CDLL(None).prctl(1, signal.SIGTERM)
    if os.getppid() != server:  # it died meanwhile
        os._exit(1)
    for number, stream in enumerate(job["streams"]):
        os.dup2(stream, number)
        os.close(stream)
    os.chdir(job["folder"])
    os.environ.clear()
    os.environ.update(job["environment"])
    sys.argv = [job["script"]]
    try:
        runpy.run_path(job["script"], run_name="__main__")
    except KeyboardInterrupt:  # the user stopped the study: no traceback
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGINT)
    except Exception as error:  # noqa: BLE001 (as Python tells it, without the frames of this module)
        trace = error.__traceback__
        while trace and not trace.tb_frame.f_code.co_filename.endswith(job["script"]):
            trace = trace.tb_next
        sys.excepthook(type(error), error.with_traceback(trace), trace)
        sys.exit(1)


if __name__ == "__main__":
    serve(*sys.argv[1:])
