"""Files that commands write, and parameters that they take from a study."""

import errno
import fcntl
import json
import math
import os
import re
import shlex
import signal
import subprocess
import sys
import time
import warnings
from contextlib import ExitStack, chdir
from functools import partial
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pandas as pd
import pytest
import yaml

from squealpipe import (
    Parameters,
    convert,
    load,
    natural_frequencies,
    plot,
    save,
    simulate,
    spectrum,
    stability_map,
    summarize,
)
from squealpipe.cli import reservation, run
from squealpipe.plotting import picture
from squealpipe.store.whole_files import not_written
from squealpipe.study.configuration.settings import parse_study, read_study

read = partial(pd.read_csv, comment="#", float_precision="round_trip")
STABILITY = ["map", "stability", "--alpha1", "0:pi:5", "--alpha2", "0:2:3"]


def test_existing_files_are_overwritten_by_force_only(capsys, tmp_path):
    assert run([*STABILITY, "-o", "a.nc"]) == 0
    first = (tmp_path / "a.nc").read_bytes()
    assert run([*STABILITY, "-o", "a.nc", "--mu", "0.9"]) == 2
    assert "a.nc exists; add --force" in capsys.readouterr().err
    assert run([*STABILITY, "-o", "b.nc", "-p", "a.png"]) == 2
    assert (tmp_path / "a.nc").read_bytes() == first
    assert run([*STABILITY, "-o", "a.nc", "--mu", "0.9", "--force"]) == 0
    assert json.loads(load("a.nc").attrs["config"])["parameters"]["mu"] == 0.9


def test_one_of_two_commands_that_write_to_one_name_is_refused_before_it_computes(
    tmp_path, capsys
):
    words = [*STABILITY, "-o", "a.nc"]
    long = ["simulate", "0.4pi", "0.6pi", "--t-end", "1e6", "-o", "a.nc"]
    with subprocess.Popen(
        [sys.executable, "-m", "squealpipe", *long],
        cwd=tmp_path,
        stderr=subprocess.DEVNULL,
    ) as other:
        try:
            while not (tmp_path / ".a.nc.writing").exists():
                time.sleep(0.1)
            time.sleep(0.1)
            other.send_signal(signal.SIGSTOP)  # it holds the name all the same
            assert run(words) == 2
            told = capsys.readouterr().err
            assert "a.nc is being written by another command" in told
            assert run([*words, "--force"]) == 2
            assert run([*STABILITY, "-o", "b.nc"]) == 0
        finally:
            other.kill()  # the name is free again, however its holder ended
    assert run(words) == 0
    assert sorted(
        entry.name for entry in tmp_path.iterdir() if entry.suffix == ".nc"
    ) == ["a.nc", "b.nc"]
    assert not list(tmp_path.glob(".*"))


def test_a_file_that_another_command_has_just_finished_is_kept(
    tmp_path, monkeypatch, capsys
):
    reserve = reservation.reserve

    def late(path, *rest):
        path.write_text("theirs")
        reserve(path, *rest)

    monkeypatch.setattr("squealpipe.cli.output.reserve", late)
    assert run([*STABILITY, "-o", "a.nc"]) == 2
    assert "a.nc exists; add --force" in capsys.readouterr().err
    assert (tmp_path / "a.nc").read_text() == "theirs"


def test_a_lock_whose_holder_took_it_away_meanwhile_is_no_lock(tmp_path, monkeypatch):
    lockf, lock = fcntl.lockf, tmp_path / ".a.nc.writing"

    def late(*given):
        monkeypatch.setattr(fcntl, "lockf", lockf)
        lock.unlink()  # as its holder does when it ends
        lockf(*given)

    monkeypatch.setattr(fcntl, "lockf", late)
    with ExitStack() as held:
        reservation.reserve(tmp_path / "a.nc", held, "-o")
        assert lock.exists()  # so others see that the name is taken
    assert not lock.exists()


@pytest.mark.parametrize("words", [["-o", "~/x.nc"], ["--output=~/x.nc"]])
def test_a_tilde_that_the_shell_left_is_the_home_folder(tmp_path, monkeypatch, words):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert run([*STABILITY, *words]) == 0
    assert load(tmp_path / "home/x.nc").sizes["alpha1"] == 5


def test_tables_beside_a_csv_are_overwritten_by_force_only(capsys, tmp_path):
    once = ["simulate", "5pi/6", "5pi/6", "--t-end", "20", "-o", "run[1].csv"]
    assert run(once) == 0
    (tmp_path / "run[1].csv").unlink()
    beside = tmp_path / "run[1].event.csv"
    beside.write_text("mine")
    capsys.readouterr()
    assert run(once) == 2
    assert "run[1].event.csv exists; add --force" in capsys.readouterr().err
    assert beside.read_text() == "mine"
    assert run([*once, "--force"]) == 0
    assert beside.read_text() != "mine"


def test_pipes_are_left_alone(tmp_path):
    os.mkfifo(tmp_path / "pipe.nc")
    assert run([*STABILITY, "-o", "pipe.nc", "--force"]) == 2
    assert (tmp_path / "pipe.nc").is_fifo()


def test_csv_holds_the_numbers_of_the_dataset(tmp_path):
    assert run([*STABILITY, "-o", "s.nc"]) == 0
    assert run([*STABILITY, "-o", "t.csv"]) == 0
    table = read("t.csv").set_index(["alpha1", "alpha2"])
    dataset = load("s.nc")
    for (alpha1, alpha2), row in table.iterrows():
        cell = dataset.sel(alpha1=alpha1, alpha2=alpha2, method="nearest")
        assert row.growth_rate == float(cell.growth_rate)
    words = set(dataset.regime_linear.attrs["flag_meanings"].split())
    assert set(table.regime_linear) <= words
    assert "growth_rate [s-1]" in (tmp_path / "t.csv").read_text(encoding="utf-8")


def test_csv_of_a_run_has_its_events_beside_it(tmp_path):
    made = simulate(Parameters(), 5 * np.pi / 6, 5 * np.pi / 6, t_end=20.0)
    files = convert(made, tmp_path / "run.csv")
    assert [path.name for path in files] == ["run.csv", "run.event.csv"]
    np.testing.assert_array_equal(read(files[0]).x, made.x)
    events = read(files[1])
    np.testing.assert_array_equal(events.event_time, made.event_time)
    assert events.event_kind[0] == "separation"
    assert "# preload = 1.0 [m]" in files[0].read_text(encoding="utf-8")


def test_csv_of_a_sweep_has_the_longest_table_first(tmp_path, capsys):
    swept = shlex.split("sweep simulate --vary mu=0.1,0.3 --alpha1 2 --alpha2 2.5")
    assert run([*swept, "--option", "t_end=2", "--workers", "1", "-o", "s.csv"]) == 0
    table = read("s.csv")
    assert list(table.columns[:3]) == ["mu", "time", "x"]
    expected = simulate(Parameters(mu=0.1), 2.0, 2.5, t_end=2.0)
    np.testing.assert_array_equal(table.x[table.mu == 0.1], expected.x)
    assert "other dimensions are in s.mu.csv" in capsys.readouterr().out


def test_parameters_come_from_a_study_unless_they_are_typed(tmp_path):
    (tmp_path / "soft.yaml").write_text("parameters: {k1: 2.0, k3: 0.6, mu: 0.1}\n")
    assert (
        run(
            shlex.split(
                "map frequencies -c soft.yaml --k3 3 --alpha1 1,2 --alpha2 0.5,0.7 -o "
                "f.nc"
            )
        )
        == 0
    )
    expected = natural_frequencies(
        Parameters(k1=2.0, k3=3.0, mu=0.1), [1.0, 2.0], [0.5, 0.7]
    )
    np.testing.assert_array_equal(load("f.nc").omega, expected.omega)
    state = ["--x0", "0.2", "--y0=-0.1", "--vx0", "0.3", "--vy0", "0.4"]
    assert run(["simulate", "2", "2.5", "--t-end", "5", "--points", "20", *state]) == 0
    given = {"times": np.linspace(0, 5, 20), "initial_state": (0.2, -0.1, 0.3, 0.4)}
    expected = simulate(Parameters(), 2.0, 2.5, t_end=5.0, **given)
    np.testing.assert_array_equal(load("run.nc").y, expected.y)


def test_sweep_states_outcomes_and_their_remedies(capsys):
    assert (
        run(
            shlex.split(
                "sweep periodic_orbit --vary y_peak=1.1:3:4 --vary mu=0.1,0.3 --option "
                "mode=1 --alpha1 0.3pi --alpha2 0.9pi --k3 0.75 --workers 1"
            )
        )
        == 0
    )
    out = capsys.readouterr().out
    assert "outcome of 8 runs: converged 4, tongue_end 4" in out
    assert "tongue_end: the branch closes" in out


def test_quiet_prints_the_answer_alone_and_warnings_do_not_leak(capfd):
    assert run([*STABILITY, "-q"]) == 0
    out, err = capfd.readouterr()
    assert "wrote" not in out
    assert (out.count("\n"), err) == (1, "")


def test_unexpected_errors_are_one_line_and_a_traceback_on_request(capsys, monkeypatch):
    def broken(*_, **__):
        warnings.warn("internal", RuntimeWarning, stacklevel=2)
        return {}["nothing"]

    monkeypatch.setattr("squealpipe.stability_map", broken)
    assert run(STABILITY) == 2
    assert capsys.readouterr().err == (
        "squealpipe: unexpected error (KeyError: 'nothing'); "
        "-v or SQUEALPIPE_TRACEBACK=1 shows where\n"
    )
    assert run(["-v", *STABILITY]) == 2
    assert "Traceback" in capsys.readouterr().err
    monkeypatch.setenv("SQUEALPIPE_TRACEBACK", "1")
    assert run(STABILITY) == 2
    assert "Traceback" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("word", "stream", "code"), [("no", "stderr", 2), ("--help", "stdout", 0)]
)
def test_a_reader_that_goes_away_leaves_the_exit_code(word, stream, code):
    program = "from squealpipe.cli import main; main()"
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as pipe:
        streams = {"stderr": subprocess.PIPE, stream: pipe}
        ignore = partial(signal.signal, signal.SIGPIPE, signal.SIG_IGN)
        command = [sys.executable, "-c", program, word]
        done = subprocess.run(command, check=False, preexec_fn=ignore, **streams)
    assert (done.returncode, done.stderr or b"") == (code, b"")


def test_init_writes_an_overlay_of_the_paper_to_edit(tmp_path, capsys):
    assert run(["init", "mine.yaml"]) == 0
    assert run(["init", "mine.yaml"]) == 2
    text = (tmp_path / "mine.yaml").read_text(encoding="utf-8")
    study = read_study("mine.yaml")
    assert study.results == "results/mine"
    assert study.parameters == parse_study({}).parameters
    body = text[text.index("\n\n") :]
    assert "  # damping1: 0.0 # " in text
    live = "\n".join(line.removeprefix("# ") for line in body.splitlines())
    assert parse_study(yaml.safe_load(live)).slice("dynamics") == parse_study({}).slice(
        "dynamics"
    )
    assert "squealpipe run --config mine.yaml" in capsys.readouterr().out


def test_completion_is_offered(capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", str(tmp_path))
    assert run(["--install-completion", "--shell", "bash"]) == 0
    written = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert any("backbone" in path.read_text(encoding="utf-8") for path in written)


def test_a_map_that_does_not_fit_is_refused_with_what_it_would_take(
    capsys, monkeypatch
):
    begun = Mock(side_effect=AssertionError("it would take all memory"))
    monkeypatch.setattr("squealpipe.stability_map", begun)
    words = ["map", "stability", "--alpha1", "0:pi:30000", "--alpha2", "0:pi:30000"]
    assert run([*words, "-o", "big.nc"]) == 2
    told = capsys.readouterr().err
    assert "900,000,000 cells would take about" in told
    assert "fit: take fewer angles" in told


def test_a_big_map_says_what_it_takes_before_it_begins(capsys, monkeypatch):
    monkeypatch.setattr("squealpipe.cli.long_work.MANY_CELLS", 100)
    words = ["map", "stability", "--alpha1", "0:pi:40", "--alpha2", "0:pi:40"]
    assert run([*words, "-o", "map.nc"]) == 0
    assert capsys.readouterr().out.startswith("1,600 cells: at most about ")


def test_options_may_follow_negative_angles(capsys):
    assert run(["simulate", "-o", "a.nc", "--", "-0.2pi", "0.3pi", "--t-end", "2"]) == 0
    assert load("a.nc").attrs["arguments"].count("-0.62831") == 1


def test_a_study_of_a_disc_is_one_of_a_structure(tmp_path):
    assert run(["init", "both.yaml", "--structure", "--disc"]) == 0
    assert run(["init", "disc.yaml", "--disc"]) == 0
    both = Path("both.yaml").read_text(encoding="utf-8")
    assert both.replace("both", "disc") == Path("disc.yaml").read_text("utf-8")
    assert run(["init", "other.yaml", "--own", "--disc"]) == 2


def test_what_init_writes_is_what_run_reads(capsys):
    assert run(["init", "brake 1.yaml"]) == 0
    assert "run --config 'brake 1.yaml'" in capsys.readouterr().out
    assert read_study("brake 1.yaml").results == "results/brake_1"


def test_an_interrupt_while_the_picture_is_drawn_tells_how_to_go_on(
    capsys, monkeypatch, tmp_path
):
    with monkeypatch.context() as patch:
        patch.setattr(
            "squealpipe.plotting.style.save_figure", Mock(side_effect=KeyboardInterrupt)
        )
        assert run([*STABILITY, "-o", "a.nc"]) == 130
    told = capsys.readouterr().err
    remedy = re.search(r"a.nc is written; squealpipe (plot .*) draws it", told)[1]
    assert run(remedy.split()) == 0
    assert (tmp_path / "a.png").is_file()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "parameters: {friction_law: {table: }}",
            "table = None: write the name of a file",
        ),
        ("parameters: {? [a, b] : 3}", "line 1 .* a key that is a list"),
        ("a: &x [*x]", r"line 1 .* alias \*x; write the value out"),
    ],
)
def test_odd_yaml_is_named_with_its_remedy(capsys, tmp_path, text, message):
    (tmp_path / "odd.yaml").write_text(text + "\n")
    assert run(["simulate", "1", "2", "--t-end", "1", "--config", "odd.yaml"]) == 2
    assert re.search(message, capsys.readouterr().err)


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ("def coefficient(speed, p):\n    raise KeyError('x')", "KeyError: 'x'"),
        ("def coefficient(speed, p):\n    return 1 / 0", "ZeroDivisionError"),
        ("def coefficient(speed, p):\n    raise SystemExit(3)", "SystemExit: 3"),
        ("def coefficient(speed):\n    return 0.3", "takes 1 positional argument"),
        (
            "import helper\ndef coefficient(speed, p):\n    return 0.3",
            "a law is one file",
        ),
    ],
)
def test_faults_inside_a_law_are_told_as_such(
    capsys, tmp_path, monkeypatch, law, message
):
    monkeypatch.syspath_prepend(".")  # as `python -m squealpipe` does
    (tmp_path / "law.py").write_text(law + "\n")
    (tmp_path / "helper.py").write_text("")
    (tmp_path / "l.yaml").write_text("parameters: {friction_law: {python: law.py}}\n")
    assert run(["simulate", "1", "2", "--t-end", "1", "--config", "l.yaml"]) == 2
    told = capsys.readouterr().err
    assert message in told
    assert "friction_law" in told
    assert "unexpected error" not in told


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("import sys\nsys.exit(2)\n", "own.py, line 2, failed with SystemExit: 2"),
        ("\n\n1 / 0\n", "own.py, line 3, failed with ZeroDivisionError"),
        (
            "def half(x):\n    return 1 / x\n\n\nhalf(0)\n",
            "own.py, line 2, failed with ZeroDivisionError",
        ),
        ("from squealpipe import Sytem\n", "own.py, line 1, failed with ImportError"),
        ("def f(:\n", "own.py, line 1, failed with SyntaxError"),
        ("import helper\n", "a system is one file, so put its code in there"),
        (
            (
                "from squealpipe import System\nown = System('own', states={'x': 'm'}, "
                "parameters={}, switches=[], regimes={'free': {}}, start={'x': 0}, "
                "field=lambda t, s, p, r: {'x': s.y})"
            ),
            "has no 'y'; choose from x",
        ),
    ],
)
def test_faults_inside_the_file_of_a_system_are_told_as_such(
    capsys, tmp_path, monkeypatch, text, message
):
    monkeypatch.syspath_prepend(".")
    (tmp_path / "own.py").write_text(text)
    (tmp_path / "helper.py").write_text("")
    words = ["sweep", "own.py:own", "--vary", "x0=0:1:3", "--option", "t_end=1"]
    assert run([*words, "-o", "a.nc"]) == 2
    told = capsys.readouterr().err
    assert message in told
    assert "unexpected error" not in told


def test_a_picture_that_finds_the_disk_full_is_drawn_as_the_message_says(
    capsys, monkeypatch, tmp_path
):
    """To run the same command again, as it said, is refused: the dataset is there."""

    def full(figure, paths, **look):
        raise not_written(paths[0], OSError(errno.ENOSPC, "No space left on device"))

    with chdir(tmp_path):
        with monkeypatch.context() as patched:
            patched.setattr("squealpipe.plotting.style.save_figure", full)
            assert run(["simulate", "1", "2", "--t-end", "1"]) == 2
        told = capsys.readouterr().err
        assert "cannot write run.png: No space left" in told
        assert "run the same command again, with --force" in told
        remedy = re.search(r"squealpipe (plot .*) draws it", told)[1]
        assert run(remedy.split()) == 0
        assert Path("run.png").is_file()


def test_a_study_in_a_folder_that_cannot_be_written_says_what_to_do(
    capsys, tmp_path, read_only
):
    folder = tmp_path / "read_only"
    folder.mkdir()
    with read_only(folder), chdir(folder):
        assert run(["init"]) == 2
        told = capsys.readouterr().err
        assert "cannot write mine.yaml" in told
        assert "free space or fix permissions" in told
        assert run(["run"]) == 2
    told = capsys.readouterr().err
    assert f"cannot write {folder}" in told
    assert "free space or fix permissions, then run the same command again" in told


def test_a_study_that_failed_says_how_to_go_on(capsys, monkeypatch):
    monkeypatch.setattr("squealpipe.study.supervised.run_to_its_end", lambda *_: 1)
    assert run(["run"]) == 2
    told = capsys.readouterr().err
    assert (
        "results is not complete; correct what is reported above, then run the same"
        in told
    )
    locks = Path(".snakemake/locks")
    locks.mkdir(parents=True)
    (locks / "0.output.lock").touch()
    assert run(["run"]) == 2
    told = capsys.readouterr().err
    assert "(not started by squealpipe); wait for it or, if it is dead, delete" in told
    assert str(locks.resolve()) in told
    Path(".snakemake/squealpipe").mkdir()
    about = json.dumps({"pid": 7, "host": "another"})
    Path(".snakemake/squealpipe/7.json").write_text(about)
    assert run(["run"]) == 2
    assert "lock of this folder (process 7 on another)" in capsys.readouterr().err


def test_a_study_that_was_interrupted_says_that_it_goes_on(capsys, monkeypatch):
    """It said "nothing was kept", with four of five rules done."""
    stopped = Mock(side_effect=KeyboardInterrupt)
    monkeypatch.setattr("squealpipe.study.supervised.run_to_its_end", stopped)
    assert run(["run"]) == 130
    told = "squealpipe: interrupted; the same command goes on with the rules that are not done\n"
    assert capsys.readouterr().err.endswith(told)


@pytest.mark.usefixtures("real_pictures")
def test_a_picture_has_the_size_and_the_dots_of_a_journal(capsys):
    from PIL import Image

    look = ["--figure-size", "127mm x 101.6mm", "--dpi", "300"]
    assert run([*STABILITY, "-o", "a.nc", *look]) == 0
    assert run(["plot", "a.nc", "-o", "b.png", *look]) == 0
    assert Image.open("a.png").size == Image.open("b.png").size == (1500, 1200)
    assert run(["plot", "a.nc", "-o", "c.png", "--figure-size", "90"]) == 2
    assert "write for instance 90mmx60mm" in capsys.readouterr().err


def test_axes_take_the_units_that_are_asked_for_and_real_brakes_readable_ones():
    pad = Parameters(
        mass=0.45,
        k1=1e7,
        k2=1e7,
        k3=7e6,
        preload=5.7e-4,
        mu=0.4,
        belt_speed=2.0,
        length1=0.1,
        length2=0.1,
    )
    motion = simulate(pad, math.radians(22), math.radians(46), t_end=0.04)
    drawn = picture(motion)
    assert {axes.get_xlabel() for axes in drawn.axes} == {
        "t (ms)",
        "x (mm)",
        "frequency (kHz)",
    }
    asked = picture(motion, units=("µm", "Hz", "s"))
    path, spectrum = asked.axes[2:]
    assert (path.get_xlabel(), spectrum.get_xlabel()) == ("x (µm)", "frequency (Hz)")
    asked.canvas.draw()
    # what stands at a tick is the place of the tick in the other unit
    for axes, factor in ((path, 1e6), (spectrum, 0.5 / math.pi)):
        ticks = [tick for tick in axes.get_xticks() if tick > 0]
        words = axes.xaxis.get_major_formatter().format_ticks(ticks)
        assert [float(word) for word in words] == pytest.approx(
            [factor * tick for tick in ticks]
        )
    # the strongest line, read off the axis, is that of the dataset
    line = summarize(motion).dominant_frequency[0] / (2 * math.pi)
    marks = next(each for each in spectrum.lines if each.get_marker() == "v")
    assert marks.get_xdata()[0] * 0.5 / math.pi == pytest.approx(float(line))
    scaled = simulate(Parameters(), 2.0, 1.0, t_end=100.0)
    assert picture(scaled).axes[2].get_xlabel() == "x (m)"


def test_titles_have_the_angles_in_the_unit_that_is_asked_for():
    motion = simulate(Parameters(), math.radians(22), math.radians(45), t_end=20.0)
    words = picture(motion).get_suptitle()
    assert words == "α₁ = 0.1222π, α₂ = π/4, model A1"
    words = picture(motion, units=("deg",)).get_suptitle()
    assert words == "α₁ = 22°, α₂ = 45°, model A1"
    ends = np.linspace(0.0, math.pi, 5)
    drawn = picture(stability_map(Parameters(), ends, ends), units=("deg",))
    drawn.canvas.draw()
    ticks = [each.get_text() for each in drawn.axes[0].get_xticklabels()]
    assert drawn.axes[0].get_xlabel() == "α₁ (deg)"
    assert ticks == ["0", "45", "90", "135", "180"]


def test_the_picture_of_a_spectrum_ends_where_nothing_is_heard():
    time = np.linspace(0.0, 100.0, 4001)
    motion = simulate(Parameters(), 2.0, 1.0, t_end=100.0, times=time)
    lines = spectrum(motion)
    axes = plot(lines)
    highest = lines.frequency.values[
        np.flatnonzero(lines.contact_force > 0.01 * lines.contact_force.max())[-1]
    ]
    assert axes.get_xlim() == pytest.approx((0.0, 1.2 * highest))
    marks = next(line for line in axes.lines if line.get_marker() == "v")
    assert marks.get_xdata() == pytest.approx(lines.peak_frequency.values[:3])


@pytest.mark.parametrize(
    ("units", "message"),
    [
        (["--unit", "kPa"], "no axis of this picture measures that; its axes are in m"),
        (["--unit", "mm", "--unit", "m"], "measure the same; give one of them"),
        (["--unit", "furlongs_of_beer"], "no axis of this picture measures that"),
    ],
)
def test_units_that_no_axis_takes_are_refused(capsys, units, message):
    save(simulate(Parameters(), 2.0, 1.0, t_end=100.0), "run.nc")
    assert run(["plot", "run.nc", "-o", "a.png", *units]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.usefixtures("real_pictures")
def test_panels_that_nobody_could_read_are_refused_with_a_size_that_works(capsys):
    save(simulate(Parameters(), 2.0, 1.0, t_end=10.0), "run.nc")
    words = ["plot", "run.nc", "-o", "a.png", "--figure-size"]
    assert run([*words, "90mmx60mm"]) == 2
    told = capsys.readouterr().err
    needed = re.search(r"give (\S+) or more", told)[1]
    assert run([*words, needed]) == 0
    assert run([*words, "90mmx60mm", "--variable", "y", "--force"]) == 0
