"""Jobs forked from one process: each sees, and ends like, a process of its own."""

import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from squealpipe.store.rerun.key import STARTED
from squealpipe.study import forked_jobs

pytestmark = pytest.mark.release  # the libraries take 2 s to import


@pytest.fixture(scope="module")
def prefix():
    """What is put before commands; the process behind it ends with this one."""
    found = forked_jobs.start_server()
    assert found
    return found


@pytest.fixture
def job(prefix, tmp_path):
    """Start a script as a job, as Snakemake does: by a shell, in a folder, with an environment."""

    def start(text, before=prefix, **environment):
        script = tmp_path / "script of a job.py"
        script.write_text(text)
        return subprocess.Popen(  # noqa: S602 (as Snakemake does)
            before + shlex.join([sys.executable, str(script)]),
            shell=True,
            cwd=tmp_path,
            env={**os.environ, **environment},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    return start


ABOUT = """
import os, signal, sys
print(os.getcwd(), os.environ["WORD"], sys.argv, __name__, __file__, sys.stdin.read() == "")
print(*map(signal.getsignal, (signal.SIGINT, signal.SIGTERM, signal.SIGCHLD)))
print("beside", file=sys.stderr)
"""


def test_job_is_told_what_a_process_of_its_own_is_told(job):
    answers = [job(ABOUT, WORD="a{b}").communicate() for _ in range(2)]
    alone = job(ABOUT, before="", WORD="a{b}").communicate()
    assert answers == [alone, alone]
    assert alone[1] == "beside\n"


def test_job_finds_libraries_and_what_jobs_share_imported(job):
    told, _ = job("import sys; print(*sys.modules)").communicate()
    modules = {*told.split()}
    assert {"matplotlib.pyplot", "numba", "scipy.stats", "xarray"} <= modules
    assert {"squealpipe.study.job", "squealpipe.plotting.style"} <= modules


def test_job_publishes_nothing_after_an_edit_of_what_it_found_imported(job):
    text = "from squealpipe.store.rerun.key import refuse_edited; refuse_edited('it')"
    edited = Path(forked_jobs.__file__).with_name("job.py").stat().st_mtime
    refused, kept = (
        job(text, **{STARTED: str(since)}) for since in (edited - 1.0, time.time())
    )
    assert "it is not written" in refused.communicate()[1]
    assert kept.wait() == 0


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("import sys; sys.exit(7)", 7),
        ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", -signal.SIGKILL),
        ("raise KeyboardInterrupt", -signal.SIGINT),
        ("def fails():\n    raise ValueError('what')\nfails()", 1),
    ],
)
def test_command_ends_as_its_job_ends(job, text, code):
    forked, alone = job(text), job(text, before="exec ")
    told, told_alone = (each.communicate()[1] for each in (forked, alone))
    assert forked.returncode == alone.returncode == code
    if code == 1:
        assert told == told_alone
        assert "ValueError: what" in told


def is_running(process):
    """Whether a process exists that has not ended."""
    try:
        with open(f"/proc/{process}/stat") as status:  # noqa: PTH123
            return status.read().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):  # it ends while it is looked at
        return False


def test_job_ends_when_its_command_is_killed_and_others_go_on(job):
    text = "import os, time; print(os.getpid(), flush=True); time.sleep(100)"
    first, second = job(text), job(text)
    numbers = [int(each.stdout.readline()) for each in (first, second)]
    first.kill()
    while is_running(numbers[0]):
        time.sleep(0.05)
    assert is_running(numbers[1])
    os.kill(numbers[1], signal.SIGTERM)
    assert second.wait() == -signal.SIGTERM
    for each in (first, second):
        each.communicate()


WORKFLOW = """
import subprocess, sys
from squealpipe.study.forked_jobs import start_server
job = "import os, time; print(os.getpid(), flush=True); time.sleep(100)"
open("job.py", "w").write(job)
made = subprocess.Popen(start_server() + sys.executable + " job.py", shell=True)
made.wait()
"""


def test_jobs_end_with_a_workflow_that_is_killed(tmp_path):
    folder = tmp_path / "temporary"
    folder.mkdir()
    workflow = subprocess.Popen(
        [sys.executable, "-c", WORKFLOW],
        cwd=tmp_path,
        env={**os.environ, "TMPDIR": str(folder)},
        stdout=subprocess.PIPE,
        text=True,
    )
    number = int(workflow.stdout.readline())
    assert is_running(number)
    workflow.kill()
    while is_running(number) or list(folder.iterdir()):
        time.sleep(0.05)
    workflow.communicate()


def test_command_without_a_server_is_the_job_itself(job, prefix, tmp_path):
    nowhere = prefix.replace(shlex.split(prefix)[-1], str(tmp_path / "none"))
    assert job("print(1 + 1)", before=nowhere).communicate() == ("2\n", "")
