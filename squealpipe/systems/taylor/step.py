"""Choose the length of a Taylor step of all lanes, and end it in a lane that crosses a surface.

Idea: the last two orders of the series bound the error, which gives the length of the step (Jorba
and Zou 2005; Biscani 2021); series of surfaces and outputs have to have converged as well. A
surface whose ends are further from zero than it bends has no root, which most lanes show at once;
the others are searched for the first root of their polynomials. Where round-off hides a root the
step is cut short before it. Invariant: no crossing within a step is passed over that the round-off
of its terms does not hide. Cost: without crossings, a few operations a surface for all lanes.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.taylor import layout
from squealpipe.systems.taylor.lanes import call
from squealpipe.systems.taylor.roots import (
    Watch,
    bounds_of,
    evaluate_all,
    evaluate_twice,
    first_crossing,
    is_hidden,
    root_search,
)
from squealpipe.systems.taylor.simd import (
    ROW,
    bits_below,
    choose,
    choose_below,
    first_bit,
    fma,
    larger,
    load,
    magnitude,
    rough_power,
    smaller,
    splat,
    store,
)
from squealpipe.systems.taylor.switching import gauge, surface_round_off


class SeriesConvergence(NamedTuple):
    """Thresholds by which a step is short enough for a series that is no state's.

    Attributes:
        spare: what its last orders may be more than those of the states. Doubling it lengthens
            steps by a few per cent, where such a series decides.
        fits: times that a step is fitted to the size of a series, which depends on the step.
            Doubling it costs as many passes more; the step hardly changes after the fourth.
    """

    spare: float = 100.0
    fits: int = 4


series_convergence = SeriesConvergence()


@inline
def step_length(base: int, terms: int, n_states: int, units: int) -> Any:
    """Lengths of the next steps from the last two orders (Jorba and Zou 2005; Biscani 2021).

    Args:
        units: address of the rows of one over the states' typical sizes.
    """
    size, last, previous = splat(1.0), splat(1e-300), splat(1e-300)
    for variable in range(n_states):
        series, unit = base + variable * terms * ROW, load(units + variable * ROW)
        size = larger(magnitude(load(series)) * unit, size)
        last = larger(magnitude(load(series + (terms - 1) * ROW)) * unit, last)
        previous = larger(magnitude(load(series + (terms - 2) * ROW)) * unit, previous)
    order = terms - 1.0
    reach = smaller(
        rough_power(size / last, splat(1.0 / order)),
        rough_power(size / previous, splat(1.0 / (order - 1.0))),
    )
    return reach * math.exp(-2.0 - 0.7 / (order - 1.0))


@inline
def reach(series: int, terms: int) -> Any:
    """Longest step of a series that is no state's, from ratios of its orders.

    Where the state rests, what depends on the time alone still needs short steps. Its highest
    order may be left out. Of a quantity that is kept at zero all orders are round-off.
    """
    reach, tiny = splat(0.0), splat(1e-300)
    # below the round-off of any quantity
    nothing = 1e-30
    for low in (0, 1, 2):
        base, nearer = magnitude(load(series + low * ROW)), splat(np.inf)
        if low == 0:
            base = splat(nothing)
        for high in (terms - 3, terms - 2):
            last = magnitude(load(series + high * ROW))
            power = rough_power(
                larger(base, tiny) / larger(last, tiny), splat(1.0 / (high - low))
            )
            nearer = smaller(nearer, choose_below(tiny, last, power, splat(np.inf)))
        reach = larger(reach, nearer)
    return reach * math.exp(-2.0)


@inline
def converged_steps(series: int, terms: int, step: Any) -> Any:
    """The longest steps, up to those given, in which a series that is no state's has converged.

    Its last orders are to be as small beside its first ones, over the step, as those of the
    states; the highest may be left out. Where the state rests, what depends on the time alone
    still needs short steps.
    """
    height = magnitude(load(series))
    slope = magnitude(load(series + ROW))
    bend = magnitude(load(series + 2 * ROW))
    last = magnitude(load(series + (terms - 3) * ROW))
    later = magnitude(load(series + (terms - 2) * ROW))
    tiny, shorter = splat(1e-300), step
    for _ in range(series_convergence.fits):
        size = height + shorter * (slope + shorter * bend)
        target = smaller(
            _until(size, last, terms - 3.0), _until(size, later, terms - 2.0)
        )
        shorter = smaller(shorter, choose_below(tiny, size, target, shorter))
    return shorter


@inline
def _until(size: Any, last: Any, order: float) -> Any:
    """Steps at the end of which a last order is as small beside a size as it is to be."""
    tiny = splat(1e-300)
    power = rough_power(larger(size, tiny) / larger(last, tiny), splat(1.0 / order))
    return choose_below(tiny, last, power * math.exp(-2.0), splat(np.inf))


@inline
def _has_converged(series: int, terms: int, step: Any, power: Any) -> Any:
    """Lanes with steps up to :func:`converged_steps`; ``power`` is that of order terms − 3."""
    size = magnitude(load(series + 2 * ROW))
    for k in (1, 0):
        size = fma(size, step, magnitude(load(series + k * ROW)))
    share = series_convergence.spare * math.exp(-2.0 * (terms - 3.0))
    last = magnitude(load(series + (terms - 3) * ROW)) * power
    later = magnitude(load(series + (terms - 2) * ROW)) * power * step
    size = size * splat(share)
    return bits_below(last, size) & bits_below(later, size * math.exp(-2.0))


@inline
def shorten_steps(t: Any, m: Any, step: Any) -> Any:
    """Steps in which the series of surfaces and outputs have converged."""
    terms, first = t.n_terms, t.series + t.n_variables * t.n_terms * ROW
    power = shortest = step
    for _ in range(terms - 4):
        power = power * step
    for event in range(t.n_surfaces + t.n_outputs):
        if m.bent[event] and m.active[event]:
            series = first + event * terms * ROW
            bits = ~_has_converged(series, terms, step, power) & m.active[event]
            if bits:
                converged = converged_steps(series, terms, step)
                shortest = choose(bits, smaller(converged, shortest), shortest)
    return shortest


@inline
def slope_at_end(series: int, terms: int, step: Any) -> Any:
    """A series' rate at the end of its step."""
    value, slope = load(series + (terms - 1) * ROW), splat(0.0)
    for k in range(terms - 2, -1, -1):
        slope = fma(slope, step, value)
        value = fma(value, step, load(series + k * ROW))
    return slope


@inline
def at_end(series: int, terms: int, step: Any) -> Any:
    """A series' value at the end of its step."""
    value = load(series + (terms - 1) * ROW)
    for k in range(terms - 2, -1, -1):
        value = fma(value, step, load(series + k * ROW))
    return value


@inline
def _free(m: Any, c: Any, index: int, surface: int, series: int, step: Any) -> Any:
    """Those of the lanes that watch a surface in which it has no root in the step.

    Where all its terms together are below its start it has none, which is looked at first; how far
    it bends is computed only if that does not tell of all lanes. What round-off may have hidden,
    at the end of this step or of the one before, is looked at.

    One that starts from zero has no other root where its slope outweighs all that follows.
    """
    terms = c.shape[1]
    change = magnitude(load(series + (terms - 1) * ROW))
    for k in range(terms - 2, 0, -1):
        change = fma(change, step, magnitude(load(series + k * ROW)))
    fresh = 0 if m.clocks[surface] else m.fresh[surface]
    if fresh:
        # the tenth that is left is far more than round-off
        outweighs = 1.9
        fresh &= bits_below(change, magnitude(load(series + ROW)) * splat(outweighs))
        fresh = _leaves(m, c, index, surface, fresh)
    start, change = magnitude(load(series)), change * step
    # relative to the terms: of their sum, and of a surface that is computed anew from the state
    rounding = 1e-14
    free = bits_below(fma(change, splat(rounding), change), start) | fresh
    if m.active[surface] & ~free:
        free |= _bends_little(series, terms, step, (start + change) * splat(rounding))
    return free


@part
def _leaves(m: Any, c: Any, index: int, surface: int, lanes: int) -> int:
    """Those of some lanes in which a surface that starts from zero goes to no switch at once."""
    bits = lanes
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        regime = m.integers[layout.integers.first_regime + m.owner[surface], lane]
        slope = c[index, 1, lane]
        which = m.falls[regime, surface] if slope < 0.0 else m.rises[regime, surface]
        if which >= 0 and m.marks[regime, surface] == 0:
            lanes ^= 1 << lane
    return lanes


@inline
def _bends_little(series: int, terms: int, step: Any, rounding: Any) -> Any:
    """Lanes in which both ends of a surface are further from zero than it bends, and round-off."""
    value, bend = load(series + (terms - 1) * ROW), splat(0.0)
    for k in range(terms - 1, 1, -1):
        row = load(series + k * ROW)
        bend = fma(bend, step, magnitude(row) * splat(k * (k - 1.0)))
        value = fma(value, step, row)
    value = fma(value, step, load(series + ROW))
    first = load(series)
    value = fma(value, step, first)
    free = bits_below(splat(0.0), first * value)
    nearest = smaller(magnitude(first), magnitude(value))
    return free & bits_below(fma(bend * step, step * 0.125, rounding), nearest)


@inline
def reaches(rows: int, instant: int) -> Any:
    """Lanes whose step does not end before the instant in a row."""
    left = load(rows + instant * ROW) - load(rows + layout.numbers.clock * ROW)
    return ~bits_below(
        load(rows + layout.numbers.step * ROW),
        left - load(rows + layout.numbers.correction * ROW),
    )


@inline
def take_step(t: Any, m: Any, c: Any, parameters: int) -> Any:
    """Ends of all lanes' steps; returns the lanes that need a look of their own."""
    terms, base, at = t.n_terms, t.series, t.rows
    step = smaller(
        step_length(base, terms, t.n_states, t.units),
        load(at + layout.numbers.longest * ROW),
    )
    if t.n_variables > t.n_states:
        for each in range(t.n_surfaces + t.n_tracked - t.n_states):
            step = smaller(
                step, reach(base + (t.n_variables + each) * terms * ROW, terms)
            )
    natural = left = step
    if t.shorten or m.share[2] != 0.0:
        left = load(at + layout.numbers.t_end * ROW) - load(
            at + layout.numbers.clock * ROW
        )
        left = left - load(at + layout.numbers.correction * ROW)
        step = shorten_steps(t, m, smaller(step, left))
    if t.shorten:
        # what a step leaves of the longest one of late; near a root of a base steps shrink by
        # half
        fading = 0.95
        reached = load(at + layout.numbers.reach * ROW) * splat(fading)
        store(at + layout.numbers.reach * ROW, larger(reached, step))
        store(at + layout.numbers.step * ROW, step)
        call(t.shorten, (base, parameters, at + layout.numbers.step * ROW, terms))
        # of the time reached: a step below it would not move the state, and none is shortened to
        # that
        resolved_share = 2.0**-50
        resolved = magnitude(load(at + layout.numbers.clock * ROW)) * splat(
            resolved_share
        )
        short, least = load(at + layout.numbers.step * ROW), smaller(step, resolved)
        across = load(at + layout.numbers.across * ROW)
        across = choose_below(short, least, splat(1.0), across)
        store(at + layout.numbers.across * ROW, across)
        step = larger(short, least)
    store(at + layout.numbers.step * ROW, step)
    store(at + layout.numbers.natural * ROW, choose_below(step, left, step, natural))
    lost = step
    for variable in range(t.n_variables):
        value = at_end(base + variable * terms * ROW, terms, step)
        store(at + (layout.numbers.first_of_system + variable) * ROW, value)
        lost = lost + value * 0.0
    plain = bits_below(magnitude(lost), splat(np.inf))
    for surface in range(t.n_surfaces):
        if m.active[surface]:
            index, watching = t.n_variables + surface, m.active[surface]
            series = base + index * terms * ROW
            free = _free(m, c, index, surface, series, step) & ~m.beyond[surface]
            # the others are not searched, whatever else ends the step
            m.suspects[surface] = ~free
            plain &= free | ~watching
    return (
        ~plain | reaches(at, layout.numbers.t_end) | reaches(at, layout.numbers.t_late)
    )


@part
def _switch_at(
    c: Any, index: int, lane: int, root: float, falls: int, rises: int
) -> Any:
    """The switch of a surface at its root: that of the side to which it goes, if it has both."""
    if rises < 0:
        return falls
    if falls < 0:
        return rises
    _, slope, _ = evaluate_twice(c, index, lane, root)
    return falls if slope < 0.0 else rises


@part
def _bounds(t: Any, m: Any, c: Any, lane: int, surface: int, step: float) -> Any:
    """Bounds of a surface over a step; :func:`_is_finite` has noted those over the whole of it."""
    if step == m.rows[layout.numbers.step, lane]:
        return m.scratch[3, surface], m.scratch[3, t.n_surfaces + surface]
    return bounds_of(c, t.n_variables + surface, lane, step)


@part
def _first_switch(t: Any, m: Any, c: Any, lane: int, step: float) -> float:
    """Find when the first watched surface is crossed, or the step; its switch goes into ``hit``."""
    integers = m.integers
    bit = 1 << lane
    first, tie, complete, winner = step, step * 2.0**-44, step, -1
    unclear = False
    for surface in range(t.n_surfaces):
        regime = integers[layout.integers.first_regime + m.owner[surface], lane]
        falls, rises = m.falls[regime, surface], m.rises[regime, surface]
        if (falls < 0 and rises < 0) or not m.suspects[surface] & bit:
            continue
        root = 0.0
        if not m.beyond[surface] & bit:
            fresh = (m.fresh[surface] & bit) != 0
            at_once = m.marks[regime, surface] == 0
            if m.clocks[surface]:
                ticked = m.ticked[surface, lane] == m.rows[layout.numbers.clock, lane]
                at_once = fresh and not ticked  # of a marker, too
            watch = Watch(
                falls >= 0,
                rises >= 0,
                fresh,
                at_once,
                m.noise[surface, 0, lane],
                m.noise[surface, 1, lane],
            )
            index = t.n_variables + surface
            third, floor = _bounds(t, m, c, lane, surface, step)
            root, looked = first_crossing(c, index, lane, step, watch, third, floor)
            unclear |= root == root_search.undecided
            complete = min(complete, looked)
        if root < 0.0 or root > first + tie:
            continue
        which = _switch_at(c, t.n_variables + surface, lane, root, falls, rises)
        earlier = root < first - tie or integers[layout.integers.hit, lane] < 0
        # of switches at one instant the first by name goes first, whatever their order
        if earlier or which < integers[layout.integers.hit, lane]:
            first, integers[layout.integers.hit, lane] = min(root, first), which
            winner = surface
    # a step may be shortened to this share of it where round-off hides a surface at its end
    least_share = 0.1
    if winner >= 0:
        at_once = (m.beyond[winner] | m.fresh[winner]) & bit and first == 0.0
        unclear = not at_once and _is_hidden(t, m, c, lane, winner, step, first)
    elif complete > least_share * step:  # the rest is looked at from there
        first = min(first, complete)
        unclear = False
    if unclear:
        integers[layout.integers.outcome, lane] = layout.outcomes.hidden
    return first


@part
def _is_hidden(
    t: Any, m: Any, c: Any, lane: int, surface: int, step: float, root: float
) -> bool:
    """Tell whether round-off of a surface's series, or of its terms, hides where it is crossed.

    What is uncertain is compared with the step that the series allow, not with one that the end of
    the run cuts short. A surface that has started from zero and soon returns, as where impacts
    accumulate, is crossed there if it is clear of round-off halfway and half as long again.
    """
    index = t.n_variables + surface
    span = min(m.rows[layout.numbers.natural, lane], m.rows[layout.numbers.t_end, lane])
    within = step
    # share of a step: a surface that returns to zero by then may chatter; its root is uncertain
    # by no more than half of this time
    soon = 1e-2
    if m.fresh[surface] & (1 << lane) and root <= soon * span:
        span, within = max(span, 0.5 * root / root_search.unsure), min(step, 2.0 * root)
    _, floor = _bounds(t, m, c, lane, surface, within)
    # a root that this many times the round-off would hide may be hidden by that of its terms
    suspect = 1e6
    if not is_hidden(c, index, lane, span, root, suspect * floor):
        return False
    evaluate_all(c, t.n_variables, lane, root, m.scratch[0])
    for variable in range(t.n_variables):
        m.scratch[1, variable] = abs(m.scratch[0, variable])
    gauge(t, lane, m.scratch.shape[1])
    floor = max(floor, surface_round_off.noise * m.scratch[2, 3 * surface + 1])
    return bool(is_hidden(c, index, lane, span, root, floor))


@part
def _is_finite(t: Any, m: Any, c: Any, lane: int) -> bool:
    """Tell whether a lane's step and its surfaces are finite; others might be searched for ever.

    Puts bounds of their third derivatives, and of their round-off, into the scratch, which the
    search needs as well.
    """
    total = m.rows[layout.numbers.step, lane]
    for variable in range(t.n_variables):
        total += 0.0 * m.rows[layout.numbers.first_of_system + variable, lane]
    for surface in range(t.n_surfaces):
        if m.active[surface] & m.suspects[surface] & (1 << lane):
            third, floor = bounds_of(
                c, t.n_variables + surface, lane, m.rows[layout.numbers.step, lane]
            )
            m.scratch[3, surface], m.scratch[3, t.n_surfaces + surface] = third, floor
            total += 0.0 * third
    return math.isfinite(total)


@part
def cut(t: Any, m: Any, c: Any, lane: int) -> None:
    """End a lane's step at the first crossing, at the late time or at the end of its run."""
    rows, integers = m.rows, m.integers
    integers[layout.integers.hit, lane] = -1
    if not _is_finite(t, m, c, lane):
        rows[layout.numbers.step, lane] = 0.0
        integers[layout.integers.outcome, lane] = layout.outcomes.not_finite
        for variable in range(
            t.n_variables
        ):  # of its series higher orders may be no numbers
            rows[layout.numbers.first_of_system + variable, lane] = c[variable, 0, lane]
        return
    done = rows[layout.numbers.clock, lane]
    remaining = (rows[layout.numbers.t_end, lane] - done) - rows[
        layout.numbers.correction, lane
    ]
    step = min(rows[layout.numbers.step, lane], remaining)
    ends = remaining <= rows[layout.numbers.step, lane]
    late = (rows[layout.numbers.t_late, lane] - done) - rows[
        layout.numbers.correction, lane
    ]
    turns_late = late <= step
    if turns_late:
        step, ends = late, ends and late >= remaining
    first = _first_switch(t, m, c, lane, step)
    if integers[layout.integers.outcome, lane] == layout.outcomes.hidden:
        integers[layout.integers.hit, lane] = -1
        step, ends, turns_late = first, False, False
    elif integers[layout.integers.hit, lane] >= 0 or first < step:
        step, ends, turns_late = first, False, False
    if step != rows[layout.numbers.step, lane]:
        rows[layout.numbers.step, lane] = step
        set_end(t, m, c, lane)
    if turns_late:
        integers[layout.integers.hit, lane] = layout.integers.late_begins
    if ends:
        integers[layout.integers.outcome, lane] = layout.outcomes.converged


@part
def set_end(t: Any, m: Any, c: Any, lane: int) -> None:
    """The variables at the end of a lane's step."""
    values = m.scratch[4]
    evaluate_all(c, t.n_variables, lane, m.rows[layout.numbers.step, lane], values)
    for variable in range(t.n_variables):
        m.rows[layout.numbers.first_of_system + variable, lane] = values[variable]
