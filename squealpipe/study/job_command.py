"""The command of a job: it has the process that forks jobs run it, and ends as it ends.

Python reads this file for each job, so it is short and imports little.
"""

# `signal` and `socket` would import enum, half of the 20 ms that this file takes
import _signal as signal  # type: ignore[import-not-found]
import _socket as socket
import os
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
    # the job gets it, too, and says how it ends
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    variables = (f"{name}={value}" for name, value in os.environ.items())
    # no path or variable holds a zero byte
    content = os.fsencode("\0".join([command[1], os.getcwd(), *variables]))  # noqa: PTH109
    try:
        streams = b"".join(stream.to_bytes(4, sys.byteorder) for stream in (0, 1, 2))
        rights = (socket.SOL_SOCKET, socket.SCM_RIGHTS, streams)
        server.sendmsg([len(content).to_bytes(HEAD, "big")], [rights])
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
