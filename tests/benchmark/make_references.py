"""What is right: every problem by two independent ways, in more digits than a double has.

One way is a Taylor series in 80-bit long double (heyoka, which finds all roots of a step's
polynomial), the other Gragg's extrapolated midpoint rule (Gragg 1965) in 34 decimal digits. The
growth of a perturbation comes from displaced runs. A Taylor series in 50 digits gives the 30 that
are written beside the doubles. ``python -m tests.benchmark.make_references`` writes
``references.json``.
"""

import json
from collections import Counter
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import heyoka
import mpmath
import numpy as np

import squealpipe
from squealpipe.benchmark.problems import FORMULA_FUNCTIONS, Problem, all_data
from tests.benchmark.many_digits import ManyDigits

FILE = Path(squealpipe.__file__).parent / "benchmark/references.json"
DIGITS = 34
COMPUTED, WRITTEN = 50, 30
"""Digits of the Taylor series, and those of them that are written."""
TOLERANCE = np.longdouble(1e-19)
COLUMNS = 12
"""Of the extrapolation table: midpoint rules of 2, 4, …, 24 steps."""
with mpmath.workdps(DIGITS):
    RATIOS = {
        (column, k): mpmath.mpf(column) ** 2 / mpmath.mpf(column - k) ** 2 - 1
        for column in range(1, COLUMNS + 1)
        for k in range(1, column)
    }
"""Of the squared steps of a rule and of the k-th before it, less one."""
STEP_ERROR = mpmath.mpf(10) ** -24
SAMPLES = 24
CLOSE = 1e-22
LARGEST_DISAGREEMENT = 1e-15
ON_SURFACE, FALLING, NUDGE = 1e-17, 1e-9, 2.0**-30
NO_LIMIT = 10**12
AT_ONCE = 1e-12
MOST_PLACES = 4
"""Instants at which a run is displaced."""


class Motion(NamedTuple):
    """Final state, the events, and (time, state, regime) at the start and after each event."""

    state: Any
    times: list[Any]
    kinds: list[str]
    passed: list[tuple[Any, Any, str]]


class LongDouble:
    """A problem by heyoka's Taylor series in long double."""

    def __init__(self, data):
        functions = SimpleNamespace(
            **{name: getattr(heyoka, name) for name in FORMULA_FUNCTIONS}
        )
        symbols = Problem(
            data, functions, lambda v: heyoka.expression(np.longdouble(v))
        )
        self.problem = Problem(data, np, np.longdouble)
        self.problem.patience = NO_LIMIT
        y = [heyoka.expression(name) for name in symbols.states]
        self.runs = {}
        for regime in symbols.regimes:
            rates = symbols.field(heyoka.time, y, regime)
            equations = [
                (a, heyoka.expression(b)) for a, b in zip(y, rates, strict=True)
            ]
            zeros = np.zeros(len(y), np.longdouble)
            self.runs[regime] = heyoka.taylor_adaptive(
                equations, zeros, fp_type=np.longdouble, tol=TOLERANCE
            )

    def __call__(self, t=0.0, y=None, regime="", t_end=None):
        """From a state, by default the start, to ``t_end``."""
        problem = self.problem
        t, t_end = (
            np.longdouble(t),
            problem.t_end if t_end is None else np.longdouble(t_end),
        )
        y = np.array(problem.start) if y is None else y

        def step(regime, t, y):
            run = self.runs[regime]
            run.time, run.state[:] = t, y
            run.step(max_delta_t=t_end - t, write_tc=True)

            def flow(span):
                return run.update_d_output(t + span).copy() if span else y

            h = run.time - t
            return h, flow, [flow(k * h / SAMPLES) for k in range(SAMPLES + 1)]

        return _motion(problem, step, t, y, regime or problem.regime, t_end)


def extrapolated(field, t, y, h):
    """One step of Gragg's method: the state, its relative error, the states of the finest rule."""
    first, path = field(t, y), []
    rows: list[Any] = []
    for column in range(1, COLUMNS + 1):
        n = 2 * column
        part = h / n
        twice = 2 * part
        before, here = y, [a + part * b for a, b in zip(y, first, strict=True)]
        path = [y, here]
        for k in range(1, n):
            rates = field(t + k * part, here)
            after = [a + twice * b for a, b in zip(before, rates, strict=True)]
            before, here = here, after
            path.append(here)
        row = [here]
        for k, previous in enumerate(rows[-1] if rows else [], start=1):
            ratio = RATIOS[column, k]
            row.append(
                [a + (a - b) / ratio for a, b in zip(row[-1], previous, strict=True)]
            )
        rows.append(row)
    error = max(abs(a - b) for a, b in zip(rows[-1][-1], rows[-1][-2], strict=True))
    error /= max(map(abs, [mpmath.mpf(1), *y, *(h * rate for rate in first)]))
    return rows[-1][-1], error, path


def extrapolation(data):
    """A problem by Gragg's method in 34 digits."""
    with mpmath.workdps(DIGITS):
        problem = Problem(data, mpmath, mpmath.mpf)
        problem.patience = NO_LIMIT
        h = mpmath.mpf("0.25")

        def step(regime, t, y):
            nonlocal h

            def field(t, y):
                return problem.field(t, y, regime)

            made = min(h, problem.t_end - t)
            after, error, path = extrapolated(field, t, y, made)
            while error > STEP_ERROR:
                h = made = made / 2
                after, error, path = extrapolated(field, t, y, made)
            if error < STEP_ERROR / 10**7:
                h = made * 2
            return (
                made,
                lambda s: extrapolated(field, t, y, s)[0] if s else y,
                [*path[:-1], after],
            )

        return _motion(
            problem, step, mpmath.mpf(0), problem.start, problem.regime, problem.t_end
        )


def _motion(problem, step, t, y, regime, t_end):
    """Step from event to event; ``step`` gives the length, the flow within it, and samples."""
    motion = Motion(None, [], [], [(t, y, regime)])
    while t < t_end:
        h, flow, samples = step(regime, t, y)
        watched = problem.watched(regime)
        found = [
            _first_root(_along(problem, switch, t, regime), h, flow, samples)
            for switch in watched
        ]
        roots = [(root, i) for i, root in enumerate(found) if root is not None]
        span, which = min(roots, default=(h, -1))
        t, y = t + span, flow(span)
        if which >= 0:
            kind, regime, y = watched[which].fire(t, y, regime)
            motion.times.append(t)
            motion.kinds.append(kind)
            motion.passed.append((t, y, regime))
    return motion._replace(state=np.array(y))


def _along(problem, switch, t, regime):
    """A surface's value some span after t, and with ``nudge`` that a little later."""

    def surface(span, y, nudge=0.0):
        if nudge:
            rates = problem.field(t + span, y, regime)
            y = [a + nudge * b for a, b in zip(y, rates, strict=True)]
        return switch.when(t + span + nudge, y, regime)

    return surface


def _first_root(surface, h, flow, samples):  # noqa: C901
    """The earliest fall of a surface through zero within a step, from its start; None: none."""
    part = h / (len(samples) - 1)
    values = [surface(k * part, y) for k, y in enumerate(samples)]
    slopes = [
        (surface(k * part, y, NUDGE) - values[k]) / NUDGE for k, y in enumerate(samples)
    ]
    largest = max(map(abs, values))
    if largest == 0:
        return None
    eps = (h * 0 + 10) ** (-6)

    def at(span):
        return surface(span, flow(span))

    def slope(span):
        return (at(span + eps * h) - at(span - eps * h)) / eps

    if abs(values[0]) <= ON_SURFACE * largest and slopes[0] < -FALLING * largest:
        return h * 0  # another event, at the same time, has just been dealt with
    for k in range(1, len(values)):
        low, high = (k - 1) * part, k * part
        if values[k] > 0 or at(high) > 0:
            if (
                slopes[k - 1] >= 0
                or slopes[k] < 0
                or min(values[k - 1 : k + 1]) > largest / 10
            ):
                continue
            low, high = max(low - part, 0), min(high + part, h)
            high = _root(lambda s: -slope(s), low, high)
            if at(high) > 0:
                continue
        while low > 0 and at(low) < 0:  # the samples are coarse
            low = max(low - part, 0)
        if low == 0 and at(low) <= ON_SURFACE * largest:
            # it starts on the surface: from its peak, if it rises at all
            low = _root(slope, low, high)
            if at(low) <= 0:
                continue
        return _root(at, low, high)
    return None


def _root(function, low, high):
    """Where a function falls through zero, by Illinois' rule."""
    close = mpmath.eps if isinstance(high, mpmath.mpf) else CLOSE
    a, b = function(low), function(high)
    if a < 0 or b > 0:
        return high
    for _ in range(100):
        middle = high - b * (high - low) / (b - a)
        value = function(middle)
        if value == 0 or abs(middle - high) <= close * abs(high):
            return middle
        if value * b < 0:
            low, a = high, b
        else:
            a /= 2
        high, b = middle, value
    return high


def _displaced(run, motion, size):
    """Runs displaced in each moving state between events, with the events that went before."""
    problem = run.problem
    places = np.unique(np.linspace(0, len(motion.passed) - 1, MOST_PLACES).astype(int))
    found = []
    for place in places:
        t, y, regime = motion.passed[place]
        later = motion.times[place] if place < len(motion.times) else problem.t_end
        if later - t < AT_ONCE:  # behind the surface of the event that follows at once
            continue
        middle = (t + later) / 2
        y = run(t, y, regime, middle).state
        for i, rate in enumerate(problem.field(middle, y, regime)):
            if rate == 0:
                continue
            for sign in (-1, 1):
                moved = y.copy()
                moved[i] += sign * np.longdouble(size)
                found.append((int(place), run(middle, moved, regime)))
    return found


def growth_of(run, motion):
    """How a disturbance grows: of the final state, of each event's time; and the margin.

    The margin is the largest of 1e-2, 1e-3, … whose displacement leaves the events what they are;
    0 where an event that may or may not be seen comes at the instant of another, a ``tie``.
    """
    margin, growth, of_times = 0.0, 1.0, np.ones(len(motion.times))
    for exponent in range(-17, -1):
        size = 10.0**exponent
        alike = 0
        for place, other in (runs := _displaced(run, motion, size)):
            if Counter(other.kinds) != Counter(motion.kinds[place:]):
                continue
            alike += 1
            if exponent > -16 and margin == 0.0:
                continue
            if exponent <= -13:
                change = np.abs(other.state - motion.state).max() / size
                growth = max(growth, float(change))
                times = (
                    np.abs(np.sort(other.times) - np.array(motion.times[place:])) / size
                )
                of_times[place:] = np.maximum(of_times[place:], times.astype(float))
        if alike < len(runs):
            break
        margin = size
    return growth, of_times.tolist(), margin


def derivative(data, solve, number, step):
    """That of an event's time by a parameter, by central differences of order six."""
    event, name = data["derivative"]
    total = number(0)
    for k, weight in ((1, number(3) / 4), (2, -number(3) / 20), (3, number(1) / 60)):
        times = [
            solve({**data} | {"parameters": data["parameters"] | {name: value}}).times[
                event
            ]
            for value in (
                number(data["parameters"][name]) + s * k * step for s in (1, -1)
            )
        ]
        total += weight * (times[0] - times[1]) / step
    return total


def many_digits(data, digits=COMPUTED):
    """A problem by its Taylor series in 50 digits."""
    with mpmath.workdps(digits):
        run = ManyDigits(data, digits)
        problem = run.problem
        return _motion(
            problem,
            run.step,
            mpmath.mpf(0),
            problem.start,
            problem.regime,
            problem.t_end,
        )


def digits_of(data, motion):
    """Final state, times of events and derivative as texts of 30 digits."""

    def text(value):
        return mpmath.nstr(mpmath.chop(value, tol=10.0 ** (5 - COMPUTED)), WRITTEN)

    with mpmath.workdps(COMPUTED):
        written = {
            "state": list(map(text, motion.state)),
            "times": list(map(text, motion.times)),
        }
        if "derivative" in data:
            step = mpmath.mpf(2) ** -24
            written["derivative"] = text(
                derivative(data, many_digits, mpmath.mpf, step)
            )
    return written


def reference_of(data):
    """Final state, events, growth and margin of a problem, from the long-double way."""
    run = LongDouble(data)
    if "unknowable" in data:
        return {}
    motion = run()
    growth, of_times, margin = growth_of(run, motion)
    found = {
        "state": list(map(float, motion.state)),
        "times": list(map(float, motion.times)),
    }
    found |= {"kinds": motion.kinds, "growth": growth, "time_growth": of_times}
    found["margin"] = 0.0 if "tie" in data else margin
    if "derivative" in data:  # a difference of long doubles has no 15 digits left
        with mpmath.workdps(DIGITS):
            slope = derivative(data, extrapolation, mpmath.mpf, mpmath.mpf(2) ** -13)
        found["derivative"] = float(slope)
    return found


def disagreement(reference, motion):
    """Largest difference of the second way from the shipped reference, over the growth.

    Raises:
        ValueError: the events are others.
    """
    order = np.lexsort(
        (np.array(motion.kinds), np.round(np.array(motion.times, float), 12))
    )
    kinds = [motion.kinds[i] for i in order]
    mine = np.lexsort((reference["kinds"], np.round(reference["times"], 12)))
    if kinds != [reference["kinds"][i] for i in mine]:
        raise ValueError(f"events differ: {kinds} and {reference['kinds']}")
    found = [
        abs(float(a - mpmath.mpf(b))) / max(1.0, abs(b)) / reference["growth"]
        for a, b in zip(motion.state, reference["state"], strict=True)
    ]
    found += [
        abs(float(motion.times[i] - mpmath.mpf(reference["times"][j])))
        / max(1.0, reference["times"][j])
        / reference["time_growth"][j]
        for i, j in zip(order, mine, strict=True)
    ]
    return float(max(found))


def main():
    """Write ``references.json``, where both ways agree on each knowable problem.

    Raises:
        ValueError: they do not; nothing is written.
    """
    lines = []
    for data in all_data():
        reference = reference_of(data)
        if "unknowable" not in data:
            motion = many_digits(data)
            for other in (extrapolation(data), motion):
                difference = disagreement(reference, other)
                if difference > LARGEST_DISAGREEMENT:
                    raise ValueError(
                        f"{data['name']}: the ways differ by {difference:.1e}"
                    )
            reference["digits"] = digits_of(data, motion)
        lines.append(f"{json.dumps(data['name'])}: {json.dumps(reference)}")
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")


if __name__ == "__main__":
    main()
