"""One compiled loop for all linear structures with contacts on a moving belt.

The loop knows matrices only: nothing is traced or compiled for a structure. :mod:`.matrices` holds
what it is given, :mod:`.numbering` how regimes, switches and surfaces are numbered, :mod:`.forces`
the equations at a state, :mod:`.series` those along a step, :mod:`.sticking` what holds contacts on
the belt, :mod:`.switches` what follows an event, :mod:`.loop` the steps, :mod:`.batch` the arrays
of many runs and :mod:`.system` the verbs.
"""
