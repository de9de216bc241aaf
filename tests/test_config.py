"""A configuration: every mistake at once, in words; one meaning, one canonical slice."""

import math
from fnmatch import fnmatchcase
from pathlib import Path

import pytest
import yaml

from squealpipe.config.mistakes import known_keys
from squealpipe.config.settings import (
    ConfigError,
    Study,
    check_results_folder,
    json_schema,
    read_study,
)
from squealpipe.config.yaml_files import flat
from squealpipe.parameters import Parameters, parameters_of

ROOT = Path(__file__).resolve().parents[1]
PAPER = ROOT / "workflow/config/paper.yaml"


@pytest.fixture
def written(tmp_path):
    def write(text):
        (tmp_path / "mine.yaml").write_text(text, encoding="utf-8")
        return tmp_path / "mine.yaml"

    return write


def complaint(path):
    with pytest.raises(ConfigError) as caught:
        read_study(path)
    return str(caught.value)


def test_every_mistake_is_told_at_once(written):
    numbers = (
        "{mass: -1, mu: heavy, k3: .nan, belt_speed: .inf, preload: true, lenght1: 5}"
    )
    more = "linear: {points: 61.5}\nmu: 0.4\ncolour: red\n"
    text = complaint(written(f"parameters: {numbers}\n{more}"))
    for expected in (
        "parameters.mass = -1: it must be greater than 0",
        "parameters.mu = 'heavy': a number is needed",
        "parameters.k3 = nan: ",
        "parameters.belt_speed = inf: ",
        "parameters.preload = True: a number is needed",
        "parameters.lenght1: unknown key; did you mean 'length1'?",
        "linear.points = 61.5: ",
        "mu: unknown key; did you mean parameters.mu",
        "colour: unknown key; known: ",
    ):
        assert expected in text


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("- 1\n- 2", "must hold keys and values, not list"),
        ("a: [1, 2", "line 1 is not plain YAML: expected ',' or ']'"),
        ("a: 1\nb: b: c", "line 2 is not plain YAML"),
        (
            "a:\n\t- b",
            "line 2 is not plain YAML: found character '\\t' that cannot start any",
        ),
        (
            "linear:\n  points: 2\n  points: 3",
            "line 3 is not plain YAML: key 'points' is a dupl",
        ),
        ("parameters: 5", "parameters = 5: keys and values are needed"),
        ("parameters: {mass: [1, 2]}", "parameters.mass = (1, 2)"),
        ("parameters: {mass: null}", "parameters.mass = None"),
        ("parameters: {mass: 2020-01-01}", "parameters.mass = '2020-01-01'"),
        ("1: 2", "1: unknown key"),
        ("results: a b; rm -rf x", "results = "),
        ("results: results/archive/reference", "outside results/archive"),
        ("results: results/./archive", "outside results/archive"),
        ("results: ../elsewhere", "a folder of its own"),
        ("results: /", "a folder of its own"),
    ],
)
def test_text_that_is_no_configuration(written, text, expected):
    assert expected in complaint(written(text))


@pytest.mark.parametrize(
    "text",
    [
        '!!python/object/apply:os.system ["touch ran"]',
        'parameters: {mass: !!python/object/apply:os.system ["touch ran"]}',
        "parameters: {mass: !!python/name:os.system }",
        '__use_yte__: true\nparameters:\n  mass: ?__import__("os").system("touch ran")',
    ],
)
def test_no_code_runs(written, text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = written(text)
    complaint(path)
    assert not Path("ran").exists()


def test_missing_file_and_folder(tmp_path):
    for path in (tmp_path / "none.yaml", tmp_path):
        with pytest.raises(FileNotFoundError, match="give a YAML file that exists"):
            read_study(path)


def test_quick_study_differs_in_grids_and_horizons_only():
    quick = flat(
        read_study(PAPER, ROOT / "workflow/config/quick.yaml").model_dump(mode="json")
    )
    paper = flat(Study().model_dump(mode="json"))
    assert not [
        key
        for key in paper
        if key.startswith("parameters.") and quick[key] != paper[key]
    ]


def test_overlay_keeps_what_it_does_not_name(written):
    study = read_study(PAPER, written("parameters: {mu: 0.4}"))
    assert parameters_of(study.slice("parameters")) == Parameters(mu=0.4)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("parameters: {mass: 1}", "parameters: {mass: 1.0}"),
        ("parameters: {sigma: 1000}", "parameters: {sigma: 1e3}"),
        ("parameters: {sigma: 1000}", "parameters: {sigma: 1.0e+3}"),
        ("linear: {points: 61}", "linear: {points: 61.0}"),
        ("linear: {points: 61}", "# a comment\nlinear:\n    'points' :   61  # more"),
        ("parameters: {mass: 2, mu: 0.1}", '{"parameters": {"mu": 0.1, "mass": 2.0}}'),
    ],
)
def test_one_meaning_has_one_slice(written, first, second):
    one, other = (
        repr(read_study(written(text)).slice("linear", "parameters"))
        for text in (first, second)
    )
    assert one == other


def test_default_values_are_those_of_the_paper_file():
    assert read_study(PAPER) == Study()
    written = flat(yaml.safe_load(PAPER.read_text()))
    assert written.keys() == flat(Study().model_dump(mode="json")).keys()


def test_json_schema_is_generated_from_the_types():
    stored = (ROOT / "workflow/config/schema.json").read_text(encoding="utf-8")
    assert stored == json_schema(), "run python -m squealpipe.config.settings"


def test_known_keys_reach_every_value():
    """Keys of a mapping, like names of scenes, are reached by its own key."""
    known = set(known_keys(Study))
    leaves = flat(Study().model_dump(mode="json"))
    unknown = {key for key in leaves if not {key, key.rpartition(".")[0]} & known}
    free = [key for key in known if "*" in key]  # sections by names of the user's
    assert {
        key for key in unknown if not any(fnmatchcase(key, each) for each in free)
    } == set()


SWEEP = """
sweeps:
  orbits:
    task: periodic_orbit
    vary: {mu: %s, y_peak: %s}
    fixed: {alpha1: %s, alpha2: 0.9pi, mode: %s}
"""


def test_ways_to_write_a_sweep_have_one_meaning(written):
    texts = [
        SWEEP % ('"0:0.6:3"', '"1.5,2"', "0.3pi", "1"),
        SWEEP % ("[0, 0.3, 0.6]", "[1.5, 2]", "54deg", "1.0"),
        SWEEP % ("0:0.6:3", '"1.5,2"', "0.3pi", "1"),
        SWEEP % ('[0, 3e-1, "0.6"]', '"1.5:2:2"', repr(0.3 * math.pi), '"1"'),
    ]
    forms = [read_study(PAPER, written(text)).sweep("orbits") for text in texts]
    assert forms[0] == forms[1] == forms[2]
    assert forms[0]["vary"] == {"mu": [0.0, 0.3, 0.6], "y_peak": [1.5, 2.0]}
    assert forms[0]["fixed"]["alpha1"] == 0.3 * math.pi
    assert "mu" not in forms[0]["parameters"]


def test_a_sweep_follows_the_parameters_that_it_does_not_name(written):
    text = SWEEP % ("[0.1]", "[2]", "0.3pi", "1")
    before = read_study(PAPER, written(text)).sweep("orbits")
    after = read_study(PAPER, written(text + "parameters: {mu: 0.5, k3: 0.5}")).sweep(
        "orbits"
    )
    assert after["parameters"].pop("k3") == 0.5
    assert before["parameters"].pop("k3") == 0.65
    assert before == after


@pytest.mark.parametrize(
    ("section", "expected"),
    [
        (
            "{vary: {mu: '0:0.6'}}",
            "vary = {'mu': '0:0.6'}: mu: '0:0.6' is not a range; write",
        ),
        ("{vary: {mu: heavy}}", "mu: 'heavy' is not a number; write for instance"),
        ("{vary: {mu: [1, x]}}", "mu: 'x' is not a number"),
        ("{vary: {}}", "sweeps.mine.vary = {}: 1 or more items are needed"),
        ("{vary: [1]}", "sweeps.mine.vary = (1,): names and values are needed"),
        ("{fixed: {alpha1: north}}", "'north' is not a valid angle; write 0.4pi"),
        ("{fixed: {k3: {a: 1}}}", "k3: {'a': 1} is not a value; write a number"),
        ("{fixd: {}}", "sweeps.mine.fixd: unknown key; did you mean 'fixed'?"),
    ],
)
def test_mistakes_in_a_sweep_are_named_with_their_remedy(written, section, expected):
    text = complaint(written(f"\nsweeps: {{mine: {section}}}"))
    assert expected in text
    assert "sweeps.mine.task" in text


@pytest.mark.parametrize(
    "text", ["", "# nothing yet\n", "parameters:\n", "parameters: {}\n"]
)
def test_an_empty_overlay_changes_nothing(text, written, tmp_path):
    assert read_study(PAPER, written(text)) == read_study(PAPER) == Study()
    (tmp_path / "base.yaml").write_text("parameters: {mu: 0.2}\n")
    assert read_study(tmp_path / "base.yaml", written(text)).parameters.mu == 0.2


def test_a_folder_of_results_holds_nothing_else(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in (
        "results/data",
        "results/quick/figures",
        "results/archive/first/data",
        "docs",
    ):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "docs/store.md").touch()
    (tmp_path / "results/archive/first/manifest.json").touch()
    for name in ("results", "results/new"):
        check_results_folder(name)
    with pytest.raises(
        ConfigError, match=r"holds docs/store\.md, which is not a result"
    ):
        check_results_folder("docs")
    (tmp_path / "theirs/data").mkdir(parents=True)
    (tmp_path / "theirs/data/measured.csv").touch()
    with pytest.raises(ConfigError, match=r"holds theirs/data/measured\.csv"):
        check_results_folder("theirs")
    (tmp_path / "link").symlink_to("results/archive/first")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/data").symlink_to(tmp_path / "results/archive/first/data")
    (tmp_path / "deep/data").mkdir(parents=True)
    (tmp_path / "deep/data/own").symlink_to(tmp_path / "results/archive/first/data")
    for name in ("link", "link/data", "mine", "deep"):
        with pytest.raises(ConfigError, match="leads into the archive"):
            check_results_folder(name)
