"""Our methods are never silently wrong on the hard scenes; the public ones' failures are real."""

import numpy as np
import pytest
import xarray as xr

from squealpipe.schema.comparison import Role, Verdict
from squealpipe.tasks.failure_verdicts import Answer, error_of, verdict_of
from squealpipe.tasks.failures import judge_methods


@pytest.fixture(scope="module")
def atlas() -> xr.Dataset:
    return judge_methods()


def cell(atlas: xr.Dataset, scene: str, method: str) -> Verdict:
    return Verdict(int(atlas.verdict.sel(scene=scene, solver=method)))


def test_our_methods_are_never_silently_wrong(atlas: xr.Dataset) -> None:
    ours = atlas.isel(solver=atlas.role.values != Role.public)
    silent = ours.verdict == Verdict.silently_wrong
    where = [
        (str(ours.scene.values[i]), str(ours.solver.values[j]))
        for i, j in np.argwhere(silent.values)
    ]
    assert where == []


def test_our_methods_do_not_cry_wolf(atlas: xr.Dataset) -> None:
    ours = atlas.isel(solver=atlas.role.values != Role.public)
    assert not ((ours.verdict == Verdict.right) & (ours.flagged > 0)).any()


def test_every_scene_is_asked_of_ours_and_of_a_public_method(atlas: xr.Dataset) -> None:
    asked = atlas.verdict != Verdict.not_applicable
    for role in (True, False):
        columns = (atlas.role.values != Role.public) == role
        assert asked.isel(solver=columns).any("solver").all()


@pytest.mark.parametrize("method", ["DOP853", "RK45", "LSODA", "Radau"])
def test_step_end_sign_checks_pass_over_a_grazing_pair(atlas: xr.Dataset, method: str) -> None:
    name = f"{method} + events"
    assert cell(atlas, "grazing contact", name) == Verdict.silently_wrong
    # exactly one separation and one contact are missing; the state itself is hardly moved
    assert float(atlas.error.sel(scene="grazing contact", solver=name)) == 2.0
    assert cell(atlas, "grazing contact", "Taylor + events") == Verdict.right


@pytest.mark.parametrize(
    ("scene", "method"),
    [
        ("chaotic hammering", "LSODA + events"),
        ("T beyond the horizon", "DOP853 + events"),
        ("T beyond the horizon", "Moreau–Jean"),
        ("very stiff contact", "Moreau–Jean"),
        ("σ too small", "LSODA, tanh"),
        ("σ too large", "LSODA, tanh"),
        ("σ too small (balance)", "tanh balance, sampled"),
        ("σ too large (balance)", "tanh balance, sampled"),
        ("aliasing, N ≈ 2N_h", "cold Newton, sampled"),
        ("aliasing, N ≈ 2N_h", "paper's balance"),
        ("aliasing, N ≈ 2N_h", "paper's, Eq. (34) as printed"),
        ("tongue end", "cold Newton, sampled"),
        ("cold start, wrong basin", "cold Newton, sampled"),
        ("cold start, wrong basin", "paper's balance"),
        ("period-doubling window", "Hill's method, sampled"),
        ("singular static state", "numpy.linalg"),
        ("flutter onset", "numpy.linalg"),
    ],
)
def test_public_methods_fail_silently_where_we_say(
    atlas: xr.Dataset, scene: str, method: str
) -> None:
    assert cell(atlas, scene, method) == Verdict.silently_wrong


@pytest.mark.parametrize(
    ("scene", "method"),
    [
        ("T beyond the horizon", "Taylor + events"),
        ("singular static state", "closed form, exact orbit"),
        ("tongue end", "closed form, exact orbit"),
        ("pole at ω_x/2", "closed-form balance"),
    ],
)
def test_ours_say_where_there_is_no_answer(atlas: xr.Dataset, scene: str, method: str) -> None:
    assert cell(atlas, scene, method) == Verdict.flagged
    assert atlas.message.sel(scene=scene, solver=method).item() != ""


@pytest.mark.parametrize(
    ("value", "flag", "truth", "expected"),
    [
        (1.0, "", 1.0 + 1e-4, Verdict.right),
        (1.0, "careful", 1.0 + 1e-4, Verdict.right),
        (1.0, "", 1.1, Verdict.silently_wrong),
        (1.0, "careful", 1.1, Verdict.flagged),
        (np.nan, "no answer", 1.0, Verdict.flagged),
        (np.nan, "", 1.0, Verdict.silently_wrong),
        (1.0, "", np.nan, Verdict.silently_wrong),
        (np.nan, "there is none", np.nan, Verdict.flagged),
        (np.nan, "", np.nan, Verdict.silently_wrong),
    ],
)
def test_verdicts_follow_from_errors_and_flags(
    value: float, flag: str, truth: float, expected: Verdict
) -> None:
    error = error_of(Answer(value, flag), truth)
    assert verdict_of(error, 1e-3, flag, truth) == expected
