"""What is heard of a settled motion."""

from squealpipe.schema.assess import Verdict

OFTEN = 2
"""Losses of contact, or returns to it, within a window from which contact is lost again and again:
one may be the last of a transient."""


def heard(losses: int, *, quiet: bool = False) -> Verdict:
    """Return the verdict on a settled motion by its losses of contact within a window.

    Args:
        losses: of the contact that is lost most often, or returns to it.
        quiet: whether the motion has died out.
    """
    if quiet:
        return Verdict.quiet
    return Verdict.hammers if losses >= OFTEN else Verdict.squeals
