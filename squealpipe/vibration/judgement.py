"""Verdict on a pad or structure by the runs of its starts, and what the answer tells of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from squealpipe.codes import Verdict
from squealpipe.schema import Outcome
from squealpipe.vibration.settled_runs import SettledRun

Measure = Callable[[SettledRun], tuple[dict[str, Any], dict[str, Any]]]
"""Scalars of a settled run; and its spectrum, path and values by contact."""


@dataclass(frozen=True)
class Judgement:
    """Verdict, and what it follows from.

    Attributes:
        facts: variables of the dataset that the runs tell.
        lasting: runs whose motions have not died out.
    """

    verdict: Verdict
    facts: dict[str, Any]
    lasting: list[SettledRun]


def judge(
    pushed: SettledRun | None,
    sudden: SettledRun,
    others: Sequence[SettledRun],
    measure: Measure,
) -> Judgement:
    """Judge by what a push of steady sliding ends in; without steady sliding by the sudden start.

    Args:
        pushed: run of steady sliding, pushed; None where there is no steady sliding.
        sudden: run from rest under the whole load at once.
        others: runs of strikes or random starts.
    """
    deciding = sudden if pushed is None else pushed
    verdict = deciding.verdict
    scalars, pictured = measure(deciding)
    sudden_scalars, _ = measure(sudden)
    runs = [sudden, *others] if pushed is None else [pushed, sudden, *others]
    lasting = [run for run in runs if not run.quiet]
    outcome = Outcome.converged
    if deciding.unbounded:
        outcome = Outcome.not_finite
    elif verdict is Verdict.undetermined:
        outcome = Outcome.unresolved
    elif pushed is None:
        outcome = Outcome.no_sliding_state
    facts = {
        **scalars,
        **{f"sudden_{name}": value for name, value in sudden_scalars.items()},
        **pictured,
        "quiet_unless_struck": verdict is Verdict.quiet and bool(lasting),
        "outcome": outcome,
    }
    return Judgement(verdict, facts, lasting)
