"""heyoka as it is used here: it compiles in each process, leaves no file and prints no notes."""

import heyoka

from squealpipe.laws.functions import exp

exp.register(heyoka.expression, heyoka.exp)


def set_up():
    """Switch off heyoka's notes and its store of compiled code in the user's home.

    Compiling takes half a second. For that a result shall not depend on a file outside the
    project, nor jobs of a cluster wait for one another's lock on it.
    """
    heyoka.set_logger_level_error()
    heyoka.llvm_state.set_diskcache_enabled(False)
