"""Our methods are never silently wrong on the hard scenes; the public ones' failures are real."""

import numpy as np
import pytest

from squealpipe.schema.comparison import Reliability, Role
from squealpipe.tasks.comparison.failures import Answer, judge_balances, verdict_of


@pytest.fixture(scope="module")
def atlas():
    return judge_balances()


def cell(atlas, scene, method):
    return Reliability(int(atlas.verdict.sel(scene=scene, solver=method)))


def test_our_methods_are_never_silently_wrong(atlas):
    ours = atlas.isel(solver=atlas.role.values != Role.public)
    silent = ours.verdict == Reliability.silently_wrong
    where = [
        (str(ours.scene.values[i]), str(ours.solver.values[j]))
        for i, j in np.argwhere(silent.values)
    ]
    assert where == []


def test_every_scene_is_asked_of_ours_and_of_a_public_method(atlas):
    asked = atlas.verdict != Reliability.not_applicable
    for role in (True, False):
        columns = (atlas.role.values != Role.public) == role
        assert asked.isel(solver=columns).any("solver").all()


@pytest.mark.parametrize(
    ("scene", "method"),
    [
        ("σ too small (balance)", "tanh balance, sampled"),
        ("σ too large (balance)", "tanh balance, sampled"),
        ("aliasing, N ≈ 2N_h", "cold Newton, sampled"),
        ("aliasing, N ≈ 2N_h", "paper, Eq. (34) corrected"),
        ("aliasing, N ≈ 2N_h", "paper, Eq. (34) as printed"),
        ("tongue end", "cold Newton, sampled"),
        ("cold start, wrong basin", "cold Newton, sampled"),
        ("cold start, wrong basin", "paper, Eq. (34) corrected"),
        ("period-doubling window", "Hill's method, sampled"),
        ("singular static state", "numpy.linalg"),
        ("flutter onset", "numpy.linalg"),
    ],
)
def test_public_methods_fail_silently_where_we_say(atlas, scene, method):
    assert cell(atlas, scene, method) == Reliability.silently_wrong


@pytest.mark.parametrize(
    ("scene", "method"),
    [
        ("singular static state", "closed form, exact orbit"),
        ("tongue end", "closed form, exact orbit"),
        ("pole at ω_x/2", "closed-form balance"),
    ],
)
def test_ours_say_where_there_is_no_answer(atlas, scene, method):
    assert cell(atlas, scene, method) == Reliability.flagged
    assert atlas.message.sel(scene=scene, solver=method).item() != ""


@pytest.mark.parametrize(
    ("value", "flag", "truth", "expected"),
    [
        (1.0, "", 1.0 + 1e-4, Reliability.right),
        (1.0, "careful", 1.0 + 1e-4, Reliability.right),
        (1.0, "", 1.1, Reliability.silently_wrong),
        (1.0, "careful", 1.1, Reliability.flagged),
        (np.nan, "no answer", 1.0, Reliability.flagged),
        (np.nan, "", 1.0, Reliability.silently_wrong),
        (1.0, "", np.nan, Reliability.silently_wrong),
        (np.nan, "there is none", np.nan, Reliability.flagged),
        (np.nan, "", np.nan, Reliability.silently_wrong),
    ],
)
def test_verdicts_follow_from_errors_and_flags(value, flag, truth, expected):
    assert verdict_of(Answer(value, flag), truth, 1e-3)[0] == expected
