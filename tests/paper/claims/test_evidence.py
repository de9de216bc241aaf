"""Findings: comparisons and how numbers are written."""

import numpy as np
import pytest

from squealpipe.paper.claims.evidence import finding
from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.study.evidence import MissingDataError
from squealpipe.systems.inputs.words import as_people_write


@pytest.mark.parametrize(
    ("relation", "holds"), [("<", (1,)), ("≤", (1, 2)), (">", (3,)), ("≥", (2, 3))]
)
def test_comparison_and_a_further_condition_that_can_only_turn_it_down(relation, holds):
    for value in (1, 2, 3):
        for also in (True, False):
            verdict = (
                ClaimVerdict.holds if also and value in holds else ClaimVerdict.fails
            )
            assert finding((value, relation, 2), "", also=also).verdict == verdict


def test_no_number_no_verdict():
    with pytest.raises(MissingDataError, match="nothing to compare"):
        finding((np.nan, "<", 2), "an empty map")


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("after 4.42e+03 s", "after 4420 s"),
        ("off by 3e-15.", "off by 3·10⁻¹⁵."),
        ("1.2e+09 cells", "1.2·10⁹ cells"),
        ("DOP853, tolerance 1e-08", "DOP853, tolerance 10⁻⁸"),
        ("K12 at 0.25 and -2.5e-07", "K12 at 0.25 and −2.5·10⁻⁷"),
        (
            "x = -0.126 l_pre, (-1, -.5), from 3 to -4",
            "x = −0.126 l_pre, (−1, −.5), from 3 to −4",
        ),
        (
            "sets 2-4 of A1-no-stick, backbone/F10-1",
            "sets 2-4 of A1-no-stick, backbone/F10-1",
        ),
    ],
)
def test_numbers_are_written_as_people_write(text, written):
    assert as_people_write(text) == written
