"""What reaches a terminal: always the answer, in its own letters."""

import os
import shlex
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from squealpipe import Parameters, load, stability_map
from squealpipe.cli import run
from squealpipe.cli.console import current_session, working
from squealpipe.store.mistakes import ConfigError
from squealpipe.study.configuration.settings import read_study
from squealpipe.systems.progress import alone, stage

SHORT = ["simulate", "5pi/6", "5pi/6", "--t-end", "5"]


@pytest.mark.release
def test_simulate_works_where_the_terminal_is_ascii():
    surroundings = {**os.environ, "PYTHONIOENCODING": "ascii", "LANG": "C"}
    done = subprocess.run(
        [sys.executable, "-m", "squealpipe", *SHORT],
        env=surroundings,
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "impacts" in done.stdout.decode("ascii")


def test_a_log_has_the_time_that_is_left(capsys, monkeypatch):
    monkeypatch.setattr("squealpipe.study.progress.log.LOG_EVERY", 0.0)
    words = shlex.split("sweep stability_map --vary mu=0:1:5 --alpha1 1 --alpha2 2")
    assert run([*words, "--workers", "1", "-o", "s.nc"]) == 0
    told = capsys.readouterr().err.splitlines()
    assert told[1].startswith("sweep of stability_map: 40% done, about ")
    assert told[1].endswith(" left")
    assert run([*words, "--workers", "1", "-o", "t.nc", "-q"]) == 0
    assert capsys.readouterr().err == ""


def test_what_was_there_from_before_does_not_shorten_the_time_that_is_left(
    capsys, monkeypatch
):
    clock = iter([0.0, 1.0, 61.0])
    monkeypatch.setattr(current_session, "quiet", False)
    ours = SimpleNamespace(monotonic=lambda: next(clock))
    monkeypatch.setattr("squealpipe.study.progress.log.time", ours)
    with working("sweep"), alone() as show:
        show(0.5)  # a resumed sweep begins there
        show(0.6)  # a tenth in a minute
    assert capsys.readouterr().err == "sweep: 60% done, about 4 min 0 s left\n"


def test_symbols_of_the_paper_are_understood_or_name_their_key(tmp_path, capsys):
    grid = ["--alpha1", "0:pi:2", "--alpha2", "0:pi:2"]
    command = [
        "map",
        "stability",
        *grid,
        "--V",
        "-3",
        "--L1=7",
        "--m",
        "2",
        "-o",
        "m.nc",
    ]
    assert run(command) == 0
    found = load("m.nc").attrs["parameters"]
    for part in ('"belt_speed": -3.0', '"length1": 7.0', '"mass": 2.0'):
        assert part in found
    swept = shlex.split("sweep stability_map --vary L1=3,4 --alpha1 1 --alpha2 2")
    assert run([*swept, "--workers", "1", "-o", "s.nc"]) == 0
    assert load("s.nc").length1.values.tolist() == [3.0, 4.0]
    (tmp_path / "mine.yaml").write_text("parameters: {V: 3}\n")
    with pytest.raises(
        ConfigError, match=r"parameters\.V: unknown key; did you mean 'belt_speed'"
    ):
        read_study(tmp_path / "mine.yaml")
    capsys.readouterr()


def test_labels_are_words():
    from squealpipe import labels

    found = stability_map(Parameters(), np.linspace(0, np.pi, 9), [2.2])
    words = labels(found.regime_linear)
    assert set(np.unique(words)) <= {"stable", "flutter", "divergence"}
    assert words.dims == found.regime_linear.dims
    assert words.values[0, 0] in str(words)
    with pytest.raises(
        ValueError, match="array = 'growth_rate': a variable with flag_meanings"
    ):
        labels(found.growth_rate)


def test_a_stage_that_lasts_is_named_in_a_log(capsys, monkeypatch):
    """A search of ten minutes printed nothing."""
    waits = []

    class Timer:
        def __init__(self, seconds, call, arguments):
            waits.append(seconds)
            self.pass_by = lambda: call(*arguments)

        def start(self):
            self.pass_by()

        def cancel(self):
            waits.append("ended")

    monkeypatch.setattr("squealpipe.study.progress.log.threading.Timer", Timer)
    monkeypatch.setattr(current_session, "quiet", False)
    with working("squeal"), stage("the fewest modes that agree"):
        pass
    assert waits == [5.0, "ended"]
    assert capsys.readouterr().err == "squeal: the fewest modes that agree …\n"
