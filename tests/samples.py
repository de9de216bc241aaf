"""How many random cases the release tests take: two ninths, or all with SQUEALPIPE_SAMPLES=all."""

import os

WHOLE = os.environ.get("SQUEALPIPE_SAMPLES") == "all"


def some(seeds):
    """These of the seeds: of eighteen the first, sixth, eleventh and sixteenth.

    Kinds go by the remainder of a seed by two, three or four; all are among these.
    """
    return [
        seed
        for place, seed in enumerate(seeds)
        if WHOLE or place % 18 in {0, 5, 10, 15}
    ]
