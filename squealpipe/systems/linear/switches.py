"""Regimes that switches enter, kinds of events, and states after them."""

from typing import Any

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.linear.contact_numbers import (
    contact_row,
    friction_of,
    press_of_regime,
    regime_value,
    regimes_of_press,
    slip_regime,
)
from squealpipe.systems.linear.forces import (
    rate_of_force,
    state_forces,
    stretch_per_force,
)
from squealpipe.systems.linear.matrices import regime_constant
from squealpipe.systems.linear.numbering import event_number, switch_number
from squealpipe.systems.linear.sticking import holds


@part
def _change_slider(k: Any, rows: Any, which: int, z: Any, block: int) -> Any:
    """Return regime, kind of the event, and stretch after a switch of a contact with a slider.

    What slips has a spring at its limit of friction, what lands has a relaxed one.

    Args:
        block: first regime of the contact's piece of its table of contact.
    """
    what, i = k.switches[which, 0], k.switches[which, 1]
    spring, stick = k.tangential_springs[i], regimes_of_press(k, i) - 1
    if what == switch_number.separation:
        return k.first[0, i + 1] - k.first[0, i] - 1, event_number.separates, 0.0
    if what == switch_number.reversal:
        return block + stick, event_number.sticks, z[k.sliders[i]]
    pressing, v = k.by_contact[contact_row.of_press], z[k.n : 2 * k.n]
    state_forces(k, rows, z, pressing)
    if what == switch_number.contact:
        # just after, forces grow in proportion to the time; the static limit is not passed before
        lag = k.by_contact[contact_row.lags, i]
        _, static, _ = friction_of(k, rows, i)
        if spring * abs(lag) <= static * rate_of_force(k, rows, i, v):
            return stick, event_number.lands, 0.0
        return slip_regime(k, rows, i, lag, 0), event_number.lands, 0.0
    back = what == switch_number.slips_back
    limit = stretch_per_force(k, rows, i) * pressing[i]
    return block + back, event_number.slips_away, -limit if back else limit


@inline
def change_state(k: Any, rows: Any, which: int, z: Any, out: Any) -> None:
    """Write the regime that a switch enters, the kind of the event, and the state after it."""
    what, i, target = k.switches[which, 0], k.switches[which, 1], k.switches[which, 2]
    n, first = k.n, k.first[0, i]
    count = regimes_of_press(k, i)
    block = count * press_of_regime(k, rows, i)
    after = out[2 : 2 + k.n_states]
    for j in range(k.n_states):
        after[j] = z[j]
    if k.sliders[i] >= 0 and what != switch_number.knot:
        regime, kind, after[k.sliders[i]] = _change_slider(k, rows, which, z, block)
        out[0], out[1] = float(first + regime), float(k.first[1, i] + kind)
        return
    regime, kind = 0, event_number.lands
    if what == switch_number.separation:
        regime, kind = k.first[0, i + 1] - first - 1, event_number.separates
    elif what == switch_number.knot:
        regime, kind = target - first, event_number.passes
    elif what == switch_number.slips or (
        what != switch_number.contact and what != switch_number.reversal
    ):
        regime, kind = (
            block + (0 if what == switch_number.slips else 1),
            event_number.slips_away,
        )
    else:
        # values go where nothing is read any more
        pressing = k.by_contact[contact_row.of_press]
        state_forces(k, rows, z, pressing)
        speed = k.by_contact[contact_row.lags, i]
        if what == switch_number.contact:
            regime = slip_regime(k, rows, i, speed, 0)
        else:
            for j in range(n):
                after[n + j] += k.drag_rows[i, j] / k.mobility[i, i] * speed
            regime, kind = block, event_number.reverses
            if holds(k, rows, i, pressing[i]):
                regime, kind = block + count - 1, event_number.sticks
            elif regime_value(k, rows, i, regime_constant.direction) >= 0.0:
                regime = block + 1
    out[0], out[1] = float(first + regime), float(k.first[1, i] + kind)
