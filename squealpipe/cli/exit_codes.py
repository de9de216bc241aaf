"""Exit codes of every command."""

DONE = 0
ANSWER_IS_NO = 1
"""Done, and the answer is no: a difference, a changed file, another verdict, no convergence."""
NOT_DONE = 2
"""Wrong input, a missing file, nothing to compare."""
INTERRUPTED = 130
