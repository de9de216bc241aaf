"""The report of a structure, on the example that ``init --structure`` writes."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.optimize import brentq

from squealpipe import Structure
from squealpipe.cli import run
from squealpipe.schema import Outcome, build
from squealpipe.store import save
from squealpipe.store.mistakes import ConfigError
from squealpipe.store.rerun.key import files_named_in, rule_key
from squealpipe.structures.assess.cures import cures_of
from squealpipe.structures.schema.fewer_points import fewer_points_schema
from squealpipe.study.configuration.settings import PAPER, parse_study, read_study
from squealpipe.study.report import structure as report
from squealpipe.study.report.build import write_document
from squealpipe.study.report.parts import Made
from squealpipe.study.structure_study import (
    answered,
    modes_over_friction,
    read_structure,
    settled_motion,
    squealing,
)
from squealpipe.systems.inputs.words import number

MU = 0.5


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("example")
    assert run(["init", str(folder / "pads.yaml"), "--structure"]) == 0
    return read_study(PAPER, folder / "pads.yaml")


@pytest.fixture(scope="module")
def section(study):
    return study.slice("structure")["structure"] | {"samples": 3}


@pytest.fixture(scope="module")
def modes(section):
    return modes_over_friction(read_structure(section), section)


@pytest.fixture(scope="module")
def answer(section):
    return squealing(read_structure(section), section, 1)


def test_friction_goes_no_further_than_the_limit_of_stick_allows(study):
    text = Path(study.structure.file).read_text(encoding="utf-8")
    folder = Path(study.structure.file).parent
    (folder / "limited.yaml").write_text(f"{text}\nmu_static: 0.6\n", encoding="utf-8")
    section = study.slice("structure")["structure"]
    limited = section | {"file": str(folder / "limited.yaml")}
    found = modes_over_friction(read_structure(limited), limited)
    assert MU < float(found.mu[-1]) <= 0.6
    assert MU in found.mu.values


def growths(mu, added=0.0):
    """Growth rates of both pads about steady sliding from numbers typed here, and numpy's own."""
    stiffness = np.zeros((4, 4))
    stiffness[:2, :2] = [[4e7, -1.2e7], [-1.2e7, 1e7]]
    stiffness[2:, 2:] = [[6e7, -1.4e7], [-1.4e7, 1e7]]
    stiffness += 4e6 * np.outer([0, 1, 0, 1], [0, 1, 0, 1])
    at_rest = stiffness + np.diag([0, 3e7, 0, 5e7])
    squares, shapes = np.linalg.eigh(at_rest / 0.4)
    damping = shapes @ np.diag(2 * (0.01 + added) * np.sqrt(squares)) @ shapes.T
    rubbing = at_rest.copy()
    rubbing[0, 1] += mu * 3e7
    rubbing[2, 3] += mu * 5e7
    first_order = np.block([[np.zeros((4, 4)), np.eye(4)], [-rubbing / 0.4, -damping]])
    values = np.linalg.eigvals(first_order)
    return values.real[np.argsort(-values.real)]


def onsets():
    """Frictions at which the first and the second pair of modes turn unstable."""
    first = brentq(lambda mu: growths(mu)[0], 0.1, 0.35)
    second = brentq(lambda mu: growths(mu)[2], 0.35, 0.5)
    return first, second


def test_both_onsets_and_the_added_damping_are_those_of_eigenvalues_from_numpy(
    modes, answer
):
    located = np.sort(modes.critical_mu.values[np.isfinite(modes.critical_mu.values)])
    assert located == pytest.approx(onsets(), abs=1e-8)
    damping = brentq(lambda added: growths(MU, added)[0], 0.0, 0.2)
    assert float(answer.added_damping) == pytest.approx(damping, rel=1e-6)


def fewer_points_of(growths, faces=1):
    """A dataset of the fastest growth rate and the number of modes by points; None: no sliding."""
    counts = [0 if each is None else len(each) for each in growths.values()]
    fastest = [max(each) if each else np.nan for each in growths.values()]
    outcomes = [
        Outcome.no_sliding_state if each is None else Outcome.converged
        for each in growths.values()
    ]
    values = {
        "contacts": [faces * each for each in growths],
        "unstable_modes": counts,
        "growth_rate": fastest,
        "frequency": [2851.94 if count else np.nan for count in counts],
        "outcome": outcomes,
    }
    arrays = {name: np.array(each) for name, each in values.items()}
    return build(fewer_points_schema, arrays, {"points": [*growths]})


@pytest.mark.parametrize(
    ("growths", "sentence"),
    [
        (
            {1: [], 2: [8.84, 91.6], 4: [], 8: [55.48], 16: [41.68], 20: [24.94]},
            (
                "All 20 points are needed: "
                "with 16 points the largest growth rate is 41.7 instead of 24.9 1/s."
            ),
        ),
        # one match among others is chance
        (
            {1: [3.0], 2: [], 4: [2.0, 1.0], 5: [7.0]},
            ("All 5 points are needed: with 4 points 2 modes grow instead of 1."),
        ),
        ({1: [], 2: [], 3: []}, "From 1 point on no mode grows, as with all 3."),
        (
            {1: [2.0], 2: None, 3: []},
            "All 3 points are needed: with 2 points it is not known (no sliding state).",
        ),
        (
            {1: [], 2: [30.0], 4: [21.0], 5: [20.0]},
            (
                "From 4 points on as many modes grow as with all 5, and the largest growth rate "
                "is within 10 % of theirs; with 2 points the largest growth rate is 30 instead "
                "of 20 1/s."
            ),
        ),
        ({1: [2.0], 2: [1.0], 3: None}, "With all 3 points: no sliding state."),
    ],
)
def test_the_report_says_from_which_number_of_points_on_the_answer_stays(
    growths, sentence
):
    told = report.points(fewer_points_of(growths))
    assert told["sentence"] == sentence
    assert [row["points"] for row in told["rows"]] == [*map(str, growths)]


def test_points_are_those_of_each_face_where_there_are_several():
    told = report.points(fewer_points_of({1: [], 2: [], 3: []}, faces=2))
    of_each = "From 1 point for each face on no mode grows, as with all 3."
    assert told["sentence"] == of_each


def test_without_faces_or_with_two_points_there_is_no_table_of_points():
    assert report.points(None)["rows"] == []
    assert report.points(fewer_points_of({1: [2.0], 2: []}))["rows"] == []


def two_cures(*design):
    """Friction and damping alone."""
    cures, units = cures_of(*design)
    return {name: cures[name] for name in ("mu", "modal_damping")}, units


@pytest.fixture(scope="module")
def content(section, modes, answer, tmp_path_factory):
    """The report's content from files, as the workflow makes it."""
    structure = read_structure(section)
    with pytest.MonkeyPatch.context() as patch:
        # what is told is told of each alike, and the search for each takes most of the time
        patch.setattr("squealpipe.structures.assess.assess.cures_of", two_cures)
        told = answered(structure, section, answer, {}, 1)
    datasets = {
        "modes": modes,
        "squeal": answer,
        "assess": told,
        "run": settled_motion(structure, section, answer),
        "fewer_points": fewer_points_of(
            {1: [], 2: [8.84, 91.6], 4: [55.48], 5: [24.9]}
        ),
    }
    folder = tmp_path_factory.mktemp("data")
    made = {
        f"structure/{name}": Made(
            path=save(each, folder / f"{name}.nc"), rule="rule", datasets=()
        )
        for name, each in datasets.items()
    }
    return report.gather_structure(made, {})


def test_the_answer_comes_first_and_says_mode_sound_cause_and_remedy(
    content, modes, tmp_path
):
    said = content["headline"]
    assert said.startswith("Hammers at 1.")
    first, second = (number(each) for each in onsets())
    cause = content["lines"][0]
    assert cause.index(f"mu = {first} on (flutter)") < cause.index(f"mu = {second} on")
    damping = brentq(lambda added: growths(MU, added)[0], 0.0, 0.2)
    boundaries = {row["name"]: row["quiet_from"] for row in content["cures"]}
    assert boundaries["mu"] == first
    own = float(boundaries["modal_damping"].removesuffix(" %"))
    assert own == pytest.approx(100.0 * (damping + 0.01), rel=5e-3)
    assert any(f"quiet from {first} (−42 %)" in line for line in content["cheapest"])
    (mu,) = (row for row in content["cures"] if row["name"] == "mu")
    assert mu["intervals"].startswith("0 to ")
    assert [row["critical"] for row in report.onsets(modes)] == [
        number(each, 4) for each in onsets()
    ]
    page = tmp_path / "index.html"
    write_document(
        "structure",
        content | {"operating": ["Quiet at all 4 operating points."]},
        {},
        page=page,
        pdf=tmp_path / "report.pdf",
        media={"structure": "<video controls></video>"},
    )
    text = page.read_text(encoding="utf-8")
    place = text.index("Seen and heard</h2>")
    assert place < text.index("<video controls></video>") < text.rindex("What becomes")
    assert text.index(said) < text.rindex("What becomes of each unstable mode")
    assert content["points"]["sentence"] in text
    assert "Quiet at all 4 operating points." in text
    assert '<td data-label="Largest growth rate (1/s)">55.5</td>' in text
    assert '<td data-label="All that is quiet after a push">' in text


def test_the_cause_of_quiet_is_told(section, answer):
    pads = Structure.read(section["file"])
    modes = pads.complex_modes(mu=[0.0, 0.1, 0.2, 0.3, 0.4])
    quiet = modes.assign_attrs(
        parameters=modes.attrs["parameters"].replace('"mu": 0.5', '"mu": 0.2')
    )
    still = answer.copy()
    still["pole_growth_rate"] = -np.abs(answer.pole_growth_rate)
    assert report.cause(quiet, still) == (
        "Steady sliding is stable: small motions die out."
    )


def test_an_edited_matrix_file_changes_the_key_of_the_rule(study, section):
    file = Path(section["file"])
    part = study.slice("structure")
    before = rule_key(part, [])
    matrix = file.with_name("stiffness.mtx")
    text = matrix.read_text()
    matrix.write_text(text.replace("6.0e7", "6.1e7"))
    assert rule_key(part, []) != before
    matrix.write_text(text)
    assert rule_key(part, []) == before


def test_a_configuration_of_a_structure_is_checked(tmp_path):
    overlay = {"paper": False, "structure": {"file": "none.yaml"}}
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(overlay))
    with pytest.raises(ConfigError, match=r"structure.file = 'none.yaml': no file"):
        read_study(PAPER, tmp_path / "mine.yaml")
    with pytest.raises(ConfigError, match="write paper: false"):
        parse_study({"structure": {"file": "a.yaml"}})
    scene = {"mine": {"alpha1": 0.5, "alpha2": 0.8}}
    with pytest.raises(ConfigError, match="another configuration"):
        parse_study({"paper": False, "scenes": scene, "structure": {"file": "a.yaml"}})
    with pytest.raises(ConfigError, match=r"structure\.samples"):
        parse_study({"paper": False, "structure": {"file": "a.yaml", "samples": 0}})
    units = {"file": "a.yaml", "t_end": "20 ms", "frequency_max": "10 kHz"}
    parsed = parse_study({"paper": False, "structure": units}).structure
    assert (parsed.t_end, parsed.frequency_max) == (0.02, 1e4)


def test_the_example_is_written_once_and_whole(tmp_path, capsys):
    file = str(tmp_path / "pads.yaml")
    assert run(["init", file, "--structure", "--own"]) == 2
    assert run(["init", file, "--structure"]) == 0
    assert run(["init", file, "--structure"]) == 2
    assert run(["init", str(tmp_path / "other.yaml"), "--structure"]) == 0
    assert run(["init", file, "--structure", "--force"]) == 0
    pads = read_structure(
        {"file": str(tmp_path / "pads/structure.yaml"), "frequency_max": None}
    )
    assert [contact.preload for contact in pads.contacts] == [2e3, 2e3]
    (tmp_path / "pads/structure.yaml").write_text(
        "mass: mass.mtx\nstiffness: stiffness.mtx\n"
    )
    file = str(tmp_path / "pads/structure.yaml")
    with pytest.raises(ValueError, match="names no contacts"):
        read_structure({"file": file, "frequency_max": None})
    (tmp_path / "pads/structure.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match=r"structure\.yaml: byte 1 is not"):
        read_structure({"file": file, "frequency_max": None})


def test_files_that_a_deck_includes_change_the_key(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "brake.inp").write_text(
        "*INCLUDE, INPUT=parts/nodes.inp\n** *INCLUDE, INPUT=old.inp\n"
    )
    (tmp_path / "old.inp").write_text("*NODE\n")
    (tmp_path / "parts/nodes.inp").write_text(
        "*Node, Input = n.txt\n*INCLUDE, INPUT=../brake.inp\n"
    )
    (tmp_path / "parts/n.txt").write_text("1, 0, 0, 0\n")
    for name in ("M.mas.gz", "M.dof"):
        (tmp_path / name).write_bytes(b"")
    (tmp_path / "brake.yaml").write_text("mass: M.mas.gz\nmesh: brake.inp\n")
    named = files_named_in({"structure": {"file": str(tmp_path / "brake.yaml")}})
    found = {Path(name).resolve().name for name in named}
    assert found == {
        "brake.yaml",
        "brake.inp",
        "nodes.inp",
        "n.txt",
        "M.mas.gz",
        "M.dof",
    }


def test_the_report_says_how_contacts_of_a_mesh_came_about(modes, answer):
    whole = json.loads(modes.attrs["parameters"])
    assert report.structure(modes, answer)["origins"] == []
    for each in whole["contacts"].values():
        each |= {"nodes": [5, 6, 7, 8, 9], "against": [], "area": 5.21e-5, "gap": 2e-4}
    of_mesh = modes.assign_attrs(parameters=json.dumps(whole))
    first = report.structure(of_mesh, answer)["origins"][0]
    assert first == {
        "name": "inner",
        "nodes": "5, 6, 7, 8, …",
        "against": "belt",
        "area": "52.1 mm²",
        "gap": "0.2 mm",
    }
