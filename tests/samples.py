"""How many random cases the release tests take: a third, or all with SQUEALPIPE_SAMPLES=all."""

import os

STEP = 1 if os.environ.get("SQUEALPIPE_SAMPLES") == "all" else 3


def some(seeds):
    """These of the seeds; neighbours differ in kind, so each kind is among them."""
    return seeds[::STEP]
