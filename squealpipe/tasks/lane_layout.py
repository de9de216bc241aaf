"""Where a lane and a job keep what: columns of the arrays that compiled code works on."""

from __future__ import annotations

from squealpipe.models import switching
from squealpipe.schema import Outcome

# What a compiled round is given: addresses of arrays, then sizes.
STATE, PARS, COEFFICIENTS, LAST_STEP, MEMORY, INTEGERS, ORDERS, INITIAL, RESULTS = range(9)
COUNTS, SAMPLE_TIMES, SAMPLES, SAMPLE_REGIMES = range(9, 13)
EVENT_TIMES, EVENT_KINDS, EVENT_STATES, QUEUE = range(13, 17)
N_VARIABLES, N_PARS, N_TERMS, N_JOBS, N_SAMPLES, N_LOGGED = range(17, 23)
# The integrator's parameters, in the order of ``tasks.a1_system``: physical ones, then regime.
K2, K3, MU, BELT_SPEED, LENGTH1, LENGTH2, C1, S1, C2, S2 = range(10)
CONTACT, DIRECTION, STICKS_NOW = range(10, 13)
GAP_WEIGHT, GAP_OFFSET, SPEED_WEIGHT, SPEED_OFFSET = range(13, 17)
# A job's order: its physical parameters, as above, then what is asked for.
N_PHYSICAL = 10
T_END, T_LATE, STOP_AT_X, STOP_AT_SEPARATION, MAX_STEPS, MAX_EVENTS = range(10, 16)
SEPARATES, REVERSES, STICKS, LINEAR_SPRINGS, LOST_GROWTH, STOP_AT_TURNS = range(16, 22)
N_ORDERS = 22
# A job's floating-point results.
TIME, FIRST_SEPARATION, SEPARATED_TIME, STICK_TIME, LOWEST_Y, LARGEST_R2 = range(6)
EARLY_LARGEST_X, LATE_LARGEST_X, LARGEST_SPEED, NEAREST_PIVOT2 = range(6, 10)
HIGHEST_Y, HALF_TURNS1, HALF_TURNS2, LOG_GROWTH, HORIZON, FINAL_STATE = range(10, 16)
N_RESULTS = FINAL_STATE + 4
# A job's integer results; the counts of the five kinds of events come last.
OUTCOME, REGIME, STEPS, LATE_EVENTS, EVENTS, FIRST_KIND = range(6)
N_COUNTS = 11
# A lane's memory: its compensated time, the pivots, then the job's order and results so far.
CLOCK, CORRECTION, PIVOTS, ORDER = 0, 1, 2, 6
RESULT = ORDER + N_ORDERS
N_MEMORY = RESULT + N_RESULTS
# A lane's integer memory: job, next sample, then the counts.
JOB, NEXT_SAMPLE, COUNT = 0, 1, 2
N_INTEGERS = COUNT + N_COUNTS

FIRST_TANGENT = 4
TANGENT_NORM = 1e-4
"""Norm that a tangent vector is scaled back to: small, so that it does not set the step size."""
PIVOT_REACH2 = 1e-14
"""Squared distance from a pivot, in free lengths, below which the force's direction is lost."""
SUSPECT_PIVOT2 = 1e-6
"""Squared distance below which an overflow is a pivot's doing."""
JUMP2 = 1e-2
"""A step that ends its approach to a pivot this much nearer than it began, squared, has jumped over
the singularity: straight through a pivot the Taylor series of the force is smooth to round-off."""

SEPARATED, STICK = switching.SEPARATED, switching.STICK
CONVERGED, SEPARATION_FOUND = int(Outcome.converged), int(Outcome.separated)
STEP_LIMIT, EVENT_LIMIT = int(Outcome.step_limit), int(Outcome.event_limit)
SINGULAR, NOT_FINITE = int(Outcome.singular_geometry), int(Outcome.not_finite)
REACHED, UNRESOLVED = int(Outcome.amplitude_reached), int(Outcome.unresolved)
RUNNING, IDLE, EMPTY = -1, -1, -2
