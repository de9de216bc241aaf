"""Regimes in which runs start, by their states: compiled, one run after the other."""

from typing import Any

import numpy as np

from squealpipe.systems.compiled import part
from squealpipe.systems.linear.contact_numbers import (
    contact_row,
    press_of_force,
    regimes_of_press,
    slip_regime,
)
from squealpipe.systems.linear.forces import slider_lag, state_forces
from squealpipe.systems.linear.numbering import OF_CONTACT
from squealpipe.systems.linear.plan import mode_row, parameter_row, plan_at, record_at
from squealpipe.systems.linear.sticking import holding, holds
from squealpipe.systems.taylor.lanes import call, view
from squealpipe.systems.taylor.simd import LANES

FIRST = 1e150
"""Weight of what decides before anything else is asked."""


@part
def _put(k: Any, rows: Any, i: int, regime: int) -> None:
    """Put a contact into a regime."""
    first = parameter_row.coefficients + OF_CONTACT * k.c + 1 + i * k.width
    for which in range(k.width):
        rows[first + which, 0] = k.table[k.first[0, i] + regime, which]
    call(k.settle, (rows.ctypes.data,))


@part
def _rises(k: Any, i: int, z: Any) -> Any:
    """Return how a contact that is just closed goes on: its velocity, then its acceleration."""
    n, velocity, acceleration = k.n, 0.0, 0.0
    for j in range(n):
        velocity += k.normals[j, i] * z[n + j]
        acceleration += k.normals[j, i] * k.by_mode[mode_row.base, j]
        for a in range(k.counts[0]):
            friction = k.by_contact[contact_row.stick, k.stuck[a]]
            acceleration += k.normals[j, i] * k.drag_rows[k.stuck[a], j] * friction
    return FIRST * velocity + acceleration


@part
def _first_of_slider(k: Any, rows: Any, z: Any, i: int, piece: int) -> Any:
    """Return the regime of a contact in whose tangential spring the stretch is a state.

    It slips where the spring is at its limit and the slider is not carried back from it.

    Args:
        piece: of its table of contact.
    """
    pressing, count = k.by_contact[contact_row.of_press], regimes_of_press(k, i)
    friction = k.tangential_springs[i] * z[k.sliders[i]]
    towards = friction if friction != 0.0 else k.by_contact[contact_row.lags, i]
    back = 1 if towards < 0.0 else 0
    regime = piece * count + back
    _put(k, rows, i, regime)
    state_forces(k, rows, z, pressing)
    lag = (1.0 - 2.0 * back) * k.by_contact[contact_row.lags, i]
    mu = rows[parameter_row.coefficients + OF_CONTACT * i, 0]
    # within round-off of its limit a spring is at it
    size = max(pressing[i], k.preloads[i] * rows[parameter_row.preload, 0])
    at_limit = abs(friction) >= mu * (pressing[i] - 1e-12 * size)
    if at_limit and slider_lag(k, rows, i, lag, z[k.n : 2 * k.n]) > 0.0:
        return regime
    return piece * count + count - 1


@part
def _first_at_belt_speed(k: Any, rows: Any, z: Any, i: int, piece: int) -> Any:
    """Return the first regime that fits a contact as fast as the belt; −1 where none does.

    Args:
        piece: of its table of contact.
    """
    pressing, count = k.by_contact[contact_row.of_press], regimes_of_press(k, i)
    for kind in (count - 1, 0, 1):
        regime = piece * count + kind
        _put(k, rows, i, regime)
        state_forces(k, rows, z, pressing)
        if kind == count - 1:
            fits = holds(k, rows, i, pressing[i])
        else:
            fits = (1.0 - 2.0 * kind) * holding(k, i) >= 0.0
        if fits:
            return regime
    return -1


@part
def _first_that_fits(k: Any, rows: Any, z: Any, i: int) -> Any:
    """Return the first regime of a contact that fits the state, the others' being as they are."""
    n, pressing = k.n, k.by_contact[contact_row.of_press]
    last = k.first[0, i + 1] - k.first[0, i] - 1
    size_q, size_v, reach = (
        abs(rows[parameter_row.preload, 0]),
        abs(rows[parameter_row.belt, 0]),
        0.0,
    )
    for j in range(n):
        if k.normals[j, i] != 0.0:
            size_q += abs(z[j])
        if k.tangentials[j, i] != 0.0:
            size_v += abs(z[n + j])
        reach = max(reach, abs(k.tangentials[j, i]))
    _put(k, rows, i, last)
    state_forces(k, rows, z, pressing)
    press, speed = pressing[i], k.by_contact[contact_row.lags, i]
    # An equality holds within this of the size of what it is computed from, as of
    # traced systems.
    equal = 1e-15
    if abs(press) <= equal * size_q and _rises(k, i, z) >= 0.0:
        return last
    if -FIRST * press - 1e14 * k.hidden[0] >= 0.0:
        return last
    piece = press_of_force(k, i, press)
    if k.sliders[i] >= 0:
        return _first_of_slider(k, rows, z, i, piece)
    if abs(speed) <= reach * equal * size_v:
        regime = _first_at_belt_speed(k, rows, z, i, piece)
        if regime >= 0:
            return regime
    return slip_regime(k, rows, i, speed, piece)


def find_starts(address: int) -> None:
    """Find the regimes in which the runs of a plan start; those that are given stay."""
    k = plan_at(address)
    t = record_at(address)
    c, jobs = k.c, t.n_jobs
    given = parameter_row.coefficients + OF_CONTACT * c + 1
    starts = view(t.starts, (jobs, given + k.n_states), np.float64)
    numbers = view(t.numbers, (jobs, c), np.int64)
    opened = view(t.opened, (c,), np.int64)
    rows = view(t.scratch, (given + c * k.width, LANES), np.float64)
    # Rounds over all contacts, for each of them, in which the others' regimes may still
    # change.
    sweeps = 4
    for job in range(jobs):
        for parameter in range(given):
            rows[parameter, 0] = starts[job, parameter]
        z, n_opened = starts[job, given:], 0
        for i in range(c):
            opened[i] = numbers[job, i] < 0
            n_opened += opened[i]
            if opened[i]:
                numbers[job, i] = 1
            _put(k, rows, i, numbers[job, i])
        for _ in range(sweeps * n_opened):
            changed = False
            for i in range(c):
                if opened[i]:
                    regime = _first_that_fits(k, rows, z, i)
                    changed = changed or regime != numbers[job, i]
                    numbers[job, i] = regime
                    _put(k, rows, i, regime)
            if not changed or c == 1:
                break
