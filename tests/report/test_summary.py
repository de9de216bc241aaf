"""Each sentence of the summary follows from its data, and changes with them."""

from __future__ import annotations

import pytest

from squealpipe.study.report import summary
from squealpipe.text import number

ROWS = [
    {"id": "F1", "verdict": "holds", "origin": "paper", "basis": "fitted"},
    {"id": "F2", "verdict": "holds", "origin": "paper", "basis": "predicted"},
    {"id": "F3", "verdict": "fails", "origin": "paper", "basis": "predicted"},
    {"id": "F4", "verdict": "cannot be decided", "origin": "paper", "basis": "predicted"},
    {"id": "E1", "verdict": "fails", "origin": "misprints", "basis": "predicted"},
    {"id": "E2", "verdict": "holds", "origin": "misprints", "basis": "predicted"},
]
WHIRL = {
    "own_speed": True,
    "amplitude": 80.66,
    "motion": "whirl",
    "saturated": True,
    "speed": 100.0,
    "t_end": 5e3,
}
TRANSIENT = {"runs": 9, "ended": 4, "shortest": 700.0, "median": None, "t_end": 2e4}
LINEAR = {"flutter": 5, "divergence": 3, "unstable_printed": 0, "unstable_physical": 5}
INFERENCE = {
    "feasible": 7,
    "samples": 100,
    "broken": [],
}


def told(**facts) -> str:
    return " ".join(summary.summarize(ROWS, facts, ["fig01", "fig02", "whirl"]))


def test_counts_are_those_of_the_rows() -> None:
    text = told()
    assert "2 figures of the paper" in text
    assert "of its 4 statements 2 hold, 1 fails and 1 cannot be decided" in text
    assert "Of 2 printed forms that we list as misprints or gaps, 1 do not stand" in text
    assert "the sign of friction in Eq. (4) (E1)" in text
    assert "(E2)" not in text


def test_fitted_statements_are_no_predictions() -> None:
    text = told(inference=INFERENCE)
    assert "fitted to 1 of the statements, which 7 of 100 trial sets satisfy" in text
    assert "of the other 3 statements 1 hold, and F3 is refuted" in text
    assert "violate F1" in told(inference=INFERENCE | {"broken": ["F1"]})
    rows = [ROWS[0] | {"verdict": "fails"}, *ROWS[1:]]
    text = " ".join(summary.summarize(rows, {"inference": INFERENCE}, ["fig01"]))
    assert "satisfy all of them (F1 fails in a part that was not fitted)" in text


@pytest.mark.parametrize(
    ("topic", "facts", "changed", "said", "then"),
    [
        ("whirl", WHIRL, {"saturated": False}, "saturates at |x| = 80.7", "has not settled"),
        (
            "whirl",
            WHIRL,
            {"motion": "stick slip"},
            "the mass whirls",
            "has settled: stick slip, |x|",
        ),
        ("transient", TRANSIENT, {"ended": 0}, "chaotic transient: 4 of 9", "Not one of 9 runs"),
        ("transient", TRANSIENT, {"median": 5e3}, "the first at 700.", "half of all before 5000"),
        ("linear", LINEAR, {"unstable_printed": 2}, "literally: as printed none", "2 can slide by"),
        ("linear", LINEAR, {"flutter": 0, "divergence": 0}, "none of the 8", "No cell of Fig. 6"),
    ],
)
def test_another_outcome_gets_another_sentence(topic, facts, changed, said, then) -> None:
    first, second = told(**{topic: facts}), told(**{topic: facts | changed})
    assert said in first
    assert then not in first
    assert then in second
    assert said not in second


def test_a_whirl_at_another_belt_speed_is_not_this_study_s() -> None:
    assert told(whirl=WHIRL | {"own_speed": False}) == told()


def test_there_are_at_most_ten() -> None:
    totals = {
        "ours": {"asked": 3, "silent": 0, "missed": 0},
        "others": {"asked": 4, "silent": 2, "missed": 6},
    }
    question = {"question": "contact lost", "simpler": 0.5, "work": 0.1}
    scene = {"error": 1e-12, "time": 1e-3, "public_error": 1e-13, "public_time": 0.1}
    found = summary.summarize(
        ROWS,
        {
            "inference": INFERENCE,
            "whirl": WHIRL,
            "transient": TRANSIENT,
            "linear": LINEAR,
            "integration": {"scenes": [scene]},
            "failures": {"scenes": 2, "tolerance": 1e-12, "totals": totals},
            "ladder": {"tolerance": 0.05, "points": 12, "questions": [question]},
        },
        ["fig01"],
    )
    assert len(found) <= 10
    assert "100 to 100 times as long" in found[-3]


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (1326.0, "1326"),
        (0.0042, "0.0042"),
        (2.61e-15, "2.61·10⁻¹⁵"),
        (1e-12, "10⁻¹²"),
        (6.5e6, "6.5·10⁶"),
        (80.73, "80.7"),
        (-1234567.0, "−1.23·10⁶"),
    ],
)
def test_numbers_are_written_as_people_write_them(value, text) -> None:
    assert number(value) == text
