"""Structures with friction contacts, event by event with power series; shares no code.

Coulomb friction with one coefficient makes a motion linear between events. After an event what is
violated changes, the first contact first and from the first again after each change, until nothing
is. Without a static limit of its own one combination alone violates nothing, for independent
directions. A table of normal force over compression is a straight line from knot to knot.
"""

from functools import partial
from itertools import pairwise

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

OPEN = 2
"""Side of a contact that is open; 1 and −1 are slip slower and faster than the belt, 0 stick."""
SAME = 1e-9
"""Heights and speeds below this are one event."""
NOTHING = 1e-13
"""Round-off of heights."""
ORDERS = 24
"""Orders of power series."""
SIDES = {"slip_slower": 1, "slip_faster": -1, "stick": 0, "separated": OPEN}
"""Side of a contact by the name of its regime."""


class ManyContacts:
    """A structure's matrices, and the state with the side of each contact.

    A tangential spring has a stretch among the states: with the belt in stick, after the normal
    force in slip, 0 in the air.
    """

    def __init__(self, structure, q, v):
        self.mass = np.asarray(structure.mass.todense())
        self.stiffness = np.asarray(structure.stiffness.todense())
        self.damping = np.asarray(structure.damping.todense())
        self.n, self.t = structure.normals, structure.tangentials
        self.tables = [table(each) for each in structure.contacts]
        self.preload = np.array([each.preload for each in structure.contacts])
        self.pressed = [
            compression(*each, force)
            for each, force in zip(self.tables, self.preload, strict=True)
        ]
        self.belt = structure.speeds * structure.belt_speed
        self.load = structure.load
        self.mu, self.mu_static = (
            np.array([getattr(each, name) for each in structure.frictions])
            for name in ("mu", "static_mu")
        )
        springs = [each.tangential_stiffness for each in structure.contacts]
        sprung = [i for i, spring in enumerate(springs) if spring]
        size = len(self.mass)
        # contact → spring, and place of its stretch
        self.springs = {i: (springs[i], 2 * size + a) for a, i in enumerate(sprung)}
        self.state = np.array([*q, *v, *[0.0] * len(sprung)])
        lifts = self.n.T @ self.state[:size]
        self.piece = [
            max(int(np.searchsorted(knots, pressed - lift, side="right")) - 1, 0)
            for (knots, *_), pressed, lift in zip(
                self.tables, self.pressed, lifts, strict=True
            )
        ]
        self.side = [
            OPEN if force <= 0 else 0 if i in self.springs else int(np.sign(speed))
            for i, (force, speed) in enumerate(
                zip(self.normal(self.state), self.speed(self.state), strict=True)
            )
        ]

    def row(self, i):
        """(row of z and 1) that gives the normal force of a contact in its piece."""
        knots, forces, slopes = self.tables[i]
        j, size = self.piece[i], len(self.mass)
        row = np.zeros(len(self.state) + 1)
        row[:size] = -slopes[j] * self.n[:, i]
        row[-1] = forces[j] + slopes[j] * (self.pressed[i] - knots[j])
        return row

    def rate_row(self, i):
        """Likewise its rate."""
        row, size = np.zeros(len(self.state) + 1), len(self.mass)
        row[size : 2 * size] = self.row(i)[:size]
        return row

    def speed_row(self, i):
        """Likewise the sliding speed."""
        row, size = np.zeros(len(self.state) + 1), len(self.mass)
        row[size : 2 * size], row[-1] = -self.t[:, i], self.belt[i]
        return row

    def normal(self, z):
        return [self.row(i) @ np.append(z, 1.0) for i in range(len(self.tables))]

    def speed(self, z):
        size = len(self.mass)
        return self.belt - self.t.T @ z[size : 2 * size]

    def flow(self, sides):
        """z′ = A z + b as one matrix, and rows (of z and 1) that give the forces of stick."""
        size, width = len(self.mass), len(self.state) + 1
        whole, force = np.zeros((width, width)), np.zeros((size, width))
        force[:, :size], force[:, size : 2 * size] = -self.stiffness, -self.damping
        force[:, -1] = self.load
        held = np.zeros((len(sides), width))
        for i, side in enumerate(sides):
            if side == OPEN:
                continue
            push = self.n[:, i] + side * self.mu[i] * self.t[:, i]
            force += np.outer(push, self.row(i))
            if i in self.springs:
                spring, place = self.springs[i]
                whole[place] = side * self.mu[i] / spring * self.rate_row(i)
                if side == 0:
                    whole[place], held[i, place] = self.speed_row(i), spring
                    force += np.outer(self.t[:, i], held[i])
        stuck = [
            i for i, side in enumerate(sides) if side == 0 and i not in self.springs
        ]
        if stuck:
            along = self.t[:, stuck]
            mobility = along.T @ np.linalg.solve(self.mass, along)
            held[stuck] = -np.linalg.solve(
                mobility, along.T @ np.linalg.solve(self.mass, force)
            )
            force = force + along @ held[stuck]
        whole[:size, size : 2 * size] = np.eye(size)
        whole[size : 2 * size] = np.linalg.solve(self.mass, force)
        return whole, held

    def guards(self, held):
        """(contact, what, row of z and 1): events where the row's product falls through 0."""
        for i, side in enumerate(self.side):
            normal = self.row(i)
            if side == OPEN:
                yield i, "lands", -normal
                continue
            knots, forces, _ = self.tables[i]
            beyond = np.zeros_like(normal)
            if self.piece[i]:
                beyond[-1] = forces[self.piece[i]]
                yield i, "softer", normal - beyond
            else:
                yield i, "lifts", normal
            if self.piece[i] + 1 < len(knots):
                beyond[-1] = forces[self.piece[i] + 1]
                yield i, "stiffer", beyond - normal
            if side:
                slides = side * self.speed_row(i)
                if i in self.springs:
                    slides -= self.mu[i] / self.springs[i][0] * self.rate_row(i)
                yield i, "belt", slides
            else:
                yield i, "slips slower", self.mu_static[i] * normal - held[i]
                yield i, "slips faster", self.mu_static[i] * normal + held[i]

    def settle(self):
        """Carry out what happens at one instant, in the order of contacts, until all is well."""
        for _ in range(100 + 10 * len(self.side)):
            whole, held = self.flow(self.side)
            now = np.append(self.state, 1.0)
            changes = now, whole @ now, whole @ whole @ now
            for i, what, row in self.guards(held):
                terms = [row * change for change in changes]
                clear = [t.sum() for t in terms if abs(t.sum()) > _round_off(t)]
                if clear and clear[0] < 0.0:
                    self.change(i, what)
                    break
            else:
                return
        raise RuntimeError("regimes send the motion back and forth")

    def next_event(self, step, most):
        """Go to the next event: its time from here, None if it takes longer than ``most``.

        The motion is a power series over each step, of a radian of the fastest mode at most: longer
        ones lose digits by cancellation.
        """
        whole, held = self.flow(self.side)
        rows = np.array([row for *_, row in self.guards(held)])
        now, elapsed = np.append(self.state, 1.0), 0.0
        step = min(step, 1.0 / np.abs(np.linalg.eigvals(whole)).max())
        while elapsed < most:
            terms = [now]
            for order in range(1, ORDERS):
                terms.append(whole @ terms[-1] / order)
            series = np.array(terms)
            hit = _crossing(series @ rows.T, step, begins=not elapsed)
            now = (step if hit is None else hit) ** np.arange(ORDERS) @ series
            if hit is not None:
                self.state = now[:-1]
                self.settle()
                return elapsed + hit
            elapsed += step
        return None

    def run(self, t_end, step):
        """Go on for a time; instants of events from here and the sides after each."""
        time, events = 0.0, [(0.0, tuple(self.side))]
        while True:
            before = self.state.copy(), list(self.side), list(self.piece)
            wait = self.next_event(step, t_end - time)
            if wait is None or time + wait > t_end:
                self.state, self.side, self.piece = before
                whole, _ = self.flow(self.side)
                end = expm(whole * (t_end - time)) @ np.append(self.state, 1.0)
                self.state = end[:-1]
                return events
            time += wait
            events.append((time, tuple(self.side)))

    def change(self, i, what):
        """Carry out one event."""
        now, size = np.append(self.state, 1.0), len(self.mass)
        speed, before = self.speed_row(i) @ now, self.side[i]
        sides = {"lifts": OPEN, "slips slower": 1, "slips faster": -1}
        if what in {"stiffer", "softer"}:
            self.piece[i] += 1 if what == "stiffer" else -1
            return
        self.side[i] = sides.get(what, int(np.sign(speed)))
        if i in self.springs:
            spring, place = self.springs[i]
            limit = self.mu_static[i] * (self.rate_row(i) @ now)
            # a spring at the limit of slip, relaxed where it leaves or lands
            slides = before if what == "belt" else sides.get(what, OPEN)
            stretch = self.mu[i] * (self.row(i) @ now) / spring
            self.state[place] = 0.0 if slides == OPEN else slides * stretch
            if what == "belt" or (what == "lands" and spring * abs(speed) <= limit):
                self.side[i] = 0
        elif what == "belt":  # friction holds it there if it can
            moved = np.linalg.solve(self.mass, self.t[:, i])
            self.state[size : 2 * size] += moved * speed / (self.t[:, i] @ moved)
            self.side[i] = 0
            _, held = self.flow(self.side)
            if (
                abs(held[i] @ np.append(self.state, 1.0))
                > self.mu_static[i] * self.normal(self.state)[i]
            ):
                self.side[i] = -before


def instants(run):
    """(time, sides and pieces after it) where the regimes change, from the events of a run."""
    names = run.event_regime.attrs["flag_meanings"].split()

    def of(name, component):
        regime, _, piece = name.removeprefix(f"{component}_").partition("_press_")
        return SIDES[regime], int(piece or 1) - 1 if regime != "separated" else 0

    components = list(run.component.values)
    now = {
        c: of(names[int(k)], c)
        for c, k in zip(components, run.regime.values[0], strict=True)
    }
    found = [(0.0, tuple(now.values()))]
    for time, number in zip(
        run.event_time.values, run.event_regime.values, strict=True
    ):
        component = names[int(number)].partition("_")[0]
        now[component] = of(names[int(number)], component)
        if time - found[-1][0] < SAME and len(found) > 1:
            found[-1] = (found[-1][0], tuple(now.values()))
        else:
            found.append((float(time), tuple(now.values())))
    return found


def compare(structure, q, v, most=30):
    """ok, refused (the run says why), or what is wrong in the first instants of events."""
    truth = ManyContacts(structure, q, v)

    def sides():
        return tuple(
            (side, 0 if side == OPEN else piece)
            for side, piece in zip(truth.side, truth.piece, strict=True)
        )

    expected = [(0.0, sides())]
    while len(expected) <= most:
        wait = truth.next_event(0.05, most=50.0)
        if wait is None:
            break
        expected.append((expected[-1][0] + wait, sides()))
    # at an event itself a spring jumps where its static limit is larger
    later = 1e-6
    end = expected[-1][0] + later
    last = expm(truth.flow(truth.side)[0] * later) @ np.append(truth.state, 1.0)
    system = structure.system()
    start = dict(zip(system.states, [*q, *v], strict=False))
    run = system.simulate(end + SAME, start=start, times=np.array([0.0, end]))
    if int(run.outcome):
        return f"refused: outcome {int(run.outcome)}"
    found = instants(run)[: len(expected)]
    for place, (a, b) in enumerate(zip(expected, found, strict=False)):
        if abs(a[0] - b[0]) > 1e-8 or a[1] != b[1]:
            return f"wrong at {place}: {a} for {b}"
    if len(found) < len(expected):
        return f"wrong: {len(found)} instants for {len(expected)}"
    final = np.array([float(run[name][-1]) for name in system.states])
    error = abs(final - last[:-1]).max()
    return "ok" if error < 1e-8 else f"wrong: state by {error:.1e}"


def table(contact):
    """Knots of compression, forces there, and the slope from each knot on."""
    if contact.law is None:
        return [0.0], [0.0], [contact.stiffness]
    pairs = [each.split(":") for each in contact.law.split()[1:]]
    knots, forces = np.array(pairs, float).T
    slopes = np.diff(forces) / np.diff(knots)
    return knots[:-1], forces[:-1], slopes


def compression(knots, forces, slopes, force):
    """The compression at which a table has a force."""
    j = max(int(np.searchsorted(forces, force, side="right")) - 1, 0)
    return knots[j] + (force - forces[j]) / slopes[j]


def _crossing(heights, step, *, begins):
    """The earliest root in a step of what is above zero at first, touching pairs too.

    Args:
        heights: (orders, rows) of their series.
    """
    instants = np.linspace(0.0, step, 17)
    slopes = heights[1:] * np.arange(1, ORDERS)[:, None]
    powers = instants[:, None] ** np.arange(ORDERS)
    values, rates = powers @ heights, powers[:, :-1] @ slopes
    earliest = None
    for place in np.flatnonzero(
        (values < -NOTHING).any(axis=0)
        | ((rates[:-1] < 0.0) & (rates[1:] > 0.0)).any(axis=0)
    ):
        height, slope = heights[:, place], slopes[:, place]
        fresh = begins and abs(height[0]) < SAME
        for k, (left, right) in enumerate(pairwise(instants)):
            if earliest is not None and left > earliest:
                break
            if not k and fresh:  # it leaves zero, and may be back at once
                tries = [t for t in right / 2.0 ** np.arange(24) if _at(height, t) > 0]
                if not tries and values[1, place] < -NOTHING:
                    raise RuntimeError("an event at once")
                left = tries[0] if tries else right
            low = right if values[k + 1, place] < -NOTHING else None
            if low is None and rates[k, place] < 0.0 < rates[k + 1, place]:
                bottom = brentq(partial(_at, slope), instants[k], right, xtol=1e-17)
                low = bottom if _at(height, bottom) < -NOTHING else None
            if low is not None and left < low:
                root = left
                if _at(height, left) > 0.0:
                    root = brentq(partial(_at, height), left, low, xtol=1e-17)
                earliest = root if earliest is None else min(root, earliest)
                break
    return earliest


def _round_off(terms):
    return max(SAME, 1e-12 * np.abs(terms).sum())


def _at(series, time):
    return time ** np.arange(len(series)) @ series
