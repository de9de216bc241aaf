"""Checks are strict enough to fail: each statement flips when the data say something else."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr

from squealpipe.schema.claims import Verdict
from squealpipe.study.claims import judge as judging
from squealpipe.study.claims.statements import STATEMENTS

HOLDS, PRINTED, FAILS = Verdict.holds, Verdict.holds_only_as_printed, Verdict.fails

Change = Callable[[xr.Dataset], xr.Dataset]


class Flip(NamedTuple):
    claim: str
    dataset: str
    change: Change
    verdict: Verdict


def put(name, value):
    """Replace a variable, keeping its attributes."""

    def change(dataset):
        old = dataset[name]
        new = xr.broadcast(xr.DataArray(value(dataset)), old)[0].transpose(*old.dims)
        return dataset.assign({name: new.astype(old.dtype).assign_attrs(old.attrs)})

    return change


def scaled(name, factor):
    return put(name, lambda dataset: dataset[name] * factor)


def without_events(dataset):
    return dataset.isel(event=slice(0, 0))


def touching(dataset):
    """The contact force dips to zero once."""
    return put(
        "normalized_contact_force",
        lambda d: d.normalized_contact_force.where(np.arange(d.sizes["time"]) != 5, 0.0),
    )(dataset)


def no_growth(dataset):
    return put("x", lambda d: np.cos(d.time) + 0 * d.x)(dataset)


def growing(dataset):
    return put("x", lambda d: d.x * (d.time / d.time[-1]) ** 2)(dataset)


def mode_values(dataset, mode, state, value):
    """omega with one mode and state replaced."""
    here = (dataset.mode == mode) & (dataset.contact_state == state)
    return dataset.omega.where(~here, value)


def other_second_mode(dataset):
    return dataset.omega.where(dataset.mode == 1, dataset.omega.sel(mode=1))


def negative_damping(dataset):
    """What flutters has two frequencies."""
    return dataset.frequency * (1.0 + 0.01 * (dataset.mode - 1))


def as_first(dataset):
    """The response of Fig. 2(d) as if its contact force stayed at that of rest, nearly."""
    return put("normalized_contact_force", lambda d: 0.21 + 0.79 * (d.time < 1.0))(dataset)


def as_mended(dataset):
    return dataset.omega.isel(form=0)


REGIME = put("regime_linear", lambda d: 0 * d.regime_linear)
EVERYWHERE_PRINTED = put("possible_as_printed", lambda d: 0 * d.possible + 1)
AS_PHYSICAL = put("possible_as_printed", lambda d: d.possible)
NEVER = put("possible", lambda d: 0 * d.possible)

FLIPS = [
    Flip("T1", "assumptions", put("held", lambda d: 0 * d.held + 1), HOLDS),
    Flip("T1", "assumptions", put("held", lambda d: 0 * d.held), FAILS),
    Flip("S1", "simulate/F2d", without_events, FAILS),
    Flip("S1", "simulate/F2d", scaled("return_peak_contact_force", 0.4), FAILS),
    Flip("S2", "assumptions", put("held", lambda d: 0 * d.held + 1), FAILS),
    Flip("S2", "assumptions", scaled("measure", 1e-3), FAILS),
    Flip("S3", "stability_map", REGIME, FAILS),
    Flip("S3", "stability_map", put("frequency", negative_damping), FAILS),
    Flip("F2a", "simulate/F2a", touching, FAILS),
    Flip("F2b", "simulate/F2b", touching, FAILS),
    Flip("F2c", "simulate/F2c", touching, FAILS),
    Flip("F2d", "simulate/F2d", without_events, FAILS),
    Flip("F2e", "simulate/F2b", scaled("normalized_contact_force", 0.5), FAILS),
    Flip("F2e", "simulate/F2d", as_first, Verdict.cannot_be_decided),
    Flip("F3", "simulate/F3", no_growth, FAILS),
    Flip("F3", "simulate/F3_long", no_growth, PRINTED),
    Flip("F4", "simulate/F4", growing, FAILS),
    Flip("F4", "simulate/F4_long", scaled("x", 1.2), PRINTED),
    Flip("F4", "simulate/F4", scaled("x", 1.1), FAILS),
    Flip("F5a", "simulate/F5b", scaled("normalized_contact_force", 1 + 1e-8), FAILS),
    Flip("F5b", "simulate/F5a", without_events, FAILS),
    Flip("F6a", "quasi_static_map", AS_PHYSICAL, HOLDS),
    Flip("F6a", "quasi_static_map", EVERYWHERE_PRINTED, FAILS),
    Flip("F6b", "quasi_static_map", EVERYWHERE_PRINTED, FAILS),
    Flip("F6b", "quasi_static_map", NEVER, HOLDS),
    Flip("F6c", "stability_map", REGIME, HOLDS),
    Flip("F6c", "quasi_static_map", EVERYWHERE_PRINTED, FAILS),
    Flip("F6d", "stability_map", put("growth_rate", lambda d: 0 * d.growth_rate + 1e-3), FAILS),
    Flip("F6d", "simulate/F3", no_growth, FAILS),
    Flip("F6e", "linear_pull", put("lowest_contact_force", lambda _: 0.1), FAILS),
    Flip("F7a", "validity_boundary", put("kept_share", lambda _: 1.0), FAILS),
    Flip("F7b", "validity_map", put("separates", lambda d: d.separates & False), FAILS),
    Flip("F8a", "natural_frequencies", put("omega", lambda d: d.omega + 0.1), FAILS),
    Flip("F8b", "natural_frequencies", put("omega", lambda d: d.omega + 0.1), FAILS),
    Flip(
        "F8b",
        "natural_frequencies",
        put("omega", lambda d: mode_values(d, 1, "separated", 0.5)),
        FAILS,
    ),
    Flip(
        "F8c",
        "natural_frequencies",
        put("omega", lambda d: 0 * d.omega + d.omega.sel(contact_state="separated")),
        HOLDS,
    ),
    Flip(
        "F8d",
        "natural_frequencies",
        put("omega", lambda d: 0 * d.omega + d.omega.sel(contact_state="separated")),
        FAILS,
    ),
    Flip("F9a", "natural_frequencies", put("omega", other_second_mode), FAILS),
    Flip("F9b", "natural_frequencies", put("omega", other_second_mode), FAILS),
    Flip(
        "F9c",
        "natural_frequencies",
        put("omega", lambda d: 0 * d.omega + d.omega.sel(contact_state="separated")),
        FAILS,
    ),
    Flip("F10", "backbone/F10_mode1", put("y_amplitude", lambda _: 0.1), FAILS),
    Flip("F10", "backbone/F10_mode2", put("x_amplitude", lambda _: 0.0), FAILS),
    Flip("F11", "backbone/F11_mode2", scaled("omega", 1.1), FAILS),
    Flip("F11", "backbone/F11_mode1", scaled("omega", 1.1), FAILS),
    Flip("F12", "backbone/F12_mode2", scaled("omega", 0.9), FAILS),
    Flip("F10b", "backbone/F10_mode2", put("omega", lambda d: d.omega[0]), FAILS),
    Flip("F11b", "backbone/F11_mode2", scaled("y_peak", 0.1), FAILS),
    Flip("F12b", "backbone/F12_mode2", put("omega", lambda d: 2 - d.omega), FAILS),
    Flip("F13", "backbone/F13_mode2", put("y_amplitude", lambda _: 0.1), FAILS),
    Flip("F13", "backbone/F13_mode1", scaled("y_peak", 0.1), FAILS),
    Flip("C1", "quasi_static_map", put("stiffness_y", lambda d: d.stiffness_x), FAILS),
    Flip("C1", "quasi_static_map", put("stiffness_y", lambda d: d.stiffness_x - 0.1), HOLDS),
    Flip("C2", "quasi_static_map", NEVER, HOLDS),
    Flip("C3", "backbone/F10_mode2", scaled("omega", 1.2), FAILS),
    Flip("C3", "simulate/F2d", without_events, FAILS),
    Flip("C4", "assumptions", put("held", lambda d: 0 * d.held + 1), FAILS),
    Flip("C5", "validity_map", put("separates", lambda d: d.separates | True), FAILS),
    Flip("E1", "simulate/F2a_printed", scaled("x", -1.0), HOLDS),
    Flip("E2", "harmonic_forms", put("omega", as_mended), HOLDS),
    Flip("E3", "quasi_static_map", AS_PHYSICAL, HOLDS),
    Flip("E4", "quasi_static_map", scaled("y_static", -1.0), HOLDS),
    Flip("E5", "quasi_static_map", put("stiffness_xy", lambda d: np.abs(d.stiffness_xy)), HOLDS),
    Flip(
        "E8",
        "natural_frequencies",
        put("omega", lambda d: 0 * d.omega + d.omega.sel(contact_state="separated")),
        HOLDS,
    ),
    Flip("E6", "harmonic_forms", put("fourier_rank", lambda d: d.fourier_columns), HOLDS),
    Flip("E7", "harmonic_forms", put("rank_deficit", lambda _: 0), HOLDS),
    Flip(
        "E9",
        "parameter_inference",
        put("feasible_count", lambda d: d.feasible_count.clip(max=1)),
        HOLDS,
    ),
    Flip("E10", "stability_map", REGIME, FAILS),
    Flip("E10", "validity_boundary", put("kept", lambda d: d.kept & False), FAILS),
    Flip(
        "E11",
        "quasi_static_map",
        put("contact_force_static", lambda d: 2.0 * d.possible - 1.0),
        HOLDS,
    ),
    Flip("E12", "quasi_static_map", put("stiffness_x", lambda _: 1.0), HOLDS),
]


@pytest.mark.parametrize("flip", FLIPS, ids=[f"{flip.claim}-{flip.dataset}" for flip in FLIPS])
def test_the_verdict_flips(flip, evidence, baseline, monkeypatch):
    (statement,) = (statement for statement in STATEMENTS if statement.id == flip.claim)
    assert flip.verdict != statement.recorded
    monkeypatch.setattr(judging, "STATEMENTS", [statement])
    changed = {**evidence, flip.dataset: flip.change(evidence[flip.dataset])}
    found = judging.judge(baseline, changed, "as_printed").sel(claim=flip.claim)
    assert Verdict(int(found.verdict_here)) == flip.verdict, str(found.evidence.item())


def test_every_statement_is_flipped_by_some_change():
    assert {flip.claim for flip in FLIPS} == {statement.id for statement in STATEMENTS}
