"""The verdicts on the paper's statements."""

from enum import IntEnum

from squealpipe.codes import Worded
from squealpipe.schema import DatasetSchema, Variable, count, flag, or_nan, text
from squealpipe.systems.datasets.agreement import ComparedAs, RoundOff


class ClaimVerdict(Worded):
    """Verdict of the data on a statement."""

    holds = 0
    holds_only_as_printed = 1
    fails = 2
    depends_on_the_parameters = 3
    cannot_be_decided = 4


class Basis(IntEnum):
    """Kind of evidence by which a statement can speak for the inferred parameters."""

    fitted = 0
    predicted = 1
    unknown = 2


class Origin(IntEnum):
    """Author of a row's statement: the paper, or our list of its misprints."""

    paper = 0
    misprints = 1


def _number(meaning: str) -> Variable:
    # Some values come from long runs, whose last digits differ from machine to machine.
    return or_nan(meaning, dims=("claim",), rtol=1e-3, atol=1e-6)


def _explains(meaning: str) -> Variable:
    # whoever compares with an old archive asks for results: the id says which statement it is
    reworded = RoundOff(
        ComparedAs.unjudged,
        "other words for what the row's id names are no other result",
    )
    return Variable(meaning, dims=("claim",), dtype="U", round_off=reworded)


def _flag(meaning: str, flags: type[IntEnum]) -> Variable:
    return flag(meaning, flags, "claim")


claims_schema = DatasetSchema(
    name="claims",
    title="The paper's statements, judged",
    coordinates={"claim": text("id of the statement", "claim")},
    variables={
        "statement": _explains("the statement in our words"),
        "section": text("where the paper says it", "claim"),
        "check": _explains("what is measured"),
        "verdict": _flag(
            "what the data say, over the inferred feasible set as well", ClaimVerdict
        ),
        "verdict_here": _flag(
            "what the data say at the parameters of the run", ClaimVerdict
        ),
        "recorded": _flag(
            "verdict_here recorded for the shipped baseline", ClaimVerdict
        ),
        "corrected_verdict": _flag(
            "verdict in the corrected physics, friction of one sign throughout; that of the "
            "reading where nothing differs",
            ClaimVerdict,
        ),
        "corrected_value": _number("measured value in the corrected physics"),
        "corrected_evidence": text(
            "one line of evidence there", "claim", volatile=True
        ),
        "value": _number("measured value; NaN where nothing was measured"),
        "relation": text(
            "relation of value and threshold under which the check passes", "claim"
        ),
        "threshold": _number("threshold of the check; NaN as in value"),
        "feasible_share": _number(
            "share of the inferred feasible parameters in which the statement holds; NaN where it "
            "was fitted and where the inference does not judge it"
        ),
        "feasible_count": count(
            "feasible parameter sets behind feasible_share; 0 where there is none",
            "claim",
        ),
        "basis": _flag(
            "whether the statement was fitted by the inference or is predicted", Basis
        ),
        "origin": _flag(
            "the paper's own statement, or one of our list of its misprints", Origin
        ),
        "evidence": text("one line of evidence", "claim", volatile=True),
        "dataset": text("datasets read, with their ids", "claim", volatile=True),
        "figure": text("picture that shows it", "claim"),
    },
)
