"""The command line as a user meets it: help, errors in a sentence, exit codes, files."""

import ast
import inspect
import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

import squealpipe
from squealpipe import __version__, load, plot
from squealpipe.cli import COMMANDS, run

SWEPT = ["sweep", "stability_map", "--alpha1", "1", "--alpha2", "2"]
DISTRIBUTED = ["propensity", "1", "2", "--distribution"]
HEAVY = ("heyoka", "numba", "xarray", "numpy", "matplotlib")


@pytest.mark.parametrize("command", COMMANDS)
def test_help_explains_with_an_example(command, capsys):
    assert run([command, "--help"]) == 0
    out = capsys.readouterr().out
    assert f"Example: squealpipe {command}" in out
    assert max(out) < "\U0001f000"  # "KIND:A:B" would be drawn as an emoji


def test_version_and_help_without_numerics(capsys):
    assert run(["--version"]) == 0
    assert capsys.readouterr().out.strip() == __version__
    code = (
        "import sys; from squealpipe.cli import run; run(['simulate', '--help']);"
        f"sys.exit(bool(set({HEAVY}) & set(sys.modules)))"
    )
    subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)


def test_an_output_that_exists_is_refused_at_once(tmp_path):
    """Before anything that takes long is loaded, which each command would tell."""
    (tmp_path / "there.nc").touch()
    commands = [
        ["simulate", "1", "2"],
        ["assess", "1", "2"],
        [*SWEPT, "--vary", "mu=0,1"],
        ["modes", "pad.yaml"],
        ["squeal", "pad.yaml"],
        ["ladder", "pad.yaml"],
        ["benchmark"],
        ["map", "stability"],
    ]
    code = (
        f"import sys; from squealpipe.cli import run\nfor words in {commands}:\n"
        "    run([*words, '-o', 'there.nc'])\n"
        f"    print(words, *sorted(set({HEAVY}) & set(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        check=True,
        cwd=tmp_path,
        text=True,
    )
    assert done.stdout.splitlines() == [f"{words}" for words in commands]
    assert done.stderr.count("there.nc exists; add --force") == len(commands)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["simulat"], 'Did you mean "simulate"'),
        (["simulate", "0.4pi"], "ALPHA2 requires an argument"),
        (["simulate", "0.4pi", "sixty"], "write 0.4pi, 2pi/5, 72deg or radians"),
        (["simulate", "1", "2", "--muu", "3"], "Did you mean --mu"),
        (["simulate", "1", "2", "--t-end", "0"], "--t-end 0.0 must be greater than 0"),
        (["simulate", "1", "2", "--points", "3"], "give 16 or more"),
        (["map", "stability", "-p", "map.txt"], "end the name in .png, .svg or .pdf"),
        (["map", "stability", "--alpha1", "1"], "2 or more angles of each spring"),
        (["sweep", "stability_map", "--vary", "mu"], "write for instance mu=0:0.6:13"),
        ([*SWEPT, "--vary", "mu=1,2", "--vary", "mu=3,4"], "--vary mu is a duplicate"),
        ([*DISTRIBUTED, "mu=uniform:0.1"], "mu=uniform:0.1:0.9"),
        (
            [*DISTRIBUTED, "mu=uniform:0:1", "--mu", "0.3"],
            "mu is both fixed and distributed",
        ),
        ([*SWEPT, "--vary", "friction_law=coulomb,exponential"], "sweep once for each"),
        (["simulate", "1", "2", "3"], "too many arguments: 3"),
        (["simulate", "72", "108"], "72: more than a full turn; angles are in rad"),
        (["simulate", "1", "2", "-o", "run.txt"], "end the name in .nc or .csv"),
        (["simulate", "1", "2", "--points", "100000000000000"], "Unable to allocate"),
        (["simulate", "1", "2", "-c", "nowhere.yaml"], "no configuration nowhere.yaml"),
        (
            ["benchmark", "--tolerance", "1e-6", "--tolerance", "1_0"],
            "'1_0' is not a number",
        ),
        (["benchmark", "--time-limit", "2 mm"], "that is a length; a time is needed"),
        (["simulate", "1", "2", "--mu", "1_000"], "1_000: it is not a number"),
        (["simulate", "1", "2", "--t-end", "1_0"], "'1_0' is not a number"),
        (["simulate", "1", "2", "--mass", "1 ton"], "1000 kg or, in America, 907.18"),
        (["verify", "nothing"], "no archive, folder or file 'nothing'"),
        (["claims", "--file", "nothing.nc"], "make them with: squealpipe run"),
        (
            ["basin", "1", "2", "--vx", "3", "--t-end", "20"],
            "a range of one or two of x, y, vx, vy",
        ),
    ],
)
def test_wrong_input_is_one_message_with_its_remedy(
    arguments, message, capsys, tmp_path
):
    assert run(arguments) == 2
    told = capsys.readouterr().err
    assert told.startswith("squealpipe: ")
    assert message in told
    assert "Traceback" not in told
    assert not list(tmp_path.iterdir())


@pytest.mark.usefixtures("real_pictures")
def test_propensity_writes_shares_and_a_picture(capsys):
    spread = [
        "--distribution",
        "mu=uniform:0.1:0.9",
        "--distribution",
        "alpha2=normal:55deg:3deg",
    ]
    command = [
        "propensity",
        "0.07pi",
        "0.305pi",
        *spread,
        "--samples",
        "64",
        "--t-end",
        "20",
    ]
    assert run([*command, "-o", "p.nc"]) == 0
    dataset = load("p.nc")
    assert dataset.input.values.tolist() == ["mu", "alpha2"]
    assert f"{float(dataset.share[0]):.2%}" in capsys.readouterr().out
    assert Path("p.png").stat().st_size > 0


@pytest.mark.release
def test_assess_answers_in_ten_lines_and_says_by_its_exit_code_whether_it_is_quiet(
    capsys, tmp_path
):
    pad = shlex.split(
        "--mass 0.45 --k1 1e7 --k2 1e7 --k3 7e6 --preload 5.714e-4 --belt-speed "
        "2 --length1 0.1 --length2 0.1 --damping1 42.4 --damping2 42.4"
    )
    assert run(["assess", "22deg", "46deg", *pad, "--mu", "0.4", "-o", "a.nc"]) == 1
    lines = capsys.readouterr().out.splitlines()
    assert (
        lines[-1] == "wrote a.nc and a.png"
    )  # who asked does not wait for the picture
    assert 5 <= len(lines[:-1]) <= 11
    assert lines[0].startswith("Hammers at 8")
    assert "(flutter)" in lines[1]
    assert any("angle alpha1: now 22°, quiet from" in line for line in lines)
    assert load("a.nc").attrs["schema"] == "assess"
    assert run(["assess", "22deg", "46deg", *pad, "--mu", "0.05"]) == 0
    assert capsys.readouterr().out.startswith("Quiet: ")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.nc", "a.png"]


@pytest.mark.usefixtures("real_pictures")
def test_simulate_writes_a_run_and_a_picture_and_sums_it_up(capsys, tmp_path):
    assert (
        run(["simulate", "5pi/6", "150deg", "--t-end", "30", "-o", "a/hammering.nc"])
        == 0
    )
    out = capsys.readouterr().out
    dataset = load("a/hammering.nc")
    first = float(dataset.event_time[0])
    assert f"t = {first:.6g}" in out
    for word in ("separated", "impacts", "peak contact force", "dominant", "rad/s"):
        assert word in out
    assert (tmp_path / "a/hammering.png").read_bytes().startswith(b"\x89PNG")
    assert json.loads(dataset.attrs["config"])["parameters"]["mu"] == 0.3


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (
            ["simulate", "0", "pi", "--x0", "15"],
            "singular_geometry (the mass met a pivot",
        ),
        (
            ["cycle", "0.305pi", "0.07pi", "--damping1", "1", "--t-settle", "50"],
            "no periodic mot",
        ),
    ],
)
def test_what_finds_no_answer_says_why(command, words, capsys):
    assert run(command) == 1
    assert words in capsys.readouterr().out


@pytest.mark.parametrize("kind", ["validity", "hammering", "quasi-static", "stability"])
def test_map_writes_dataset_and_picture(kind, capsys, tmp_path):
    angles = ["--alpha1", "0:pi:5", "--alpha2", "0.1,2.0"]
    horizon = ["--t-end", "20"] if kind in {"validity", "hammering"} else []
    assert run(["map", kind, *angles, *horizon]) == 0
    assert "cells" in capsys.readouterr().out
    assert load("map.nc").sizes["alpha1"] == 5
    assert (tmp_path / "map.png").is_file()


def test_backbone_follows_the_linear_mode_first(capsys):
    assert run(["backbone", "0.3pi", "0.9pi", "--y-peak-max", "1.5", "-o", "b.nc"]) == 0
    assert "amplitude_reached" in capsys.readouterr().out
    branch = load("b.nc")
    assert float(branch.y_peak.max()) == pytest.approx(1.5)


def test_sweep_writes_one_dataset(capsys):
    assert (
        run(
            shlex.split(
                "sweep stability_map --vary mu=0:0.6:3 --vary alpha1=0:pi:5 --alpha2 "
                "72deg --workers 1 -o s.nc"
            )
        )
        == 0
    )
    assert "3 runs" in capsys.readouterr().out
    assert dict(load("s.nc").growth_rate.sizes) == {"mu": 3, "alpha1": 5, "alpha2": 1}


def test_compare_tells_equal_from_different_by_its_exit_code(capsys):
    for name, friction in (("a", "0.2"), ("b", "0.2"), ("c", "0.4")):
        run(
            [
                "map",
                "stability",
                "--alpha1",
                "0:pi:7",
                "--mu",
                friction,
                "-o",
                f"{name}.nc",
            ]
        )
    assert run(["compare", "a.nc", "b.nc"]) == 0
    assert run(["compare", "a.nc", "c.nc"]) == 1
    out = capsys.readouterr().out
    assert re.search(r"parameters\.mu\W+0\.2\W+0\.4", out)
    assert re.search(
        r"\nequal: 1 dataset \(equal 1\), (\S+) of \1 values compared\n", out
    )
    assert run(["compare", "a.nc", "nowhere.nc"]) == 2
    capsys.readouterr()
    assert run(["compare", "a.nc", "c.nc", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["verdict"] == "different"


STICKS = ["--friction-law", "exponential", "--mu-static", "0.6", "--belt-speed", "0.5"]
STICKS += ["--damping1", "0.02", "--damping2", "0.02"]


@pytest.mark.usefixtures("real_pictures")
def test_cycle_and_branch_go_together(capsys):
    scene = ["0.1pi", "0.5pi", *STICKS]
    assert run(["cycle", *scene]) == 0
    assert "stable, 2 events" in capsys.readouterr().out
    found = load("cycle.nc")
    to = ["--parameter", "belt-speed", "--to", "0.55", "--n-points", "20"]
    assert run(["branch", *scene, *to, "--start", "cycle.nc"]) == 0
    assert "the branch ends: converged" in capsys.readouterr().out
    branch = load("branch.nc")
    assert float(branch.belt_speed[-1]) == pytest.approx(0.55, rel=1e-12)
    assert float(branch.period[0]) == pytest.approx(float(found.period), rel=1e-9)
    state = ",".join(
        str(float(found[f"{name}_start"])) for name in ("x", "y", "vx", "vy")
    )
    assert run(["cycle", *scene, "--guess", state, "-o", "again.nc"]) == 0
    assert float(load("again.nc").period) == pytest.approx(
        float(found.period), rel=1e-9
    )
    assert Path("branch.png").stat().st_size > 1000
    assert plot(branch).get_xlabel() == "V (m/s)"


@pytest.mark.parametrize(
    ("command", "words"),
    [
        (
            ["basin", "1", "2", "--vx", "-3:3:3", "--vy", "0,1", "--t-end", "20"],
            "of 6 cells",
        ),
        (
            ["disturbance", "0.75pi", "0.75pi", "--t-end", "20", "--directions", "8"],
            "found: 0.",
        ),
        (
            ["choose", "0.75pi", "0.75pi", "max_displacement", "--t-end", "20"],
            "displacement: 0.",
        ),
        (["infer", "--samples", "16", "--kappa", "0.64,0.66"], "of 16 sets meet every"),
        (
            ["refine", "--resolution", "17", "--coarse", "9", "--t-end", "5"],
            "of 289 cells",
        ),
    ],
)
def test_every_ability_has_a_command(command, words, capsys):
    assert run(command) == 0
    assert words in capsys.readouterr().out
    made = {path.suffix for path in Path().iterdir()}
    assert made == {"choose": set(), "infer": {".nc"}}.get(command[0], {".nc", ".png"})


def _own_defaults(command):
    """Arguments that a command's own source gives a default, and its text."""
    (node,) = ast.parse(inspect.getsource(command)).body
    pairs = zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True)
    return {a.arg: ast.unparse(d) for a, d in pairs if d is not None}


@pytest.mark.parametrize(
    "name", [name for name, command in COMMANDS.items() if hasattr(command, "task")]
)
def test_defaults_of_options_are_those_of_the_task(name):
    command = COMMANDS[name]
    task = inspect.signature(getattr(squealpipe, command.task)).parameters
    stated = inspect.signature(command).parameters
    known = {n for n in task if task[n].default is not inspect.Parameter.empty}
    own = _own_defaults(command)
    taken = (known & set(stated)) - set(own)
    assert taken
    assert {n: stated[n].default for n in taken} == {n: task[n].default for n in taken}
    # None leaves a range to the task
    assert {n for n in known & set(own) if own[n] != "None"} == set()
