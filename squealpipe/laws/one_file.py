"""A user's own code is one file, so that its text tells all that it computes."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def without_neighbours() -> Iterator[None]:
    """Have no file of the working folder imported meanwhile.

    Whether that is on Python's path depends on how Python was started, and no key of a result
    follows what is imported from there.
    """
    before, folder = sys.path[:], Path.cwd()
    sys.path[:] = [entry for entry in before if Path(entry).resolve() != folder]
    try:
        yield
    finally:
        sys.path[:] = before
