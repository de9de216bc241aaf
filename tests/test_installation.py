"""The package as a stranger installs it: core dependencies alone, types shipped, metadata valid."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
STUDY = {"jinja2", "psutil", "rocrate", "snakemake", "typst"}
"""What only a study needs."""
LIBRARY = f"""
import sys

class Without:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {sorted(STUDY | {"heyoka"})}:
            raise ModuleNotFoundError(name)

sys.meta_path.insert(0, Without())
import squealpipe
assert squealpipe.functions.cos(0.0) == 1.0 and squealpipe.structures.elastic_pad
from squealpipe.cli import run

for name in squealpipe.__all__:
    getattr(squealpipe, name)
params = squealpipe.Parameters()
assert squealpipe.simulate(params, 1.0, 2.0, t_end=5.0).outcome == 0
assert run(["simulate", "5pi/6", "5pi/6", "--t-end", "5", "-o", "run.nc"]) == 0
assert run(["map", "stability", "--alpha1", "0:pi:3", "--alpha2", "0:pi:3"]) == 0
"""


def run(*command, cwd):
    done = subprocess.run(
        [str(word) for word in command],
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
    return done.stdout


@pytest.mark.release
def test_the_library_and_its_commands_work_without_what_a_study_needs(tmp_path):
    run(sys.executable, "-c", LIBRARY, cwd=tmp_path)


def test_no_dependency_of_a_study_is_one_of_the_library():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))[
        "project"
    ]
    core = {line.partition(">")[0].lower() for line in project["dependencies"]}
    study = {
        line.partition(">")[0] for line in project["optional-dependencies"]["study"]
    }
    assert study >= STUDY
    assert not core & study


@pytest.mark.parametrize("name", ["requirements.lock", "requirements-dev.lock"])
def test_locks_name_no_index_and_agree(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    assert "--index-url" not in text
    assert "://" not in text
    study = (ROOT / "requirements.lock").read_text(encoding="utf-8")
    pinned = {line.split()[0] for line in study.splitlines() if "==" in line}
    assert pinned <= {line.split()[0] for line in text.splitlines() if "==" in line}


@pytest.mark.release
def test_citation_is_valid():
    """By its validator, whose old libraries need an environment of their own."""
    uvx = (
        Path(sys.executable).parent / "uv",
        "tool",
        "run",
        "cffconvert",
        "--validate",
    )
    assert "valid" in run(*uvx, "-i", ROOT / "CITATION.cff", cwd=ROOT)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))[
        "project"
    ]
    assert f"version: {project['version']}" in (ROOT / "CITATION.cff").read_text(
        encoding="utf-8"
    )


PAD = """
paper: false
scenes: {mine: {alpha1: 30deg, alpha2: 140deg, start: {vx: 0.001}}}
parameters:
  {mass: 0.5, k1: 1.0e+7, k2: 1.0e+7, k3: 7.0e+6, preload: 2.0e-5, length1: 0.02, length2: 0.02}
dynamics: {validity_points: 13, hammering_points: 3}
explorer: {points: 3}
robustness: {samples: 64, critical_points: 7}
"""

MEASURED = """
results: results/measured
scenes: {leaning: {alpha1: 65deg, alpha2: 155deg, start: {vy: -0.2}}}
parameters:
  {friction_law: {table: friction.csv}, contact_law: dashpot, damping1: 20, damping3: 40}
"""


@pytest.mark.release
def test_wheel_in_a_bare_environment(checkout, tmp_path):
    """Sdist and wheel checked by twine; the core alone, then a study from an empty folder."""
    uv, dist, bare = (
        Path(sys.executable).parent / "uv",
        tmp_path / "dist",
        tmp_path / "bare",
    )
    run(uv, "build", "-q", "-o", dist, checkout, cwd=tmp_path)
    sdist, wheel = sorted(dist.glob("*.*z")) + sorted(dist.glob("*.whl"))
    run(uv, "tool", "run", "twine", "check", "--strict", sdist, wheel, cwd=tmp_path)
    run(uv, "venv", "-q", "--python", sys.executable, bare, cwd=tmp_path)
    install = (
        uv,
        "pip",
        "install",
        "-q",
        "--reinstall-package",
        "squealpipe",
        "--python",
        bare,
    )
    command, folder = bare / "bin/squealpipe", tmp_path / "empty"
    folder.mkdir()
    for path in (sdist, wheel):
        run(*install, path, cwd=folder)
        assert run(command, "--version", cwd=folder).strip()
    script = "import importlib.util as u; print(u.find_spec('snakemake'))"
    assert run(bare / "bin/python", "-c", script, cwd=folder).strip() == "None"
    run(command, "simulate", "5pi/6", "5pi/6", "--t-end", "5", cwd=folder)
    assert list(bare.glob("lib/*/site-packages/squealpipe/py.typed"))
    run(*install, f"{wheel}[study]", cwd=folder)
    (folder / "mine.yaml").write_text(PAD)
    (folder / "friction.csv").write_text("speed,mu\n0,0.5\n1,0.4\n3,0.36\n")
    (folder / "measured.yaml").write_text(MEASURED)
    configs = ("--config", "mine.yaml", "--config", "measured.yaml")
    run(command, "run", *configs, cwd=folder)
    text = (folder / "results/measured/report/index.html").read_text()
    assert "Does it squeal?" in text
    assert "0.5 at 0 m/s, 0.4 at 1 m/s, 0.36 at 3 m/s" in text
    assert "dashpot along spring 1" in text
    assert "leaning: alpha1 65" in text
    assert "Quiet: the vibration dies out" in text
    run(command, "archive", "first", *configs, cwd=folder)
