"""Every statement, in the paper's order: the paper's own, then our list of its misprints."""

from __future__ import annotations

from squealpipe.study.claims.checks import (
    backbones,
    conclusions,
    frequencies,
    misprints,
    overall,
    response,
    sliding,
)

PAPER = (
    *overall.rows,
    *response.rows,
    *sliding.rows,
    *frequencies.rows,
    *backbones.rows,
    *conclusions.rows,
)
"""What the paper says."""

STATEMENTS = (*PAPER, *misprints.rows)
"""Every row of the claims table."""
