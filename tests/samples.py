"""How many random cases the release tests take: a third, or all with SQUEALPIPE_SAMPLES=all."""

import os

WHOLE = os.environ.get("SQUEALPIPE_SAMPLES") == "all"


def some(seeds):
    """These of the seeds: of nine the first, third and fifth.

    Kinds go by the remainder of a seed by two, three or four; all are among these.
    """
    return [seed for place, seed in enumerate(seeds) if WHOLE or place % 9 in {0, 2, 4}]
