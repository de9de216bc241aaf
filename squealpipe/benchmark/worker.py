"""A solver in a process of its own: what it does there ends no benchmark."""

import multiprocessing
import signal
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any, Generic, TypeVar

Answer = TypeVar("Answer")


class Worker(Generic[Answer]):
    """Asks a function in a process of its own, which is ended where it does not answer.

    The process is forked, so that what the function has compiled is there; where a platform cannot
    fork, the function is called in this process and has no time limit.

    Args:
        function: what is asked.
        time_limit: s of wall time for one answer.
    """

    def __init__(self, function: Callable[..., Answer], time_limit: float) -> None:
        self.function, self.time_limit = function, time_limit
        self.forks = "fork" in multiprocessing.get_all_start_methods()
        self.process: Any = None
        self.pipe: Connection | None = None

    def ask(self, **arguments: Any) -> Answer:
        """Run the function in the child process, and return its result.

        Raises:
            TimeoutError: it gave nothing in time.
            EOFError: its process ended.
        """
        if not self.forks:
            return self.function(**arguments)
        if self.pipe is None:
            context = multiprocessing.get_context("fork")
            self.pipe, far_end = context.Pipe()
            self.process = context.Process(
                target=_serve, args=(self.function, far_end, self.pipe), daemon=True
            )
            self.process.start()
            far_end.close()
        self.pipe.send(arguments)
        if not self.pipe.poll(self.time_limit):
            self.close()
            raise TimeoutError(f"no answer within {self.time_limit:g} s")
        try:
            answer: Answer = self.pipe.recv()
        except EOFError:
            self.process.join()
            code = self.process.exitcode
            self.close()
            raise EOFError(f"its process ended with exit code {code}") from None
        return answer

    def close(self) -> None:
        """End the process."""
        if self.pipe is not None:
            self.pipe.close()
            self.process.kill()
            self.process.join()
        self.pipe = self.process = None


def _serve(
    function: Callable[..., Any], pipe: Connection, other_end: Connection
) -> None:
    # an interrupt of the terminal reaches the process that asks, which ends this one
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    other_end.close()  # or the process would never see that nobody asks any more
    while True:
        try:
            arguments = pipe.recv()
        except EOFError:
            return
        pipe.send(function(**arguments))
