"""Which start decides the verdict, and what else the answer tells of it."""

import pytest

from squealpipe.codes import Verdict
from squealpipe.schema import Outcome
from squealpipe.vibration.judgement import judge
from squealpipe.vibration.settled_runs import SettledRun

QUIET, LOUD, OPEN = (
    SettledRun(verdict, None, 1.0)
    for verdict in (Verdict.quiet, Verdict.hammers, Verdict.undetermined)
)


@pytest.mark.parametrize(
    ("pushed", "sudden", "others", "outcome", "unless_struck", "lasting"),
    [
        (QUIET, QUIET, [QUIET], Outcome.converged, False, []),
        (QUIET, LOUD, [QUIET], Outcome.converged, True, [LOUD]),
        (QUIET, QUIET, [OPEN], Outcome.converged, True, [OPEN]),
        (LOUD, QUIET, [QUIET], Outcome.converged, False, [LOUD]),
        (OPEN, LOUD, [], Outcome.unresolved, False, [OPEN, LOUD]),
        (None, LOUD, [QUIET], Outcome.no_sliding_state, False, [LOUD]),
        (None, QUIET, [LOUD], Outcome.no_sliding_state, True, [LOUD]),
        (None, OPEN, [], Outcome.unresolved, False, [OPEN]),
    ],
)
def test_a_push_decides_and_the_sudden_start_where_nothing_slides_steadily(
    pushed, sudden, others, outcome, unless_struck, lasting
):
    found = judge(pushed, sudden, others, lambda run: ({"of": run}, {"seen_of": run}))
    deciding = sudden if pushed is None else pushed
    assert found.verdict is deciding.verdict
    assert found.lasting == lasting
    assert found.facts == {
        "of": deciding,
        "sudden_of": sudden,
        "seen_of": deciding,
        "quiet_unless_struck": unless_struck,
        "outcome": outcome,
    }
