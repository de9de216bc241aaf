"""Checks are strict enough to fail: each statement flips when the data say something else."""

import numpy as np
import pytest
import xarray as xr

from squealpipe.codes import Event
from squealpipe.paper.claims import judge as judging
from squealpipe.paper.claims.checks import misprints
from squealpipe.paper.claims.statements import STATEMENTS
from squealpipe.paper.schema.claims import ClaimVerdict

HOLDS, FAILS = ClaimVerdict.holds, ClaimVerdict.fails


def put(name, value):
    """Replace a variable, keeping its attributes; its extremes are then those of the samples."""

    def change(dataset):
        between = [f"{name}_min", f"{name}_max"]
        dataset = dataset.drop_vars(between, errors="ignore")
        old = dataset[name]
        new = xr.broadcast(xr.DataArray(value(dataset)), old)[0].transpose(*old.dims)
        return dataset.assign({name: new.astype(old.dtype).assign_attrs(old.attrs)})

    return change


def scaled(name, factor):
    return put(name, lambda dataset: dataset[name] * factor)


def repeated(dataset):
    """A circle through the belt's edge, with a return each time."""
    time = dataset.time.values
    period = time[-1] / 40.0
    turn = 2.0 * np.pi * time / period
    returns = period * np.arange(1, 39)
    kinds = dataset.event_kind.attrs
    new = dataset.drop_vars(["event_time", "event_kind"])
    return new.assign(
        x=("time", np.cos(turn) + 0.3 * np.sin(turn)),
        vx=("time", (0.3 * np.cos(turn) - np.sin(turn)) * 2.0 * np.pi / period),
        y=("time", 1.0 - np.sin(turn)),
        vy=("time", -np.cos(turn) * 2.0 * np.pi / period),
        event_time=("event", returns),
        event_kind=("event", np.full(returns.size, int(Event.contact)), kinds),
    )


def without_events(dataset):
    return dataset.isel(event=slice(0, 0))


REGIME = put("regime_linear", lambda d: 0 * d.regime_linear)
EVERYWHERE_PRINTED = put("possible_as_printed", lambda d: 0 * d.possible + 1)
AS_PHYSICAL = put("possible_as_printed", lambda d: d.possible)
NEVER = put("possible", lambda d: 0 * d.possible)
HELD = put("held", lambda d: 0 * d.held + 1)
TOUCHING = put(
    "normalized_contact_force",
    lambda d: d.normalized_contact_force.where(np.arange(d.sizes["time"]) != 5, 0.0),
)
STAYS = put("normalized_contact_force", lambda d: 0.21 + 0.79 * (d.time < 1.0))
NO_GROWTH = put("x", lambda d: np.cos(d.time) + 0 * d.x)
SWINGS = put("x", lambda d: np.cos(d.time) * (1 + 0.3 * np.sin(d.time / 500)) + 0 * d.x)
GROWING = put("x", lambda d: d.x * (d.time / d.time[-1]) ** 2)
TWO_SHAPES = scaled("shape_similarity", 0.4)
SHIFTED, FASTER = put("omega", lambda d: d.omega + 0.1), scaled("omega", 1.1)
ONE_MODE = put("omega", lambda d: d.omega.where(d.mode == 1, d.omega.sel(mode=1)))
SEPARATED = put("omega", lambda d: 0 * d.omega + d.omega.sel(contact_state="separated"))
HALF = put(
    "omega",
    lambda d: d.omega.where((d.mode != 1) | (d.contact_state != "separated"), 0.5),
)
FLIPS = [
    ("T1", "assumptions", HELD, HOLDS),
    ("S1", "simulate/F2d", without_events, FAILS),
    ("S1", "simulate/F2d", scaled("return_peak_contact_force", 0.4), FAILS),
    ("S2", "assumptions", HELD, FAILS),
    ("S2", "assumptions", scaled("measure", 1e-3), FAILS),
    ("S3", "stability_map", REGIME, FAILS),
    ("S3", "stability_map", TWO_SHAPES, FAILS),
    ("F2a", "simulate/F2a", TOUCHING, FAILS),
    ("F2b", "simulate/F2b", TOUCHING, FAILS),
    ("F2c", "simulate/F2c", TOUCHING, FAILS),
    ("F2d", "simulate/F2d", without_events, FAILS),
    ("F2e", "simulate/F2b", scaled("normalized_contact_force", 0.5), FAILS),
    ("F2e", "simulate/F2d", STAYS, ClaimVerdict.cannot_be_decided),
    ("F3", "simulate/F3_long", NO_GROWTH, FAILS),
    ("F3", "simulate/F3_long", SWINGS, ClaimVerdict.cannot_be_decided),
    ("F4", "simulate/F4_long", repeated, HOLDS),
    ("F4", "simulate/F4_long", without_events, ClaimVerdict.cannot_be_decided),
    ("F5a", "simulate/F5b", scaled("normalized_contact_force", 1 + 1e-8), FAILS),
    ("F5b", "simulate/F5a", without_events, FAILS),
    ("F6a", "quasi_static_map", AS_PHYSICAL, HOLDS),
    ("F6b", "quasi_static_map", EVERYWHERE_PRINTED, FAILS),
    ("F6b", "corrected/quasi_static_map", NEVER, HOLDS),
    ("F6c", "corrected/stability_map", REGIME, HOLDS),
    ("F6c", "quasi_static_map", EVERYWHERE_PRINTED, FAILS),
    (
        "F6d",
        "at_scenes/stability_map",
        put("growth_rate", lambda d: 0 * d.growth_rate + 1e-3),
        FAILS,
    ),
    ("F6d", "simulate/F3_long", NO_GROWTH, FAILS),
    ("F6e", "linear_pull", put("lowest_contact_force", lambda _: 0.1), FAILS),
    ("F7a", "validity_boundary", put("kept_share", lambda _: 1.0), FAILS),
    ("F7b", "validity_map", put("separates", lambda d: d.separates & False), FAILS),
    ("F8a", "at_scenes/natural_frequencies", SHIFTED, FAILS),
    ("F8b", "natural_frequencies", SHIFTED, FAILS),
    ("F8b", "natural_frequencies", HALF, FAILS),
    ("F8c", "natural_frequencies", SEPARATED, HOLDS),
    ("F8d", "natural_frequencies", SEPARATED, FAILS),
    ("F9a", "natural_frequencies", ONE_MODE, FAILS),
    ("F9b", "natural_frequencies", ONE_MODE, FAILS),
    ("F9c", "natural_frequencies", SEPARATED, FAILS),
    ("F10", "backbone/F10_mode1", put("y_amplitude", lambda _: 0.1), FAILS),
    ("F10", "backbone/F10_mode2", put("x_amplitude", lambda _: 0.0), FAILS),
    ("F11", "backbone/F11_mode2", FASTER, FAILS),
    ("F11", "backbone/F11_mode1", FASTER, FAILS),
    ("F12", "backbone/F12_mode2", scaled("omega", 0.9), FAILS),
    ("F10b", "backbone/F10_mode2", put("omega", lambda d: d.omega[0]), FAILS),
    ("F11b", "backbone/F11_mode2", scaled("y_peak", 0.1), FAILS),
    ("F12b", "backbone/F12_mode2", put("omega", lambda d: 2 - d.omega), FAILS),
    ("F13", "backbone/F13_mode2", put("y_amplitude", lambda _: 0.1), FAILS),
    ("F13", "backbone/F13_mode1", scaled("y_peak", 0.1), FAILS),
    (
        "C1",
        "at_scenes/quasi_static_map",
        put("stiffness_y", lambda d: d.stiffness_x - 0.1),
        HOLDS,
    ),
    ("C2", "corrected/quasi_static_map", NEVER, HOLDS),
    ("C3", "backbone/F10_mode2", scaled("omega", 1.2), FAILS),
    ("C3", "simulate/F2d", without_events, FAILS),
    ("C4", "assumptions", HELD, FAILS),
    ("C5", "stability_map", REGIME, FAILS),
    ("E1", "simulate/F2a_printed", scaled("x", -1.0), HOLDS),
    ("E2", "harmonic_forms", put("omega", lambda d: d.omega.isel(form=0)), HOLDS),
    ("E3", "quasi_static_map", AS_PHYSICAL, HOLDS),
    ("E4", "at_scenes/quasi_static_map", scaled("y_static", -1.0), HOLDS),
    (
        "E5",
        "quasi_static_map",
        put("stiffness_xy", lambda d: np.abs(d.stiffness_xy)),
        HOLDS,
    ),
    ("E8", "natural_frequencies", SEPARATED, HOLDS),
    ("E6", "harmonic_forms", put("fourier_rank", lambda d: d.fourier_columns), HOLDS),
    ("E7", "harmonic_forms", put("rank_deficit", lambda _: 0), HOLDS),
    ("E10", "validity_map", REGIME, FAILS),
    ("E10", "validity_map", put("separates", lambda d: d.separates | True), FAILS),
    (
        "E10",
        "corrected/validity_map",
        put("separates", lambda d: d.separates & False),
        HOLDS,
    ),
    ("F3", "corrected/simulate/F3_long", put("x", lambda d: d.x * d.time), HOLDS),
    (
        "E11",
        "quasi_static_map",
        put("contact_force_static", lambda d: 2.0 * d.possible - 1.0),
        HOLDS,
    ),
    ("E12", "at_scenes/quasi_static_map", put("stiffness_x", lambda _: 1.0), HOLDS),
]


@pytest.mark.parametrize(
    ("claim", "dataset", "change", "verdict"),
    FLIPS,
    ids=[f"{flip[0]}-{flip[1]}" for flip in FLIPS],
)
def test_the_verdict_flips(
    claim, dataset, change, verdict, evidence, baseline, monkeypatch
):
    (statement,) = (statement for statement in STATEMENTS if statement.id == claim)
    assert verdict != statement.recorded
    monkeypatch.setattr(judging, "STATEMENTS", [statement])
    both = [name for name in (dataset, f"corrected/{dataset}") if name in evidence]
    changed = {**evidence, **{name: change(evidence[name]) for name in both}}
    found = judging.judge(baseline, changed, "as_printed").sel(claim=claim)
    assert ClaimVerdict(int(found.verdict_here)) == verdict, str(found.evidence.item())


def test_what_the_paper_prints_decides_about_its_parameters(
    evidence, baseline, monkeypatch
):
    monkeypatch.setattr(misprints, "READ_IN_THE_PAPER", misprints.GROUPS)
    found = judging.judge(baseline, evidence, "as_printed").sel(claim="E9")
    assert ClaimVerdict(int(found.verdict_here)) == HOLDS
    assert found.evidence.item().startswith("Read by hand in the paper, not computed")


def test_every_statement_is_flipped_by_some_change():
    flipped = {flip[0] for flip in FLIPS} | {"E9"}
    assert flipped == {statement.id for statement in STATEMENTS}
