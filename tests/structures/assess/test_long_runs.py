"""What a structure with long runs is spared, against runs and eigenvalues."""

import numpy as np
import pytest
import xarray as xr

from squealpipe import Contact, Structure, assess, squealing_modes
from squealpipe.codes import Verdict
from squealpipe.structures.assess.assess import LongRuns
from squealpipe.structures.assess.cures import cures_of
from squealpipe.structures.assess.designs import Design, Structures, pushed
from squealpipe.study.report import answer as words
from squealpipe.study.report.answer import cure_lines, cures
from squealpipe.study.report.squealing import headline
from squealpipe.study.report.structure import not_examined
from squealpipe.study.structure_study import squealing
from squealpipe.systems.progress import shown

ROD = np.array([[1.2e7, -1.0e6], [-1.0e6, 8.0e6]])


def pad(**changes):
    """Flutter from mu = 0.26 on: along and across the belt are coupled by the rod and friction."""
    contact = Contact("pad", {1: 1.0}, {0: 1.0}, 6e6, 3000.0)
    arguments = {"damping": 8.0 * np.eye(2), "contacts": [contact], "load": 0}
    return Structure(0.5 * np.eye(2), ROD, **arguments | changes)


@pytest.mark.parametrize("seed", range(6))
def test_a_push_that_is_not_run_switches_nothing_and_dies_out(seed):
    """Slow belts make a push stick; there it has to be run."""
    random = np.random.default_rng(seed)
    belt = 10.0 ** random.uniform(-4.0, 1.0) * random.choice([-1.0, 1.0])
    design = Design.of(pad(mu=0.2 * random.random(), belt_speed=belt))
    family = Structures(1e-9, 0, 0, 1)
    assert family.is_quiet_linearly(design)
    (run,) = family.settle([pushed(design)])
    if family.push(design) is None:
        assert run.quiet
        assert not run.last.switched
    if run.last.switched:
        assert family.push(design) is not None
    # a belt of half the push's own speed
    plant = design.plant
    state = pushed(design).state
    fastest = np.abs(state[2:] @ plant.structure.tangentials).max()
    slow = design.slid(belt_speed=0.5 * fastest)
    assert family.push(slow) is not None


@pytest.mark.release
def test_long_searches_say_what_was_run_and_end_on_the_quiet_side(monkeypatch):
    whole = assess(pad(mu=0.5), samples=2, workers=1)
    monkeypatch.setattr(LongRuns, "work", 0)
    monkeypatch.setattr(LongRuns, "cures", 1)
    short = assess(pad(mu=0.5), samples=2, workers=1)
    assert int(short.verdict) == int(whole.verdict) != Verdict.quiet
    assert short.quiet_from.sortby("cure").values == pytest.approx(
        whole.quiet_from.sortby("cure").values, rel=2e-3, nan_ok=True
    )
    assert whole.cure_is_run.all()
    assert short.cure_is_run.values.tolist() == [True, *[False] * 4]
    nearest = short.isel(cure=0)
    thorough = whole.sel(cure=nearest.cure).quiet_from_any_start
    away = abs(nearest.quiet_from_any_start - nearest.value)
    assert float(away) >= 0.98 * float(abs(thorough - nearest.value))
    told = "\n".join(cure_lines(short))
    assert told.count("other starts were not run") == int(
        np.isfinite(short.quiet_from[1:3]).sum()
    )
    assert {each.any_start for each in cures(short)[1:]} == {"not run"}


def test_an_undamped_structure_that_does_not_settle_is_told_to_have_damping():
    said = []
    with shown(None, said.append):
        answer = squealing_modes(
            pad(mu=0.5, damping=None), samples=1, t_end=0.01, workers=1
        )
    assert int(answer.verdict) == Verdict.undetermined
    advice = "give it the damping that it has, like modal_damping: 0.001"
    assert advice in said[0]
    assert advice in headline(answer)
    damped = squealing_modes(pad(mu=0.5), samples=1, t_end=0.01, workers=1)
    assert advice not in headline(damped)


@pytest.mark.parametrize("work", [0, pytest.param(256, marks=pytest.mark.release)])
def test_a_study_follows_squeal_down_in_friction_where_runs_are_short(
    work, monkeypatch
):
    monkeypatch.setattr(LongRuns, "work", work)
    section = {"n_modes": None, "frequency_max": None}
    section |= {"samples": 1, "seed": 0, "t_end": None}
    answer = squealing(pad(mu=0.5).with_common_mu(), section, 1)
    assert ("onset_kind" in answer) == (work > 0)
    told = any(
        "as friction falls in small steps" in one for one in not_examined(answer)
    )
    assert told == (work == 0)


def test_a_strongest_line_that_wanders_is_told_and_no_shift_of_it():
    told = xr.Dataset(
        {
            "verdict": int(Verdict.hammers),
            "frequency": 2740.0,
            "frequency_error": 2700.0,
            "leading_frequency": 2850.0,
            "separated_fraction": 0.5,
            "peak_contact_force_over_preload": 3.0,
        }
    )
    wanders = "(at times another line is strongest: standard deviation 2.7 kHz)"
    assert words.headline(told).startswith(f"Hammers at 2.74 kHz {wanders}: contact")
    assert words.shift(told) == ""
    steady = told.assign(frequency_error=1.0)
    assert words.headline(steady).startswith("Hammers at 2.74 kHz: contact")
    # a shim of the brake, in grams
    assert words._value("shim", 0.00938, "kg") == "9.38 g"
    assert "3.9 % below the mode that grows fastest (2.85 kHz)" in words.shift(steady)


ALL = ("mu", "contact_stiffness", "preload", "modal_damping", "belt_speed")


@pytest.mark.parametrize("away", [1.0, -1.0])
@pytest.mark.parametrize(
    ("samples", "tried"),
    [(3, ("mu",)), pytest.param(8, ALL, marks=pytest.mark.release)],
)
def test_a_contact_that_sticks_for_good_does_not_squeal(
    away, samples, tried, monkeypatch
):
    """squealing_modes called it a torus, and a structure that had left the belt squealed, too.

    Beyond mu = 1.32 steady sliding diverges: to one side friction pulls the contact onto the belt.
    The other sign of what is across the belt turns the push round.
    """
    jams = Structure(
        np.eye(2),
        np.array([[1.0, 0.9 * away], [0.9 * away, 1.0]]),
        modal_damping=0.02,
        contacts=[Contact("pad", {1: away}, {0: 1.0}, 1.0, 1.0)],
        mu=1.5,
        belt_speed=0.5,
        load=[-2.28, -1.67 * away],
    )
    found = squealing_modes(jams, samples=samples, workers=1)
    assert int(found.verdict) == Verdict.undetermined
    assert not found.sizes["attractor"]
    assert (words.CARRIED in headline(found)) == (away < 0.0)

    def chosen(design, modifications):
        cures, units = cures_of(design, modifications)
        return {name: cures[name] for name in tried}, units

    # what stops it takes most of the time
    monkeypatch.setattr("squealpipe.structures.assess.assess.cures_of", chosen)
    told = assess(jams, samples=2, workers=1)
    assert set(told.cure.values) == set(tried)
    assert int(told.verdict) == int(told.sudden_verdict) == Verdict.undetermined
    pushed = words.CARRIED if away < 0.0 else ": the structure has left the belt, and"
    assert pushed in words.headline(told)
    assert words.CARRIED in words.headline(told, "sudden_")
