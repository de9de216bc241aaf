"""``squealpipe assess``: the answer for one brake."""

import sys

from squealpipe.cli.arguments import (
    DRAWN,
    Angle1,
    Angle2,
    Drawn,
    OutputElsewhere,
    Tolerance,
)
from squealpipe.cli.console import ANSWER_IS_NO, DONE, answer, working
from squealpipe.cli.output import compute
from squealpipe.cli.signatures import options_of


@options_of("assess")
def assess(
    alpha1: Angle1,
    alpha2: Angle2,
    /,
    *,
    tol: Tolerance,
    output: OutputElsewhere = None,
    brake: Drawn = DRAWN,
) -> int:
    """Say whether a brake squeals or hammers, at which frequency, how loud, why, what stops it.

    Exit code 0: quiet; 1: not. Angles are counted from the belt line, both upwards: alpha1 from +x,
    the way the belt runs, alpha2 from −x; 0deg is along the belt, 90deg is straight above the mass.

    Example: `squealpipe assess 22deg 46deg --config pad.yaml -o answer.nc`

    Args:
        output: also write the dataset (.nc or .csv), and a picture of the settled motion beside it.
    """
    if output is not None:
        verdict = compute("assess", brake, alpha1, alpha2, output=output, tol=tol)

        from squealpipe.study.report.answer import lines

        answer(*lines(verdict))
    elif brake.picture is not None:
        raise ValueError("--picture is drawn beside a dataset; name that by --output")
    else:
        from squealpipe.brake.assess.assess import judge
        from squealpipe.study.report.answer import cure_lines, first_lines

        with working("assess"):
            judged = judge(brake.params, alpha1, alpha2, tol=tol)
        answer(*first_lines(judged.without_cures()))
        # most of the time goes into the search for what stops it
        sys.stdout.flush()
        with working("what stops it"):
            verdict = judged.with_cures()
        answer(*cure_lines(verdict))
    return DONE if int(verdict.verdict) == 0 else ANSWER_IS_NO
