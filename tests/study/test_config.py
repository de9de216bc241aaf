"""A configuration: every mistake at once, in words; one meaning, one canonical slice."""

import math
import typing
from fnmatch import fnmatchcase
from functools import reduce
from operator import getitem
from pathlib import Path

import pytest
import yaml

from squealpipe.parameters import TABLE, Parameters, parameters_of
from squealpipe.store.mistakes import known_keys
from squealpipe.store.yaml_files import flat
from squealpipe.study.configuration.quantities import In, scales
from squealpipe.study.configuration.sections import Section
from squealpipe.study.configuration.settings import (
    ConfigError,
    Study,
    check_results_folder,
    json_schema,
    parse_study,
    read_study,
)
from squealpipe.systems.inputs.units import kind_and_example

ROOT = Path(__file__).resolve().parents[2]
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
    shown = Study().model_dump(
        mode="json", exclude={"structure", "modifications", "operating"}
    )  # of studies of their own
    assert written.keys() == flat(shown).keys()


def test_json_schema_is_generated_from_the_types():
    stored = (ROOT / "workflow/config/schema.json").read_text(encoding="utf-8")
    assert stored == json_schema(), (
        "run python -m squealpipe.study.configuration.settings"
    )


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


IN_OTHER_UNITS = {
    "kg": (1e3, "g"),
    "m": (1e6, "µm"),
    "s": (1e3, "ms"),
    "N": (1e-3, "kN"),
    "Pa": (1e-5, "bar"),
    "m s-1": (3.6, "km/h"),
    "N m-1": (1e-6, "kN/mm"),
    "N s m-1": (1e-3, "N s/mm"),
    "m2": (1e4, "cm^2"),
    "m-1": (1e-3, "1/mm"),
    "rad": (180 / math.pi, "deg"),
    "1": (100.0, "%"),
}


def marks(annotation):
    """What is said about units anywhere in an annotation, one for each key."""
    inner = [mark for part in typing.get_args(annotation) for mark in marks(part)]
    return [
        part for part in getattr(annotation, "__metadata__", ()) if isinstance(part, In)
    ] + inner


def keys_with_a_unit(model, stem=""):
    for name, entry in model.model_fields.items():
        found = [part for part in entry.metadata if isinstance(part, In)]
        if found := found + marks(entry.annotation):
            yield f"{stem}{name}", found[0]
        if isinstance(entry.annotation, type) and issubclass(entry.annotation, Section):
            yield from keys_with_a_unit(entry.annotation, f"{stem}{name}.")


def test_every_key_takes_a_unit(written):
    """A study written in other units throughout is the study in plain numbers."""
    own = "parameters: {mass: 0.45, k1: 2e7, k3: 7e6, preload: 5.7e-4, damping1: 3.5}"
    plain = read_study(PAPER, written(own))
    params = Parameters(**plain.parameters.model_dump())
    said, checked = plain.model_dump(mode="json"), 0
    for key, mark in keys_with_a_unit(Study):
        *above, name = key.split(".")
        section = reduce(getitem, above, said)
        if section.get(name) is None:
            continue
        factor, unit = IN_OTHER_UNITS[mark.units]
        if mark.of_study:
            factor *= scales(params)[mark.units]
        factor *= math.pi if mark.units == "rad" else 1.0

        def with_unit(value, factor=factor, unit=unit):
            if isinstance(value, dict):
                return {k: with_unit(v, factor, unit) for k, v in value.items()}
            if isinstance(value, list):
                return [with_unit(item, factor, unit) for item in value]
            return f"{value * factor!r} {unit}"

        section[name] = with_unit(section[name])
        checked += 1
    read = parse_study(said)
    assert checked > 35
    ours, theirs = (
        flat(read.model_dump(mode="json")),
        flat(plain.model_dump(mode="json")),
    )
    assert ours.keys() == theirs.keys()
    for key, value in theirs.items():
        assert ours[key] == (
            value
            if isinstance(value, str | bool | None)
            or value == list(map(str, value if isinstance(value, list) else []))
            else pytest.approx(value, rel=1e-14)
        ), key


def wrong(value):
    """A mass, or two where a list is needed, or by each name."""
    if isinstance(value, dict):
        return {name: wrong(one) for name, one in value.items()}
    return [wrong(one) for one in value] if isinstance(value, list) else "3 kg"


def test_every_key_refuses_another_kind_and_says_which_key_takes_it():
    shipped, checked = Study().model_dump(mode="json"), 0
    for key, mark in keys_with_a_unit(Study):
        *above, name = key.split(".")
        value = reduce(getitem, above, shipped).get(name)
        if mark.units == "kg" or isinstance(value, dict):
            continue
        told = wrong(value)
        for name in reversed(key.split(".")):
            told = {name: told}
        with pytest.raises(ConfigError) as refused:
            parse_study(told)
        message = str(refused.value)
        assert key in message
        if mark.units == "rad":
            assert "write 0.4pi, 2pi/5, 72deg or radians" in message
        else:
            assert (
                f"that is a mass; {kind_and_example(mark.units)[0]} is needed"
                in message
            )
            assert "a mass goes to mass" in message
        checked += 1
    assert checked > 35


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "parameters: {preload: 4 kN}",
            (
                "parameters.preload = '4 kN': that is a force; a length is needed, like 0.57 mm; a "
                "force goes to preload_force"
            ),
        ),
        (
            "parameters: {preload_force: 4 mm}",
            "parameters.preload_force = '4 mm': that is a length; a force is needed, like 4 kN",
        ),
        (
            "parameters: {preload_force: 4, preload: 1}",
            "preload_force stands for preload; keep",
        ),
        ("parameters: {preload_forse: 4}", "did you mean 'preload_force'?"),
        ("parameters: {pressure: 4 bar}", "pressure needs area"),
        (
            "parameters: {stiffness: {along: 1, across: 1, coupling: 3}}",
            "no two springs have",
        ),
        ("dynamics: {validity_horizon: 3 mm}", "that is a length; a time is needed"),
        ("cycles: {flutter: [54 deg, 3 mm]}", "that is a length; an angle is needed"),
        (
            "robustness: {distributions: {k1: {distribution: normal, mean: 4 kN, std: 1}}}",
            "that is a force; a stiffness is needed",
        ),
        (
            "scenes: {mine: {alpha1: 30deg, alpha2: 1, start: {vx: 1 mm}}}",
            "a speed is needed",
        ),
        ("linear: {points: 3 mm}", "linear.points = '3 mm'"),
    ],
)
def test_a_wrong_dimension_says_what_was_expected(written, text, expected):
    assert expected in complaint(written(text))


def test_a_unit_is_the_same_run(written):
    plain = read_study(
        PAPER, written("parameters: {preload: 5.7e-4, mu: 0.45, k1: 1e7}")
    )
    text = read_study(
        PAPER, written("parameters: {preload: 0.57 mm, mu: 45 %, k1: 10 kN/mm}")
    )
    assert repr(plain.slice("parameters")) == repr(text.slice("parameters"))


PAD = """
parameters:
  mass: 450 g
  k3: 7 kN/mm
  stiffness: {along: 12 kN/mm, across: 8 kN/mm, coupling: 1 kN/mm}
  preload_force: 4 kN
  damping_ratio: 1 %
scenes: {pad: {}, mine: {alpha1: 30deg, alpha2: 140deg, t_end: 20 ms}}
"""


def test_what_stands_for_parameters_replaces_those_below(written, tmp_path):
    study = read_study(PAPER, written(PAD))
    section = study.parameters
    assert section.preload == pytest.approx(4e3 / 7e6, rel=1e-15)
    assert section.k1 == section.k2 == 1e7
    assert section.damping1 == pytest.approx(0.02 * math.sqrt(1e7 * 0.45), rel=1e-15)
    assert study.slice("parameters")["parameters"].keys() < set(TABLE)
    assert [line.partition(":")[0] for line in section.became()] == [
        "stiffness along 12 kN/mm, across 8 kN/mm, coupling 1 kN/mm",
        "damping_ratio = 0.01",
        "preload_force = 4 kN",
    ]
    springs = section.stiffness.springs
    assert (study.scenes["pad"].alpha1, study.scenes["pad"].alpha2) == springs[1:]
    time_unit = math.sqrt(0.45 / 1e7)
    assert study.scenes["mine"].t_end == pytest.approx(0.02 / time_unit, rel=1e-15)

    def over(text):
        (tmp_path / "over.yaml").write_text(f"parameters: {text}")
        return read_study(
            PAPER, tmp_path / "mine.yaml", tmp_path / "over.yaml"
        ).parameters

    assert over("{preload: 1 mm}").preload == 1e-3
    assert over("{pressure: 10 bar, area: 10 cm^2}").preload == pytest.approx(1e3 / 7e6)
    assert over("{mass: 900 g}").damping1 == pytest.approx(0.02 * math.sqrt(1e7 * 0.9))
    with pytest.raises(
        ConfigError, match=r"parameters\.damping2: is needed, for damping_ratio"
    ):
        over("{damping1: 3}")
    assert over("{damping1: 3, damping2: 4}").damping2 == 4.0
