"""Runs are found again by their parameters; one odd file hides no other."""

import json
import shutil

import pytest

from squealpipe.cli import run as command
from squealpipe.store import load, save
from squealpipe.store.runs import locate
from squealpipe.study.archive import archive
from squealpipe.study.catalogue import StoredRun, matching


@pytest.fixture(scope="module")
def two_archives(tmp_path_factory, write_run, keys_of):
    """A checkout with two archives of μ = 0.3 and 0.25 and a folder of results."""
    root = write_run(tmp_path_factory.mktemp("two") / "checkout")
    archive("first", keys=keys_of(root), root=root)
    write_run(root, mu=0.25)
    archive("second", keys=keys_of(root), root=root)
    return root


@pytest.fixture
def memory(two_archives, tmp_path, monkeypatch):
    """A copy of it, as the current folder."""
    root = shutil.copytree(two_archives, tmp_path / "checkout")
    monkeypatch.chdir(root)
    return root


def told(capsys, *arguments):
    code = command(list(arguments))
    return code, capsys.readouterr().out.splitlines()


@pytest.mark.parametrize(
    ("expression", "names"),
    [
        ("mu == 0.25", ["second", "results"]),
        ("mu == 0.25 and L1 > 4", ["second", "results"]),
        ("mu > 0.25 or not k3 == 0.65", ["first"]),
        ("0.2 < mu <= 0.25 and linear.points in [13, 31]", ["second", "results"]),
        ("length1 / l_pre == 15 and mu * 4 == 1", ["second", "results"]),
        (
            "damping1 == 0 and mu_static < 0.3 and friction_law == 'coulomb'",
            ["second", "results"],
        ),
    ],
)
def test_find_prints_the_runs_that_match(memory, capsys, expression, names):
    assert told(capsys, "find", expression) == (0, names)


@pytest.mark.parametrize(
    ("law", "holds", "fails"),
    [
        ("linear 0:0.6 1:0.4 5:0.2", "mu == 0.2 and mu_static == 0.6", "mu == 0.3"),
        ("exponential", "mu == 0.3 and mu_static == mu", "mu_static > mu"),
        (
            "def coefficient(speed, p):\n    raise SystemExit\n",
            "mu == 0.3 and not mu_static > 0",
            "mu_static == mu",
        ),
    ],
)
def test_a_law_says_what_mu_and_mu_static_are(law, holds, fails):
    """A law in Python is somebody's code, which a search does not run."""
    config = {"parameters.mu": 0.3, "parameters.friction_law": law}
    kept = [StoredRun(name="kept", date="", commit="", size=0, config=config)]
    assert matching(holds, kept) == ["kept"]
    assert matching(fails, kept) == []


def test_a_table_of_contact_says_what_k3_is():
    config = {"parameters.contact_law": "linear 0:0 1:0.5 2:2"}
    kept = [StoredRun(name="kept", date="", commit="", size=0, config=config)]
    assert matching("k3 == 0.5", kept) == ["kept"]


def test_find_tells_by_its_exit_code_that_there_is_none(memory, capsys):
    assert told(capsys, "find", "mu == 0.9") == (1, ["no run fulfils it"])
    assert told(capsys, "find", "mu == 0.9", "--json") == (1, ["[]"])


@pytest.mark.parametrize(
    "expression",
    ["mu = 0.25", "mu", "1", "muu == 1", "mu < 'a'", "", "f'{mu}' == '0.3'"],
)
def test_what_is_no_condition_is_one_message(memory, capsys, expression):
    assert command(["find", expression]) == 2
    error = capsys.readouterr().err
    assert "Traceback" not in error


def test_list_tells_what_differs(memory, capsys):
    _, lines = told(capsys, "list")
    assert [line.split()[0] for line in lines] == ["name", "first", "second", "results"]
    found = json.loads("\n".join(told(capsys, "list", "--json")[1]))
    assert [run["faults"] for run in found] == [[], [], []]
    assert found[0]["changed"] == {"linear.points": 13}
    assert found[2]["config"] == {
        **found[2]["config"],
        "parameters.mu": 0.25,
        "linear.points": 13,
    }


def test_a_run_that_did_not_reach_its_report_is_unfinished(memory, capsys):
    rows = {line.split()[0]: line for line in told(capsys, "list")[1]}
    assert "unfinished" in rows["results"]
    assert "intact" in rows["first"]
    (memory / "results/report").mkdir()
    (memory / "results/report/index.html").write_text("")
    assert "intact" in told(capsys, "list")[1][-1]


def test_archives_of_the_checkout_are_known_everywhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert locate("reference").is_absolute()
    assert (locate("reference") / "manifest.json").is_file()
    with pytest.raises(FileNotFoundError, match=r"archives: .*reference"):
        locate("referense")


def test_unknown_names_get_the_nearest_one(memory, capsys):
    assert command(["find", "belt_sped == 1"]) == 2
    assert "did you mean 'belt_speed'?" in capsys.readouterr().err


@pytest.mark.parametrize(
    "name", ["results/data/odd.nc", "results/archive/first/data/stability_map.nc"]
)
def test_an_odd_file_is_named_and_hides_no_run(memory, capsys, name):
    path = memory / name
    path.unlink(missing_ok=True)
    path.write_bytes(b"no dataset")
    for arguments in (["list"], ["find", "mu > 0"]):
        assert command(arguments) == 0
        captured = capsys.readouterr()
        assert all(run in captured.out for run in ("first", "second", "results"))
        assert path.name in captured.err


def test_copies_and_datasets_of_another_study_are_named(memory, write_run, capsys):
    """Each is whole by itself; together they are no run."""
    data = memory / "results/data"
    shutil.copy(data / "stability_map.nc", data / "whirl.nc")
    other = write_run(memory / "other", mu=0.4) / "results/data/stability_map.nc"
    (data / "simulate").mkdir()
    save(load(other).assign_attrs(key=""), data / "simulate/F3.nc")
    assert command(["list"]) == 0
    error = capsys.readouterr().err
    assert "whirl.nc is a copy of data/stability_map.nc" in error
    assert "parameters.mu = 0.25, elsewhere 0.4" in error
