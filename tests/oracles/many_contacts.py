"""Structures with friction contacts, event by event with matrix exponentials; shares no code.

Coulomb friction with one coefficient makes a motion linear between events. After an event what is
violated changes, the first contact first and from the first again after each change, until nothing
is. Without a static limit of its own one combination alone violates nothing, for independent
directions. A table of normal force over compression is a straight line from knot to knot.
"""

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

OPEN = 2
"""Side of a contact that is open; 1 and −1 are slip slower and faster than the belt, 0 stick."""
SAME = 1e-9
"""Heights and speeds below this are one event."""
NOTHING = 1e-13
"""Round-off of heights and slopes."""
SIDES = {"slip_slower": 1, "slip_faster": -1, "stick": 0, "separated": OPEN}
"""Side of a contact by the name of its regime."""


class ManyContacts:
    """A structure's matrices, and the state with the side of each contact."""

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
        self.mu, self.load = structure.mu, structure.load
        self.mu_static = structure.friction.static_mu
        self.state = np.array([*q, *v])
        lifts = self.n.T @ self.state[: len(self.mass)]
        self.piece = [
            max(int(np.searchsorted(knots, pressed - lift, side="right")) - 1, 0)
            for (knots, *_), pressed, lift in zip(
                self.tables, self.pressed, lifts, strict=True
            )
        ]
        self.side = [
            OPEN if force <= 0 else int(np.sign(speed))
            for force, speed in zip(
                self.normal(self.state), self.speed(self.state), strict=True
            )
        ]

    def row(self, i):
        """(row of z and 1) that gives the normal force of a contact in its piece."""
        knots, forces, slopes = self.tables[i]
        j, size = self.piece[i], len(self.mass)
        row = np.zeros(2 * size + 1)
        row[:size] = -slopes[j] * self.n[:, i]
        row[-1] = forces[j] + slopes[j] * (self.pressed[i] - knots[j])
        return row

    def normal(self, z):
        return [self.row(i) @ np.append(z, 1.0) for i in range(len(self.tables))]

    def speed(self, z):
        return self.belt - self.t.T @ z[len(self.mass) :]

    def flow(self, sides):
        """z′ = A z + b as one matrix, and rows (of z and 1) that give the forces of stick."""
        size = len(self.mass)
        force = np.zeros((size, 2 * size + 1))
        force[:, :size], force[:, size : 2 * size] = -self.stiffness, -self.damping
        force[:, -1] = self.load
        for i, side in enumerate(sides):
            if side == OPEN:
                continue
            push = self.n[:, i] + side * self.mu * self.t[:, i]
            force += np.outer(push, self.row(i))
        stuck = [i for i, side in enumerate(sides) if side == 0]
        held = np.zeros((len(sides), 2 * size + 1))
        if stuck:
            along = self.t[:, stuck]
            mobility = along.T @ np.linalg.solve(self.mass, along)
            held[stuck] = -np.linalg.solve(
                mobility, along.T @ np.linalg.solve(self.mass, force)
            )
            force = force + along @ held[stuck]
        whole = np.zeros((2 * size + 1, 2 * size + 1))
        whole[:size, size : 2 * size] = np.eye(size)
        whole[size : 2 * size] = np.linalg.solve(self.mass, force)
        return whole, held

    def guards(self, held):
        """(contact, what, row of z and 1): events where the row's product falls through 0."""
        size = len(self.mass)
        for i, side in enumerate(self.side):
            normal, speed = self.row(i), np.zeros(2 * size + 1)
            speed[size : 2 * size], speed[-1] = -self.t[:, i], self.belt[i]
            if side == OPEN:
                yield i, "lands", -normal
                continue
            knots, forces, _ = self.tables[i]
            beyond = np.zeros(2 * size + 1)
            if self.piece[i]:
                beyond[-1] = forces[self.piece[i]]
                yield i, "softer", normal - beyond
            else:
                yield i, "lifts", normal
            if self.piece[i] + 1 < len(knots):
                beyond[-1] = forces[self.piece[i] + 1]
                yield i, "stiffer", beyond - normal
            if side:
                yield i, "belt", side * speed
            else:
                yield i, "slips slower", self.mu_static * normal - held[i]
                yield i, "slips faster", self.mu_static * normal + held[i]

    def settle(self):
        """Carry out what happens at one instant, in the order of contacts, until all is well."""
        for _ in range(100):
            whole, held = self.flow(self.side)
            now = np.append(self.state, 1.0)
            for i, what, row in self.guards(held):
                heights = (row @ now, row @ whole @ now, row @ whole @ whole @ now)
                if next((h for h in heights if abs(h) > SAME), 0.0) < 0.0:
                    self.change(i, what)
                    break
            else:
                return
        raise RuntimeError("regimes send the motion back and forth")

    def next_event(self, step, most):
        """Go to the next event: its time from here, None if it takes longer than ``most``."""
        whole, held = self.flow(self.side)
        guards = list(self.guards(held))
        rows = np.array([row for *_, row in guards])
        now, elapsed = np.append(self.state, 1.0), 0.0
        first, later = expm(whole * step / 64), expm(whole * step)
        while elapsed < most:
            h = step if elapsed else step / 64
            end = (later if elapsed else first) @ now
            hit = _crossing(whole, rows, now, end, h, begins=not elapsed)
            if hit is not None:
                now = expm(whole * hit) @ now
                self.state = now[:-1]
                self.settle()
                return elapsed + hit
            now, elapsed = end, elapsed + h
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
        speed = self.speed(self.state)[i]
        if what in {"stiffer", "softer"}:
            self.piece[i] += 1 if what == "stiffer" else -1
        elif what == "lifts":
            self.side[i] = OPEN
        elif what == "lands":
            self.side[i] = int(np.sign(speed))
        elif what == "slips slower":
            self.side[i] = 1
        elif what == "slips faster":
            self.side[i] = -1
        else:  # at belt speed: friction holds it there if it can
            moved = np.linalg.solve(self.mass, self.t[:, i])
            self.state[len(self.mass) :] += moved * speed / (self.t[:, i] @ moved)
            before, self.side[i] = self.side[i], 0
            _, held = self.flow(self.side)
            if (
                abs(held[i] @ np.append(self.state, 1.0))
                > self.mu_static * self.normal(self.state)[i]
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
    end = expected[-1][0]
    system = structure.system()
    start = dict(zip(system.states, [*q, *v], strict=True))
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
    error = abs(final - truth.state).max()
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


def _crossing(whole, rows, start, end, h, *, begins):
    """The earliest root in a step of what is above zero at first, touching pairs too."""
    earliest = None
    slopes = rows @ whole @ start, rows @ whole @ end
    for row, before, after in zip(rows, *slopes, strict=True):

        def height(t, row=row):
            return row @ expm(whole * t) @ start

        def slope(t, row=row):
            return row @ whole @ expm(whole * t) @ start

        left = 0.0
        low = h if row @ end < -NOTHING else None
        if low is None and not (before < -NOTHING and after > NOTHING):
            continue
        if (
            begins and abs(row @ start) < SAME
        ):  # it leaves zero, and may be back at once
            tries = [h / 2**k for k in range(1, 24) if height(h / 2**k) > 0.0]
            if not tries:
                raise RuntimeError("an event at once")
            left = tries[0]
        if low is None:
            if not slope(left) < 0.0:
                continue
            bottom = brentq(slope, left, h, xtol=1e-17 * h)
            low = bottom if height(bottom) < -NOTHING else None
        if low is not None:
            root = brentq(height, left, low, xtol=1e-17 * h)
            earliest = root if earliest is None else min(root, earliest)
    return earliest
