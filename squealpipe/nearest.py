"""The name that was probably meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def nearest(wrong: object, names: Iterable[str]) -> str | None:
    """The name that is near enough to have been meant, if there is one."""
    every = list(names)
    near = difflib.get_close_matches(str(wrong), every, n=1) or difflib.get_close_matches(
        str(wrong), [name for name in every if len(name) == len(str(wrong))], n=1, cutoff=0.5
    )
    return near[0] if near else None


def suggestion(wrong: object, names: Iterable[str]) -> str:
    """``did you mean 'mu'?``, or all names where none is near."""
    every = list(names)
    near = nearest(wrong, every)
    return f"did you mean {near!r}?" if near else f"choose from {', '.join(every)}"
