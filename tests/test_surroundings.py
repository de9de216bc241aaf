"""Odd surroundings: a path with a space, a home folder that cannot be written, oldest libraries."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
NO_HOME = {**os.environ, "HOME": "/proc/none"}


def run(command, **kwargs):
    return subprocess.run(
        command, capture_output=True, text=True, check=False, **kwargs
    )


def test_a_checkout_path_with_a_space_is_refused_with_the_reason(tmp_path):
    place = tmp_path / "my checkout"
    place.mkdir()
    locks = ("requirements.lock", "requirements-pip.lock")
    for name in ("Makefile", "pyproject.toml", *locks):
        shutil.copy(ROOT / name, place / name)
    done = run(["make", "env"], cwd=place)
    assert done.returncode != 0
    assert "has a space" in done.stderr
    assert not (place / ".venv").exists()


@pytest.mark.parametrize(
    ("settings", "uv_fails", "installed_by"),
    [
        ("", False, "uv"),
        ("", True, "uv pip"),
        ("global.index-url='https://own.example'", False, "pip"),
        (":env:.extra-index-url='https://own.example'", False, "uv"),
    ],
)
def test_pip_installs_where_uv_fails_or_pip_has_an_index_of_its_own(
    tmp_path, settings, uv_fails, installed_by
):
    tools = tmp_path / ".venv" / "bin"
    tools.mkdir(parents=True)
    scripts = {
        "uv": f"echo uv >> log; exit {int(uv_fails)}",
        "python": f'case "$3" in config) echo "{settings}";; *) echo pip >> log;; esac',
    }
    for name, script in scripts.items():
        (tools / name).write_text(f"#!/bin/sh\n{script}\n", "utf-8")
        (tools / name).chmod(0o755)
    shutil.copy(ROOT / "Makefile", tmp_path / "Makefile")
    with (tmp_path / "Makefile").open("a", encoding="utf-8") as file:
        file.write("\nshow:\n\t@$(call INSTALL,-r some.lock)\n")
    run(["make", "show"], cwd=tmp_path)
    assert (tmp_path / "log").read_text("utf-8").split() == installed_by.split()


@pytest.mark.release
def test_commands_need_no_home(tmp_path):
    command = [
        sys.executable,
        "-m",
        "squealpipe",
        "map",
        "stability",
        "--alpha1",
        "0:pi:3",
    ]
    done = run(command, cwd=tmp_path, env=NO_HOME)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "map.nc").is_file()


def test_make_gives_snakemake_a_cache_where_there_is_no_home(tmp_path):
    shutil.copy(ROOT / "Makefile", tmp_path / "Makefile")
    with (tmp_path / "Makefile").open("a", encoding="utf-8") as file:
        file.write("\nshow:\n\t@echo cache=$$XDG_CACHE_HOME\n")
    shown = run(
        ["make", "--no-print-directory", "show"], cwd=tmp_path, env=NO_HOME
    ).stdout
    assert shown.startswith(f"cache={tmp_path}")


def test_make_help_tells_every_target():
    shown = run(["make", "--no-print-directory", "help"], cwd=ROOT).stdout
    _, targets = (ROOT / "Makefile").read_text("utf-8").split(".PHONY: ")
    told = {line.split()[1] for line in shown.splitlines()}
    assert told == set(targets.splitlines()[0].split())


@pytest.mark.long
def test_every_lower_bound_of_the_dependencies_works(tmp_path):
    """Installs the oldest versions that pyproject.toml allows, then runs commands with them."""
    uv, place = str(Path(sys.executable).with_name("uv")), tmp_path / "oldest"
    assert run([uv, "venv", "-q", "--python", sys.executable, place]).returncode == 0
    install = [uv, "pip", "install", "-q", "--python", place / "bin/python"]
    done = run([*install, "--resolution", "lowest-direct", ROOT])
    assert done.returncode == 0, done.stderr
    program = place / "bin/squealpipe"
    for arguments in (
        "--help",
        "simulate 5pi/6 5pi/6 --t-end 10 -o run.nc",
        "map stability --alpha1 0:pi:5 --alpha2 0:pi:5 -o map.nc",
        "backbone 0.3pi 0.9pi --y-peak-max 1.2 -o branch.nc",
        "sweep stability_map --vary mu=0.1,0.2 --alpha1 1 --alpha2 1 --workers 1 -o sweep.nc",
        "compare map.nc map.nc",
        "list",
    ):
        done = run([program, *arguments.split()], cwd=tmp_path)
        assert done.returncode == 0, arguments + done.stderr
