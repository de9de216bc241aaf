"""Every statement, in the paper's order: the paper's own, then our list of its misprints."""

from squealpipe.paper.claims.checks import (
    abstract,
    conclusions,
    figures_2_to_5,
    figures_6_and_7,
    figures_8_and_9,
    figures_10_to_13,
    misprints,
)

PAPER_STATEMENTS = (
    *abstract.rows,
    *figures_2_to_5.rows,
    *figures_6_and_7.rows,
    *figures_8_and_9.rows,
    *figures_10_to_13.rows,
    *conclusions.rows,
)
"""Statements of the paper, with their checks."""

STATEMENTS = (*PAPER_STATEMENTS, *misprints.rows)
"""Every row of the claims table."""
