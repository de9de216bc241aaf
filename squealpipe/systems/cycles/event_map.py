"""A cycle as legs between events in a given order: equations that are smooth at a grazing too.

Unknowns are the states after all events, the durations of the legs and, of a forced system, the
instant of the first state; then the followed parameters. No surface is watched, so the equations
go on where an event is only just met, or has vanished: whether a solution is a motion of
the system is a question of its own (:mod:`squealpipe.systems.cycles.admissible`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy

from squealpipe.systems.cycles.crossing import Crossing
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.legs import LegEnd, Path, Vector
from squealpipe.systems.cycles.variational import leg_derivatives

LONG_CHAIN = 150
"""Unknowns from which on a Newton step is taken by sparse elimination."""
FREE = -1
"""Number of the switch of what changes nothing: the section of a cycle without events, a touch."""


@dataclass(frozen=True)
class PhaseCondition:
    """Condition that fixes the phase of a cycle without events: a plane through a state, or an
    instant.
    """

    state: Vector
    normal: Vector


@dataclass(frozen=True)
class Parts:
    """The legs at some unknowns, and their derivatives."""

    states: Vector
    durations: Vector
    start: float
    values: dict[str, float]
    path: Path
    slopes: Vector
    crossings: tuple[Crossing, ...]


@dataclass(eq=False)
class EventMap:
    """The equations of a cycle with given events: F(unknowns, parameters) = 0.

    Attributes:
        flow: of the system; its followed parameters are the last unknowns.
        events: of the legs, in order.
        values: all parameters; the followed ones are replaced.
        scale, time, units: of the states, of time and of the followed parameters.
        periods: forcing periods, or 0 without forcing.
        section: of a cycle without events.
    """

    flow: Flow
    events: tuple[LegEnd, ...]
    values: Mapping[str, float]
    scale: Vector
    time: float
    units: Vector
    periods: int = 0
    section: PhaseCondition | None = None
    _latest: dict[bytes, tuple[Parts, Vector, Vector]] = field(
        default_factory=dict, init=False
    )

    @property
    def legs(self) -> int:
        """Number of legs."""
        return len(self.events)

    @property
    def size(self) -> int:
        """Number of equations, and of unknowns without parameters."""
        return self.legs * (self.flow.size + 1) + (self.periods > 0)

    def pack(
        self, states: Vector, durations: Vector, start: float, followed: Vector
    ) -> Vector:
        """The unknowns without units."""
        parts = [(states / self.scale).ravel(), durations / self.time]
        if self.periods:
            parts.append(np.array([start / self.time]))
        return np.concatenate([*parts, followed / self.units])

    def unpack(self, z: Vector) -> tuple[Vector, Vector, float, dict[str, float]]:
        """(states, durations, start, all parameters)."""
        n, m = self.flow.size, self.legs
        states = z[: m * n].reshape(m, n) * self.scale
        durations = z[m * n : m * (n + 1)] * self.time
        start = float(z[m * (n + 1)] * self.time) if self.periods else 0.0
        followed = z[self.size :] * self.units
        numbers = dict(zip(self.flow.followed, map(float, followed), strict=True))
        return states, durations, start, {**self.values, **numbers}

    def parts(self, z: Vector) -> Parts:
        """The legs at some unknowns."""
        return self._solved(z)[0]

    def evaluate(self, z: Vector) -> tuple[Vector, Vector]:
        """F, (size,), and its Jacobian, (size, size + parameters); NaN where there is none."""
        if not np.isfinite(z).all():
            return np.full(self.size, np.nan), np.zeros((self.size, len(z)))
        return self._solved(z)[1:]

    def _solved(self, z: Vector) -> tuple[Parts, Vector, Vector]:
        """The legs at some unknowns, F and its Jacobian; those of the last points are kept."""
        key = z.tobytes()
        if key not in self._latest:
            # Newton's method and its line search come back to the last points: their legs are
            # kept
            if len(self._latest) >= 8:
                del self._latest[next(iter(self._latest))]
            with np.errstate(all="ignore"):
                parts = self._legs_at(z)
                self._latest[key] = parts, *self._equations(parts, len(z))
        return self._latest[key]

    def _legs_at(self, z: Vector) -> Parts:
        states, durations, start, values = self.unpack(z)
        starts = start + np.cumsum(durations) - durations
        regimes = [event.before for event in self.events]
        path = self.flow.run(values, states, regimes, starts, durations)
        slopes = leg_derivatives(self.flow, values, path)
        crossings = tuple(
            self.flow.crossing(
                values,
                event.switch,
                event.surface,
                (event.before, event.after),
                end,
                time,
            )
            for event, end, time in zip(
                self.events, path.ends, starts + durations, strict=True
            )
        )
        return Parts(states, durations, start, values, path, slopes, crossings)

    def _equations(self, parts: Parts, columns: int) -> tuple[Vector, Vector]:
        size, n, m = self.size, self.flow.size, self.legs
        values, jacobian = np.empty(size), np.zeros((size, columns))
        for leg, crossing in enumerate(parts.crossings):
            here, following = slice(leg * n, leg * n + n), (leg + 1) % m
            by_end, by_time = self.by_unknowns(parts, leg)
            rows = crossing.after_by_state @ by_end + np.outer(
                crossing.after_by_time, by_time
            )
            rows[:, size:] += crossing.after_by
            rows[:, following * n : following * n + n] -= np.eye(n)
            values[here] = (crossing.after - parts.states[following]) / self.scale
            jacobian[here] = rows / self.scale[:, None]
            values[m * n + leg], jacobian[m * n + leg] = self._surface(
                parts, leg, by_end, by_time
            )
        for height, gradient in self.held(parts):
            values[:n] -= gradient * height
            jacobian[:n, :n] -= np.outer(gradient, gradient) / self.scale
        if self.periods:
            period, by = self.flow.forcing(parts.values)
            values[-1] = (parts.durations.sum() - self.periods * period) / self.time
            jacobian[-1, m * n : m * (n + 1)] = 1.0 / self.time
            jacobian[-1, size:] = -self.periods * by / self.time
        return values, jacobian * self.column_units

    def held(self, parts: Parts) -> Iterator[tuple[float, Vector]]:
        """Surfaces on which the motion stays for ever, as in stick: height and unit normal.

        Over the scales. No event puts the motion there, so that the equations have to.
        """
        system, state = self.flow.system, parts.states[0]
        regimes = [event.before for event in self.events]
        holds = np.array([system.joint.holds(regime) for regime in regimes])
        for surface in np.flatnonzero(holds.all(axis=0)):
            seen = system.joint.seen(regimes[0], int(surface))
            here = self.flow.crossing(
                parts.values, FREE, int(surface), (seen, seen), state, parts.start
            )
            gradient = here.height_by_state * self.scale
            size = np.linalg.norm(gradient)
            yield here.height / float(size), gradient / size

    @cached_property
    def column_units(self) -> Vector:
        """Units of all unknowns."""
        times = np.full(self.legs + (self.periods > 0), self.time)
        return np.concatenate([np.tile(self.scale, self.legs), times, self.units])

    def by_unknowns(self, parts: Parts, leg: int) -> tuple[Vector, Vector]:
        """Derivatives of the end of a leg, (n, …), and of its instant, (…,), with units."""
        size, n, m = self.size, self.flow.size, self.legs
        slopes, count = parts.slopes[leg], len(self.units)
        by_end, by_time = np.zeros((n, size + count)), np.zeros(size + count)
        by_end[:, leg * n : leg * n + n] = slopes[:, :n]
        by_end[:, size:] = slopes[:, n : n + count]
        by_end[:, m * n + leg] = parts.crossings[leg].rate
        if self.flow.timed:
            earlier = [*range(m * n, m * n + leg), *([size - 1] * (self.periods > 0))]
            by_end[:, earlier] += slopes[:, n + count :]
            by_time[[*earlier, m * n + leg]] = 1.0
        return by_end, by_time

    def _surface(
        self, parts: Parts, leg: int, by_end: Vector, by_time: Vector
    ) -> tuple[float, Vector]:
        """The equation of a surface, of the section or of no time, and its row."""
        n, crossing = self.flow.size, parts.crossings[leg]
        if self.events[leg].surface == FREE:
            row = np.zeros(by_end.shape[1])
            if self.section is None:
                row[self.size - 1] = 1.0 / self.time
                return parts.start / self.time, row
            row[:n] = self.section.normal / self.scale
            offset = (parts.states[0] - self.section.state) / self.scale
            return float(self.section.normal @ offset), row
        if self.events[leg].at_once:
            row = np.zeros(by_end.shape[1])
            row[self.legs * n + leg] = 1.0 / self.time
            return float(parts.durations[leg]) / self.time, row
        size = float(np.abs(crossing.height_by_state) @ self.scale)
        # a surface of the time alone changes by nothing else
        size = max(
            size, abs(crossing.height_by_time) * self.time * (size == 0.0), 1e-300
        )
        row = crossing.height_by_state @ by_end + crossing.height_by_time * by_time
        row[self.size :] += crossing.height_by
        return crossing.height / size, row / size

    def solve(
        self, guess: Vector, most: int = 20, *, smallest: bool = False
    ) -> Vector | None:
        """Newton's method at fixed parameters; None where it does not converge.

        Where cycles come in families the smallest correction is taken, of long chains of legs if
        ``smallest`` is given.
        """
        z, best, previous = guess.copy(), None, np.inf
        for _ in range(most):
            values, jacobian = self.evaluate(z)
            residual = float(np.abs(values).max())
            # LAPACK does not return from matrices that are not finite
            if not (residual <= 1e6 and np.isfinite(jacobian).all()):
                return None
            stagnates = residual >= 0.5 * previous and previous < 1e-9
            if residual < previous:
                best, previous = z.copy(), residual
            if stagnates or residual < 1e-14:
                break
            step = _newton_step(jacobian[:, : self.size], -values, smallest)
            if not np.isfinite(step).all():
                return None
            z[: self.size] += step * min(
                1.0, 0.5 / max(float(np.abs(step).max()), 1e-300)
            )
        return best if previous < 1e-9 else None


def _newton_step(jacobian: Vector, values: Vector, smallest: bool) -> Vector:
    """The smallest solution of a Newton step, or any of a long chain of legs unless asked.

    Each leg knows its neighbours alone: a sparse LU takes milliseconds where singular values of
    hundreds of unknowns take a second. NaN where a long chain has none.
    """
    rows, columns = jacobian.shape
    if smallest or rows != columns or rows < LONG_CHAIN:
        return np.asarray(np.linalg.lstsq(jacobian, values, rcond=1e-10)[0])
    try:
        return np.asarray(
            scipy.sparse.linalg.splu(scipy.sparse.csc_array(jacobian)).solve(values)
        )
    except RuntimeError:  # exactly singular
        return np.full(columns, np.nan)
