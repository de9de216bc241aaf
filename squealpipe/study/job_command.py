"""The command of a job: it has the process that forks jobs run it, and ends as it ends.

Python reads this file for each job, so it is short and imports little.
"""

import os
import signal
import socket
import sys

HEAD = 8
"""Bytes before a job's description, which state its length."""


def run(address: str, *command: str) -> None:
    """Have a command of Python run by the server, and end as it ends."""
    server = socket.socket(socket.AF_UNIX)
    try:
        server.connect(address)
    except OSError:
        os.execv(command[0], command)  # noqa: S606 (it has come from a shell)
    signal.signal(
        signal.SIGINT, signal.SIG_IGN
    )  # the job gets it, too, and says how it ends
    variables = (f"{name}={value}" for name, value in os.environ.items())
    # no path or variable holds a zero byte
    content = os.fsencode("\0".join([command[1], os.getcwd(), *variables]))  # noqa: PTH109
    try:
        socket.send_fds(server, [len(content).to_bytes(HEAD, "big")], [0, 1, 2])
        server.sendall(content)
    except BrokenPipeError:
        sys.exit(1)
    answer = server.recv(1024)
    code = int(answer) if answer else 1
    if code < 0:  # a signal ended it
        if -code != signal.SIGKILL:
            signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    sys.exit(code)


if __name__ == "__main__":
    run(*sys.argv[1:])
