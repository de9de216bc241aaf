"""Captions, figures and report of other configurations say nothing that their data contradict."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
import xarray as xr

from squealpipe.models.refusals import without_extensions
from squealpipe.parameters import SCENES, Parameters
from squealpipe.schema import Outcome
from squealpipe.schema.claims import Verdict
from squealpipe.store.netcdf import save
from squealpipe.store.provenance import stamp
from squealpipe.study.claims.evidence import Run
from squealpipe.study.claims.judge import judge
from squealpipe.study.figures import declared
from squealpipe.study.figures.parts.style import save_figure
from squealpipe.study.report.build import TEMPLATES, write_report
from squealpipe.study.report.content import Made, gather, picture_files
from squealpipe.study.report.facts.cycles import how_it_ends
from squealpipe.study.report.facts.spread import drawn_elsewhere
from squealpipe.study.report.places import FIGURES
from squealpipe.tasks.dynamics.assumptions import linear_pull_map
from squealpipe.tasks.dynamics.hammering import hammering_map
from squealpipe.tasks.dynamics.runs import simulate, validity_map
from squealpipe.tasks.dynamics.whirl import transient_lifetimes, whirl_sizes
from squealpipe.tasks.inference.inference import infer_parameters
from squealpipe.tasks.linear.boundaries import stability_boundaries
from squealpipe.tasks.linear.maps import natural_frequencies, quasi_static_map, stability_map

STUDIES = {
    "less friction": Parameters(mu=0.25),
    "unequal springs": Parameters(length1=4.0, length2=7.0, k1=1.3, k2=0.8),
    "slow belt the other way": Parameters(belt_speed=-1.0),
    "dashpots and friction that falls": Parameters(
        damping1=0.05, damping2=0.02, friction_law="exponential", mu_static=0.6, friction_speed=50.0
    ),
}
LINEAR, NONLINEAR = np.linspace(0, np.pi, 41), np.linspace(0, np.pi, 9)

OUTCOMES = (
    r"coincide", r"round-off", r"as the paper says", r"no black", r"is empty", r"x grows",
    r"grow(s|ing)? to", r"does not grow", r"saturates", r"at the baseline", r"\bmostly\b",
    r"\balmost\b", r"everywhere", r"never reached", r"about \d", r"near \d", r"half of the map",
    r"differ little", r"modes have changed", r"moves in x alone", r"bends? to lower",
    r"keeps contact and the", r"lies? in the (grey|white)", r"lose half", r"converges to",
)  # fmt: skip
"""What only the data of one configuration can say, and therefore no fixed text of a figure."""

Datasets = Mapping[str, xr.Dataset]


def beyond_paper(params: Parameters) -> bool:
    return without_extensions(params) is not params


def datasets_of(params: Parameters) -> dict[str, xr.Dataset]:
    """A study of tiny grids and short runs."""
    made = {
        "quasi_static_map": quasi_static_map(params, LINEAR, LINEAR),
        "stability_map": stability_map(params, LINEAR, LINEAR),
        "validity_map": validity_map(params, NONLINEAR, NONLINEAR, t_end=50.0),
        "hammering_map": hammering_map(params, NONLINEAR, NONLINEAR, t_end=50.0),
        "whirl": whirl_sizes(params, abs(params.belt_speed) * np.array([0.5, 1.0]), t_end=300.0),
        "transient": transient_lifetimes(
            params, [abs(params.belt_speed)], samples=2, shown_samples=6, t_end=400.0
        ),
    }
    if not beyond_paper(params):
        made |= {
            "natural_frequencies": natural_frequencies(params, LINEAR, LINEAR),
            "stability_boundaries": stability_boundaries(params, points=41),
            "linear_pull": linear_pull_map(params, NONLINEAR, NONLINEAR),
            "parameter_inference": infer_parameters(params, samples=32),
        }
    for name in ("F2a", "F2b", "F2c", "F2d", "F3", "F4", "F5a", "F5b"):
        scene = SCENES[name]
        times = np.linspace(0.0, 50.0, 501)
        made[f"simulate/{name}"] = simulate(
            params, scene.alpha1, scene.alpha2, t_end=50.0, times=times
        )
    return made | {"claims": judge(params, made)}


@pytest.fixture(scope="module", params=STUDIES.values(), ids=STUDIES)
def study(request, tmp_path_factory) -> tuple[Parameters, Datasets, dict[str, Any], str]:
    """Parameters, datasets, the report's content and its words."""
    params, folder = request.param, tmp_path_factory.mktemp("study")
    datasets = {
        name: stamp(dataset, config={"parameters": params.as_dict()}, wall_time=0.1)
        for name, dataset in datasets_of(params).items()
    }
    made = {
        name: Made(path=save(dataset, folder / f"data/{name}.nc"), rule="make")
        for name, dataset in datasets.items()
    }
    figures = {}
    for name in FIGURES:
        found = declared.datasets_of(name, datasets)
        if found is not None:
            path = folder / f"figures/{name}.png"
            save_figure(declared.draw(name, datasets), [path])
            figures[name] = Made(path=path, rule="draw", datasets=tuple(found))
    assert len(figures) > (8 if beyond_paper(params) else 15)
    page, pdf = folder / "report/index.html", folder / "report/report.pdf"
    content = gather(made, figures, params, beyond_paper=beyond_paper(params), page=page)
    write_report(content, picture_files(content, figures), page, pdf)
    text = re.sub(r"<style.*?</style>|<[^>]+>", " ", page.read_text("utf-8"), flags=re.DOTALL)
    return params, datasets, content, " ".join(text.split())


def whirls(datasets: Datasets, params: Parameters) -> bool:
    here = datasets["whirl"].sel(belt_speed=params.belt_speed, method="nearest")
    names = str(here.motion.attrs["flag_meanings"]).split()
    values = list(here.motion.attrs["flag_values"])
    settled = abs(float(here.amplitude / here.amplitude_before) - 1) < 0.01
    own = float(here.belt_speed) == params.belt_speed
    return own and settled and int(here.motion) == values[names.index("whirl")]


def some_leave(datasets: Datasets) -> bool:
    return bool(np.isfinite(datasets["transient"].shown_lifetime.values).any())


def sliding_excludes_instability(datasets: Datasets) -> bool:
    unstable = datasets["stability_map"].regime_linear > 0
    sliding = datasets["quasi_static_map"]
    printed = (unstable & (sliding.possible_as_printed == 1)).any()
    return bool(~printed & (unstable & (sliding.possible == 1)).any())


SENTENCES: dict[str, Callable[[Parameters, Datasets], bool]] = {
    "its amplitude saturates": lambda params, data: whirls(data, params),
    "is a transient on the way to a limit cycle": lambda params, data: whirls(data, params),
    "once the mass passes the belt at belt": lambda params, data: bool(
        (data["whirl"].max_vx >= abs(params.belt_speed)).any()
    ),
    "the picture needs the exact boundaries": lambda params, _: beyond_paper(params),
    "is a chaotic transient": lambda _, data: some_leave(data),
    "what looks like a limit cycle is a transient": lambda _, data: some_leave(data),
    "leaves the motion of Fig. 4 by": lambda _, data: not some_leave(data),
    "rest on reading Eq. (11) literally": lambda _, data: sliding_excludes_instability(data),
    "not of the mechanics": lambda _, data: sliding_excludes_instability(data),
    "being of one length": lambda params, _: params.length1 == params.length2,
    "the belt runs along": lambda params, _: params.belt_speed < 0,
    "printed quotient is negative there": lambda params, _: params.belt_speed > 0,
    "is judged by the mirror image": lambda params, _: params.belt_speed < 0,
    "This run goes beyond the paper": lambda params, _: beyond_paper(params),
    "In A1 each spring also carries": lambda params, _: beyond_paper(params),
    "every figure of it": lambda _, data: "backbone/F10_mode1" in data,
    "Times were measured in this run": lambda _, data: "work_precision_integration" in data,
    "This run infers no parameters": lambda _, data: "parameter_inference" not in data,
    "hold in that set by construction": lambda _, data: "parameter_inference" in data,
    "Without dashpots and with": lambda params, _: beyond_paper(params),
    "Only four groups matter": lambda params, _: not beyond_paper(params),
    "They are the baseline": lambda params, _: params == Parameters(),
    "parameters of this run satisfy all of them": lambda _, data: bool(
        data["parameter_inference"].baseline_holds.all()
    ),
}
"""Sentence of the report → when it is true."""


def test_each_sentence_is_there_only_where_it_is_true(study) -> None:
    params, datasets, _, text = study
    wrong = [
        words for words, true in SENTENCES.items() if words in text and not true(params, datasets)
    ]
    assert wrong == []


def test_sentences_are_looked_for_by_words_that_the_report_has() -> None:
    """A reworded template must not leave a check behind that looks for nothing."""
    sources = [*(TEMPLATES / "sections").iterdir(), TEMPLATES.parent / "summary.py"]
    written = " ".join("".join(path.read_text("utf-8") for path in sources).split())
    written = re.sub(r'" f?"', "", written)
    assert [words for words in SENTENCES if words not in written] == []


def test_numbers_and_statements_are_written_as_people_write_them(study) -> None:
    """No hyphen for a minus, no 1e-08 and no name from the code, up to the provenance."""
    text = study[3].rpartition(" Provenance ")[0]
    assert re.findall(r"(?<![\w./])-\d.{9}|\d[eE][-−]\d|(?<!/)\bF\d+[a-z]?_[a-z]\w+", text) == []


def test_counts_of_the_summary_are_those_of_the_verdicts(study) -> None:
    _, datasets, content, text = study
    rows = content["statements"]["rows"] + content["misprints"]["rows"]
    assert len(rows) == datasets["claims"].sizes["claim"]
    for part in ("statements", "misprints"):
        for row in content[part]["tally"]:
            ids = {Verdict(int(v)).words for v in datasets["claims"].verdict.sel(claim=row["ids"])}
            assert ids == {row["verdict"]}
    holding = next(row for row in content["statements"]["tally"] if row["verdict"] == "holds")
    assert f"{len(holding['ids'])} hold" in content["summary"][0]
    assert len(content["summary"]) <= 10
    assert not re.search(r"\bNone\b|\bnan\b", " ".join(content["summary"]))
    assert "nan" not in text.split()


def test_numbers_of_the_sliding_sentence(study) -> None:
    _, datasets, content, _ = study
    unstable = datasets["stability_map"].regime_linear > 0
    possible = unstable & (datasets["quasi_static_map"].possible == 1)
    sentence = next(
        words for words in content["summary"] if "Eq. (11)" in words and "Fig. 6" in words
    )
    assert {int(unstable.sum()), int(possible.sum())} <= set(map(int, re.findall(r"\d+", sentence)))


def test_texts_of_figures_describe_and_hold_no_outcome(study) -> None:
    _, _, content, _ = study
    told = [
        (name, pattern)
        for name, picture in content["figures"].items()
        for pattern in OUTCOMES
        if re.search(pattern, f"{picture['caption']} {picture['alt']}", flags=re.IGNORECASE)
    ]
    assert told == []


@pytest.mark.parametrize("name", FIGURES)
def test_fixed_texts_of_every_figure_hold_no_outcome(name: str) -> None:
    module = declared._import(name)
    fixed = " ".join(text for text in (module.CAPTION, module.ALT) if isinstance(text, str))
    assert [pattern for pattern in OUTCOMES if re.search(pattern, fixed, re.IGNORECASE)] == []


def test_captions_made_from_data_name_their_angles() -> None:
    branch = xr.Dataset(attrs={"alpha1": 5 * np.pi / 6, "alpha2": 0.4 * np.pi})
    caption, _ = declared.texts("fig13", {"backbone/F13_mode1": branch})
    assert "(5π/6, 0.4π)" in caption


@pytest.mark.parametrize(
    ("params", "outside"),
    [
        (Parameters(), []),
        (Parameters(k2=1.4), ["k₂"]),
        (Parameters(mass=2.0, k1=1e6, k2=1.2e6, k3=7e5, mu=0.05), ["k₁", "k₂", "k₃", "μ"]),
    ],
)
def test_a_sample_that_does_not_surround_the_study_is_told(
    params: Parameters, outside: list[str]
) -> None:
    """The paper study's distributions are in its own units, and hold for no other study."""
    distributions = {
        "k1": {"distribution": "normal", "mean": 1.0, "std": 0.05},
        "k2": {"distribution": "normal", "mean": 1.0, "std": 0.05},
        "k3": {"distribution": "lognormal", "median": 0.75, "log_std": 0.1},
        "mu": {"distribution": "uniform", "low": 0.1, "high": 0.9},
        "alpha1": {"distribution": "normal", "mean": 0.22, "std": 0.05},
    }
    dataset = xr.Dataset(attrs={"arguments": json.dumps({"distributions": distributions})})
    assert drawn_elsewhere(Run(params, {"propensity": dataset})) == outside


@pytest.mark.parametrize(
    ("outcome", "stable", "words"),
    [
        (Outcome.equilibrium, 0, "comes to rest"),
        (Outcome.converged, 1, "settles on a stable limit cycle, in contact for 25 %"),
        (Outcome.converged, 0, "leads to an unstable limit cycle, in contact for 25 %"),
        (Outcome.no_convergence, 0, "no limit cycle that was found (no convergence)"),
    ],
)
def test_how_a_run_ends_is_said_in_words(outcome: Outcome, stable: int, words: str) -> None:
    cycle = xr.Dataset({"outcome": int(outcome), "stable": stable, "contact_fraction": 0.25})
    assert words in str(how_it_ends(Run(Parameters(), {"cycles/limit_F2d": cycle})))


def test_the_checks_can_fail() -> None:
    run = Run(Parameters(), {})
    assert not run
    assert re.search("|".join(OUTCOMES), "At the baseline black is empty in both.", re.IGNORECASE)
