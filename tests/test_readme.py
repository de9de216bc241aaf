"""The commands and Python of README and guide are run, in order, with a finished tiny study.

There the tiny study stands for the paper's: its configuration takes the place of paper.yaml.
`make` and `snakemake`, which other tests run in earnest, are asked for their plan. Python, and
commands that read no checkout, run in the process of the tests: a new one takes 1.3 s to import the
libraries. Others, and the first of README once more, start as a shell starts them.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
import yaml

from squealpipe import cli
from squealpipe.store.keys import stated_key
from squealpipe.store.rerun.key import PARTS
from squealpipe.store.yaml_files import overlay
from squealpipe.study.archive import archive

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
GUIDE = (ROOT / "docs/guide.md").read_text(encoding="utf-8")
BLOCKS = re.findall(
    r"^```(bash|python)\n(.*?)^```", README + GUIDE, flags=re.MULTILINE | re.DOTALL
)
STEPS = [
    (language, step)
    for language, block in BLOCKS
    for step in (block.splitlines() if language == "bash" else [block])
]
ANSWERS = {"claims": {0, 1}, "compare": {0, 1}, "assess": {0, 1}}
"""Exit codes that are an answer; the coarse grids of the tiny study may change one."""
OF_A_CHECKOUT = {
    "archive",
    "claims",
    "compare",
    "deposit",
    "explain",
    "find",
    "list",
    "verify",
}
"""Commands that read the checkout in which they run, beside ``--help``."""


@pytest.fixture(scope="module")
def study(tiny_study, tmp_path_factory):
    """A checkout in which the tiny study is the study."""
    copy = tmp_path_factory.mktemp("readme") / "squealpipe"
    shutil.copytree(tiny_study.checkout, copy, symlinks=True)
    config = copy / "workflow/config"
    merged = yaml.safe_load((config / "paper.yaml").read_text(encoding="utf-8"))
    overlay(merged, yaml.safe_load((config / "tiny.yaml").read_text(encoding="utf-8")))
    merged["results"] = "results"
    (config / "paper.yaml").write_text(yaml.safe_dump(merged), encoding="utf-8")
    for part in (copy / "results/tiny").iterdir():
        part.rename(copy / "results" / part.name)
    made = [path for part in PARTS for path in (copy / "results" / part).rglob("*.*")]
    keys = {str(path.relative_to(copy)): stated_key(path) for path in made}
    archive("reference", keys=keys, root=copy, leave_out=[".svg", ".html"])
    return copy


def planned(command):
    """The command, with pip, make and snakemake asked for their plan only."""
    if command.startswith("pip "):
        return f"{command} --dry-run --no-deps --no-build-isolation"
    if command.startswith("make "):
        return command.replace("make ", "make --dry-run ", 1)
    if command.startswith("snakemake"):
        return f"{command} --dry-run --quiet"
    return command


def run(command, place):
    environment = {
        **os.environ,
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(place),
        "MPLBACKEND": "agg",
    }
    return subprocess.run(
        ["bash", "-c", command],
        cwd=place,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


def run_here(command, language):
    """The exit code of Python or of a command of the package, in this process."""
    if language == "bash":
        return cli.run(shlex.split(command)[1:])
    exec(compile(command, "step", "exec"), {"__name__": "__main__"})  # noqa: S102
    plt.close("all")
    return 0


@pytest.mark.release
@pytest.mark.parametrize(
    ("language", "step"), STEPS, ids=[step[:60] for _, step in STEPS]
)
def test_step_works(study, language, step, monkeypatch, capsys, real_pictures):
    command = step.partition("#")[0].strip() if language == "bash" else step
    words = command.split()
    is_ours = language == "bash" and words[0] == "squealpipe"
    if language == "python" or (
        is_ours and words[1] in cli.COMMANDS.keys() - OF_A_CHECKOUT
    ):
        monkeypatch.chdir(study)
        code = run_here(command, language)
        out, err = capsys.readouterr()
    else:
        done = run(planned(command), study)
        code, out, err = done.returncode, done.stdout, done.stderr
    allowed = ANSWERS.get(words[1], {0}) if is_ours else {0}
    assert code in allowed, out[-2000:] + err[-2000:]
    assert "Traceback" not in err


def test_a_first_picture_comes_first_and_the_whole_is_short():
    assert [step.split()[0] for _, step in STEPS[:2]] == ["pip", "squealpipe"]
    assert README.count("\n") <= 130
    steps = [step.partition("#")[0].strip() for _, step in STEPS]
    assert {"make reproduce", "make test"} <= set(steps)


@pytest.mark.release
def test_the_printed_summary_is_what_the_command_prints(tmp_path):
    printed = re.search(r"```text\n(.*?)```", README, flags=re.DOTALL)
    assert printed is not None
    command = next(step for _, step in STEPS if step.startswith("squealpipe simulate"))
    assert run(command, tmp_path).stdout == printed[1]


def test_links_lead_somewhere():
    for folder, text in ((ROOT, README), (ROOT / "docs", GUIDE)):
        for target in re.findall(r"\]\(([^)#]+)\)", text):
            assert (folder / target).exists(), target
