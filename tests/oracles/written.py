"""Answers of integrators apart that take long, written down: the tests of each change read them.

``written.json`` has function → question → answer. What is not there is asked anew, as other seeds
are; the release tier asks all that is there again (``validation/test_written.py``). Where a
question means something else than before, as after a change of a random system, its test fails:
then delete the file, and ``SQUEALPIPE_WRITE=1 python -m pytest`` with the tests that use this
writes another.
"""

import functools
import json
import os
from pathlib import Path

FILE = Path(__file__).with_suffix(".json")
WRITES = "SQUEALPIPE_WRITE" in os.environ


def plain(value):
    """A value as it comes back from a file."""
    return json.loads(json.dumps(value, default=lambda array: array.tolist()))


@functools.cache
def answers():
    """Function → question → answer."""
    return json.loads(FILE.read_text(encoding="utf-8")) if FILE.exists() else {}


def written(function):
    """Have a function of numbers and texts answer from the file what is there."""
    name = f"{function.__module__}:{function.__name__}"

    @functools.wraps(function)
    def answer(*given):
        question = json.dumps(given)
        known = answers().get(name, {})
        if question not in known:
            found = plain(function(*given))
            if not WRITES:
                return found
            known = answers().setdefault(name, {})
            known[question] = found
            FILE.write_text(json.dumps(answers(), indent=0) + "\n", encoding="utf-8")
        return known[question]

    return answer
