"""A pad on a belt by scipy's DOP853 with located events, written from the definition alone.

Shares no line with the package: numbers in, shares of time and sampled velocities out.
"""

from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp

FALLS = {
    "coulomb": lambda over: 0.0 * over,
    "exponential": lambda over: np.exp(-over),
    "hyperbolic": lambda over: 1.0 / (1.0 + over),
}
"""Law → share of the static excess that is left at a sliding speed over v0."""


class Pad:
    """Mass on two springs with dashpots above a belt that runs along +x.

    Args:
        numbers: mass, k1, k2, k3, preload, mu, mu_static, friction_speed, friction_law,
            belt_speed, length1, length2, damping1, damping2.
    """

    def __init__(self, numbers, alpha1, alpha2):
        self.p = p = SimpleNamespace(**numbers)
        if p.mu_static is None:
            p.mu_static = p.mu
        self.springs = (
            (
                p.length1 * np.cos(alpha1),
                p.length1 * np.sin(alpha1),
                p.length1,
                p.k1,
                p.damping1,
            ),
            (
                -p.length2 * np.cos(alpha2),
                p.length2 * np.sin(alpha2),
                p.length2,
                p.k2,
                p.damping2,
            ),
        )

    def pull(self, z):
        """Force of springs and dashpots, N."""
        fx = fy = 0.0
        for fixed_x, fixed_y, free, k, c in self.springs:
            ux, uy = z[0] - fixed_x, z[1] - fixed_y
            length = np.hypot(ux, uy)
            ux, uy = ux / length, uy / length
            force = k * (length - free) + c * (ux * z[2] + uy * z[3])
            fx, fy = fx - force * ux, fy - force * uy
        return fx, fy

    def coefficient(self, speed):
        p = self.p
        return p.mu + (p.mu_static - p.mu) * FALLS[p.friction_law](
            speed / p.friction_speed
        )

    def field(self, mode):
        """The right-hand side while off the belt, stuck to it, slower or faster."""
        p = self.p
        side = {"slower": 1.0, "faster": -1.0}.get(mode)

        def slope(_, z):
            fx, fy = self.pull(z)
            normal = 0.0 if mode == "off" else p.k3 * (p.preload - z[1])
            if side is not None:
                fx += side * self.coefficient(abs(p.belt_speed - z[2])) * normal
            ax = 0.0 if mode == "stick" else fx / p.mass
            return z[2], z[3], ax, (fy + normal) / p.mass

        return slope

    def grip(self, z):
        """What friction can hold, N."""
        return self.p.mu_static * self.p.k3 * (self.p.preload - z[1])

    def sliding(self, z):
        """The mode in contact."""
        lag, pull = self.p.belt_speed - z[2], self.pull(z)[0]
        if abs(lag) > 1e-12:
            return "slower" if lag > 0 else "faster"
        if abs(pull) <= self.grip(z):
            return "stick"
        return "slower" if pull < 0 else "faster"

    def watched(self, mode):
        """Events that end a mode; the first is loss or return of contact."""
        found = [(lambda _, z: self.p.preload - z[1], 1.0 if mode == "off" else -1.0)]
        if mode == "stick":
            found.append((lambda _, z: self.grip(z) - abs(self.pull(z)[0]), -1.0))
        elif mode != "off":
            rises = 1.0 if mode == "faster" else -1.0
            found.append((lambda _, z: self.p.belt_speed - z[2], rises))
        for event, direction in found:
            event.terminal, event.direction = True, direction
        return [event for event, _ in found]

    def after(self, mode, which, z):
        """The mode and the state behind an event."""
        nearby = 1e-14 * self.p.preload
        if which == 0 and mode != "off":
            z[1] = self.p.preload + nearby
            return "off", z
        if which == 0:
            z[1] = self.p.preload - nearby
            return self.sliding(z), z
        z[2] = self.p.belt_speed
        mode = (
            ("slower" if self.pull(z)[0] < 0 else "faster")
            if mode == "stick"
            else self.sliding(z)
        )
        z[2] -= {"slower": 1e-13, "faster": -1e-13}.get(mode, 0.0)
        return mode, z

    def run(self, start, t_end, t_from, *, tol=1e-9, samples=16384):
        """What happens between ``t_from`` and ``t_end``."""
        p, z, time = self.p, np.array(start, float), 0.0
        mode = "off" if z[1] > p.preload else self.sliding(z)
        grid, pieces, losses, peak = (np.linspace(t_from, t_end, samples), [], 0, 0.0)
        spent = dict.fromkeys(("off", "stick", "slower", "faster"), 0.0)
        while time < t_end:
            made = solve_ivp(
                self.field(mode),
                (time, t_end),
                z,
                "DOP853",
                events=self.watched(mode),
                rtol=tol,
                atol=tol * p.preload,
                dense_output=True,
                max_step=0.2 * np.sqrt(p.mass / p.k3),
            )
            reached = float(made.t[-1])
            inside = grid[(grid >= time) & (grid < reached)]
            if inside.size:
                states = made.sol(inside)
                pieces.append(states)
                if mode != "off":
                    peak = max(peak, float((p.k3 * (p.preload - states[1])).max()))
            spent[mode] += max(0.0, reached - max(time, t_from))
            time, z = reached, made.y[:, -1].copy()
            if made.status < 1:
                break
            which = next(i for i, times in enumerate(made.t_events) if len(times))
            losses += which == 0 and mode != "off" and time > t_from
            mode, z = self.after(mode, which, z)
        states = np.concatenate(pieces, axis=1)
        return SimpleNamespace(
            velocity=states[2:],
            step=float(grid[1] - grid[0]),
            separated=spent["off"] / (t_end - t_from),
            stuck=spent["stick"] / (t_end - t_from),
            losses=losses,
            peak_force=peak,
            final=z,
        )


def strongest_line(signal, step):
    """Frequency of the highest line of a signal, Hz, by a Hann window and a parabola."""
    window = np.hanning(signal.size)
    lines = np.abs(np.fft.rfft((signal - signal.mean()) * window, 8 * signal.size))
    at = 1 + int(np.argmax(lines[1:-1]))
    low, top, high = np.log(lines[at - 1 : at + 2])
    shift = 0.5 * (low - high) / (low - 2.0 * top + high)
    return (at + shift) / (8 * signal.size * step)
