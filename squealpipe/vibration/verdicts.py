"""Verdict on a settled motion: quiet, squeals or hammers.

Whether it is small enough to be quiet is decided in :mod:`squealpipe.vibration.settled_runs`.
"""

from squealpipe.codes import Verdict


def heard(losses: int, *, quiet: bool = False) -> Verdict:
    """Return the verdict on a settled motion by its losses of contact within a window.

    Args:
        losses: how often the contact that is lost most often is lost, or comes back.
        quiet: whether the motion has died out.
    """
    if quiet:
        return Verdict.quiet
    # a single loss may be the last one of a transient
    return Verdict.hammers if losses >= 2 else Verdict.squeals
