"""The verdicts on the paper's statements."""

from __future__ import annotations

from enum import IntEnum

from squealpipe.schema import DatasetSchema, Variable


class Verdict(IntEnum):
    """What the data say about a statement."""

    holds = 0
    holds_only_as_printed = 1
    fails = 2
    depends_on_the_parameters = 3
    cannot_be_decided = 4

    @property
    def words(self) -> str:
        """The verdict as people read it."""
        return self.name.replace("_", " ")


def _text(meaning: str, *, volatile: bool = False) -> Variable:
    return Variable(dims=("claim",), dtype="U", long_name=meaning, volatile=volatile)


def _number(meaning: str) -> Variable:
    # Some values come from long runs, whose last digits differ from machine to machine.
    return Variable(dims=("claim",), nan_allowed=True, rtol=1e-3, atol=1e-6, long_name=meaning)


def _verdict(meaning: str) -> Variable:
    return Variable(dims=("claim",), dtype="i1", flags=Verdict, long_name=meaning)


CLAIMS = DatasetSchema(
    name="claims",
    title="The paper's statements, judged",
    coordinates={"claim": _text("id of the statement")},
    variables={
        "statement": _text("the statement in our words"),
        "section": _text("where the paper says it"),
        "check": _text("what is measured"),
        "verdict": _verdict("what the data say, over the inferred feasible set as well"),
        "verdict_here": _verdict("what the data say at the parameters of the run"),
        "recorded": _verdict("verdict_here recorded for the shipped baseline"),
        "value": _number("measured value; NaN where the verdict is cannot be decided"),
        "relation": _text("relation of value and threshold under which the check passes"),
        "threshold": _number("threshold of the check; NaN as in value"),
        "margin": _number("distance of the value from the threshold, positive where it passes"),
        "feasible_share": _number(
            "share of the inferred feasible parameters in which the statement holds; NaN where "
            "the inference does not evaluate it"
        ),
        "evidence": _text("one line of evidence", volatile=True),
        "dataset": _text("datasets read, with their ids", volatile=True),
        "figure": _text("picture that shows it"),
    },
)
