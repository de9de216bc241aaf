"""Test of a step before it is believed: rates and surfaces at its end beside those of its series.

The length of a step comes from the last orders of its series, which may show nothing of what it
leads into. At its end rates, surfaces and outputs are computed from the state: where they differ
from their polynomials by more than the tolerance's share, the step is halved.
"""

import math
from typing import Any, NamedTuple

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.taylor import layout
from squealpipe.systems.taylor.lanes import call
from squealpipe.systems.taylor.roots import evaluate, evaluate_twice
from squealpipe.systems.taylor.simd import (
    ROW,
    bits_below,
    first_bit,
    fma,
    larger,
    load,
    magnitude,
    splat,
)
from squealpipe.systems.taylor.step import at_end, cut, set_end, slope_at_end
from squealpipe.systems.taylor.switching import gauge, surface_round_off


class StepChecks(NamedTuple):
    """Thresholds by which a step is believed, halved or given up.

    Attributes:
        rate_round_off: of a rate, relative to it. Doubling it believes steps across jumps twice as
            high.
        helpless: a difference below this many tolerances that a halved step does not halve is
            round-off. Doubling it takes larger jumps for round-off.
        finest: share of the time reached below which there is no step, and of the whole run below
            which steps that move nothing lead nowhere. Doubling it gives up one halving earlier.
    """

    rate_round_off: float = 1e-14
    helpless: float = 1e5
    finest: float = 2.0**-52


step_checks = StepChecks()


@inline
def differing(t: Any, m: Any, parameters: int) -> Any:
    """Lanes at the end of whose steps something may differ from its polynomial by too much."""
    terms, base, at = t.n_terms, t.series, t.rows
    call(t.verify, (at + layout.numbers.first_of_system * ROW, parameters, t.exact))
    step, share = load(at + layout.numbers.step * ROW), m.share[0]
    size = splat(1.0)
    for variable in range(t.n_states):
        start = magnitude(load(base + variable * terms * ROW))
        size = larger(start * load(t.units + variable * ROW), size)
    size = size * splat(share)
    agree = bits_below(splat(0.0), splat(1.0))
    for variable in range(t.n_states):
        if m.steep[variable]:
            slope = slope_at_end(base + variable * terms * ROW, terms, step)
            unit = step * load(t.units + variable * ROW)
            gap = magnitude(load(t.exact + variable * ROW) - slope) * unit
            limit = fma(
                magnitude(slope) * unit, splat(step_checks.rate_round_off), size
            )
            agree &= bits_below(gap, limit)
    for event in range(t.n_surfaces + t.n_outputs):
        if m.bent[event] and m.active[event]:
            agree &= _event_agrees(t, event, step, share) | ~m.active[event]
    if t.shorten:
        agree &= ~bits_below(splat(0.0), load(at + layout.numbers.across * ROW))
    return ~agree & bits_below(splat(0.0), step)


@inline
def _event_agrees(t: Any, event: int, step: Any, share: float) -> Any:
    series = t.series + (t.n_variables + event) * t.n_terms * ROW
    exact = load(t.exact + (t.n_states + event) * ROW)
    gap = magnitude(at_end(series, t.n_terms, step) - exact)
    size = larger(magnitude(load(series)), magnitude(exact))
    return bits_below(gap, size * splat(share))


@inline
def end_stalled(t: Any, m: Any, c: Any, busy: int) -> int:
    """End the runs whose steps have shrunk without end; returns their lanes.

    The step has moved no variable, so that all later ones are like it, and the run would take more
    than 2⁵² of them. So it is where a numerator vanishes with its base, as in Painlevé's problem.
    """
    short = splat(step_checks.finest) * load(t.rows + layout.numbers.t_end * ROW)
    bits = bits_below(load(t.rows + layout.numbers.step * ROW), short) & busy
    ended = 0
    while bits:
        lane = first_bit(bits)
        bits ^= 1 << lane
        if stands_still(t, m, c, lane):
            m.integers[layout.integers.outcome, lane] = layout.outcomes.discontinuity
            ended |= 1 << lane
    return ended


@part
def stands_still(t: Any, m: Any, c: Any, lane: int) -> bool:
    """Tell whether a running lane stands still: no variable moved, nor will one move next."""
    hit, outcome = (
        m.integers[layout.integers.hit, lane],
        m.integers[layout.integers.outcome, lane],
    )
    if hit != -1 or outcome != layout.outcomes.running:
        return False
    for variable in range(t.n_variables):
        start, end = (
            c[variable, 0, lane],
            m.rows[layout.numbers.first_of_system + variable, lane],
        )
        if start != end:
            return False
    fresh = False  # the next step of a surface that starts from zero is another
    for surface in range(t.n_surfaces):
        fresh |= m.fresh[surface] & (1 << lane) != 0
    return not fresh


@part
def _largest_gap(t: Any, m: Any, c: Any, lane: int) -> float:
    """The largest difference at the end of a lane's step, over what is tolerated."""
    step, share = m.rows[layout.numbers.step, lane], m.share[0]
    size, most = 1.0, 0.0
    for variable in range(t.n_states):
        size = max(size, abs(c[variable, 0, lane]) * m.units[variable, lane])
    for variable in range(t.n_states):
        if m.steep[variable]:
            _, slope, _ = evaluate_twice(c, variable, lane, step)
            unit = step * m.units[variable, lane]
            limit = size * share + abs(slope) * unit * step_checks.rate_round_off
            ratio = abs(m.exact[variable, lane] - slope) * unit / limit
            most = ratio if not ratio <= most else most
    z, sizes = m.scratch[0], m.scratch[1]
    for variable in range(t.n_variables):
        z[variable] = m.rows[layout.numbers.first_of_system + variable, lane]
        sizes[variable] = abs(z[variable])
    gauge(t, lane, m.scratch.shape[1])
    for event in range(t.n_surfaces + t.n_outputs):
        if m.bent[event] and m.active[event] & (1 << lane):
            ratio = _event_gap(t, m, c, lane, event)
            most = ratio if not ratio <= most else most
    return most


@part
def _jumps(t: Any, m: Any, c: Any, lane: int) -> bool:
    """Tell whether a rate jumps in a lane's step, which leads across the root of a base."""
    reach, most = m.rows[layout.numbers.reach, lane], 0.0
    for variable in range(t.n_states):
        if m.steep[variable]:
            change = abs(m.exact[variable, lane] - c[variable, 1, lane])
            most = max(most, change * m.units[variable, lane])
    # a rate jumps in a step across the root of a base (``bases``) if it changes there by so many
    # sizes of its state, over the longest step of late
    jump = 1e-4
    return bool(most * reach > jump)


@part
def _event_gap(t: Any, m: Any, c: Any, lane: int, event: int) -> float:
    """Difference of a surface or output, over the tolerated one; its terms are in the scratch."""
    index, terms = t.n_variables + event, m.scratch[2, 3 * event + 1]
    exact = m.exact[t.n_states + event, lane]
    size = max(abs(c[index, 0, lane]), abs(exact))
    # of a surface or output, relative to its terms
    round_off = 1e-13
    # a surface or output below this has too few digits left to compare
    tiny = 1e-300
    limit = max(m.share[0] * size, round_off * terms, tiny)
    if event < t.n_surfaces and m.fresh[event] & (1 << lane):
        limit += max(surface_round_off.slack, m.share[1]) * terms
    gap = abs(evaluate(c, index, lane, m.rows[layout.numbers.step, lane]) - exact)
    # an output of another regime need not be a number
    agrees = gap == 0.0 or (event >= t.n_surfaces and not gap >= 0.0)
    return 0.0 if agrees else gap / limit


@part
def believe_or_halve(t: Any, m: Any, c: Any, lane: int) -> bool:
    """Return whether a lane's step stands after all; else halve it or end the run."""
    rows, integers = m.rows, m.integers
    gap = _largest_gap(t, m, c, lane)
    # the difference that a jump leaves is halved with the step, as that of round-off is
    across = rows[layout.numbers.across, lane] > 0.0
    jumps = across and _jumps(t, m, c, lane)
    helpless = (
        not across and 0.5 * rows[layout.numbers.gap, lane] < gap < step_checks.helpless
    )
    if (gap <= 1.0 and not jumps) or helpless:
        return True
    rows[layout.numbers.gap, lane] = gap
    rows[layout.numbers.steps, lane] += 1.0
    integers[layout.integers.hit, lane], integers[layout.integers.outcome, lane] = (
        -1,
        layout.outcomes.running,
    )
    step = 0.5 * rows[layout.numbers.step, lane]
    if gap <= 1.0:
        integers[layout.integers.outcome, lane] = layout.outcomes.discontinuity
    elif (
        not step > step_checks.finest * abs(rows[layout.numbers.clock, lane])
        or step < 1e-290
    ):
        finite = gap < math.inf
        ends = layout.outcomes.discontinuity if finite else layout.outcomes.not_finite
        integers[layout.integers.outcome, lane] = ends
    elif rows[layout.numbers.steps, lane] >= rows[layout.numbers.most_steps, lane]:
        integers[layout.integers.outcome, lane] = layout.outcomes.step_limit
    ended = integers[layout.integers.outcome, lane] != layout.outcomes.running
    rows[layout.numbers.step, lane] = 0.0 if ended else step
    set_end(t, m, c, lane)
    if not ended:
        cut(t, m, c, lane)
    return bool(ended)
