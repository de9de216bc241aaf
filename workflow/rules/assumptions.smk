"""What the model levels take for granted, checked along their motions."""

if PAPERS_FRICTION:

    rule check_assumptions:
        output:
            data("assumptions"),
        params:
            settings=settings("parameters"),
        script:
            "../scripts/dynamics/check_assumptions.py"
