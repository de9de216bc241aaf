"""A cycle as legs between events in a given order: equations that are smooth at a grazing too.

Unknowns are the states after all events, the durations of the legs and, of a forced system, the
instant of the first state; then the followed parameters. No surface is watched, so the equations
go on where an event is only just met, or has vanished: whether a solution is a motion of
the system is a question of its own (:mod:`squealpipe.systems.cycles.admissible`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from squealpipe.systems.cycles.flow import Crossing, Event, Flow, Path, Vector

_LEAST = 0.05
"""Least unit of a state over the largest, both over the states' sizes."""
_SAMPLES, _INSIDE = 400, 4
"""Samples of a cycle, evenly, and in each step of the integrator."""
_KEPT = 8
"""Points whose legs are kept."""
FREE = -1
"""Number of the switch of what changes nothing: the section of a cycle without events, a touch."""


@dataclass(frozen=True)
class Section:
    """What fixes the phase of a cycle without events: a plane through a state, or an instant."""

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
    events: tuple[Event, ...]
    values: Mapping[str, float]
    scale: Vector
    time: float
    units: Vector
    periods: int = 0
    section: Section | None = None
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
        found = dict(zip(self.flow.followed, map(float, followed), strict=True))
        return states, durations, start, {**self.values, **found}

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
            if len(self._latest) >= _KEPT:
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
        slopes = self.flow.derivatives(values, path)
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
        """The equation of a surface, or of the section, and its row."""
        n, crossing = self.flow.size, parts.crossings[leg]
        if self.events[leg].surface == FREE:
            row = np.zeros(by_end.shape[1])
            if self.section is None:
                row[self.size - 1] = 1.0 / self.time
                return parts.start / self.time, row
            row[:n] = self.section.normal / self.scale
            offset = (parts.states[0] - self.section.state) / self.scale
            return float(self.section.normal @ offset), row
        size = max(float(np.abs(crossing.height_by_state) @ self.scale), 1e-300)
        row = crossing.height_by_state @ by_end + crossing.height_by_time * by_time
        row[self.size :] += crossing.height_by
        return crossing.height / size, row / size

    def solve(self, guess: Vector, most: int = 20) -> Vector | None:
        """Newton's method at fixed parameters; None where it does not converge.

        Where cycles come in families the smallest correction is taken.
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
            step = np.linalg.lstsq(jacobian[:, : self.size], -values, rcond=1e-10)[0]
            z[: self.size] += step * min(
                1.0, 0.5 / max(float(np.abs(step).max()), 1e-300)
            )
        return best if previous < 1e-9 else None


@dataclass(frozen=True, eq=False)
class Cycle:
    """A solution of an event map.

    Attributes:
        map: its equations.
        point: the unknowns.
        parts: the legs.
        residual: largest of F.
    """

    map: EventMap
    point: Vector
    parts: Parts
    residual: float

    @classmethod
    def at(cls, equations: EventMap, point: Vector) -> Cycle:
        """The cycle at some unknowns."""
        residual = float(np.abs(equations.evaluate(point)[0]).max())
        return cls(equations, point, equations.parts(point), residual)

    @property
    def period(self) -> float:
        """Its time, s."""
        return float(self.parts.durations.sum())

    @property
    def followed(self) -> Vector:
        """Values of the followed parameters."""
        return np.array([self.parts.values[name] for name in self.map.flow.followed])

    @property
    def events(self) -> tuple[Event, ...]:
        """Its events, without the section."""
        return tuple(event for event in self.map.events if event.switch != FREE)

    @cached_property
    def monodromy(self) -> Vector:
        """The derivative of the first state after a period by itself, over the scales."""
        n, total = self.map.flow.size, np.eye(self.map.flow.size)
        for event, slopes, crossing in zip(
            self.map.events, self.parts.slopes, self.parts.crossings, strict=True
        ):
            total = slopes[:, :n] @ total
            if event.switch != FREE:
                with np.errstate(all="ignore"):
                    total = crossing.saltation @ total
        total = total * self.map.scale / self.map.scale[:, None]
        for _, normal in self.map.held(
            self.parts
        ):  # what leaves the surface is forgotten
            total -= np.outer(total @ normal, normal)
        return np.asarray(total)

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers by falling magnitude, after the trivial one without forcing.

        The motion's own direction is mapped onto itself; split off, it leaves the others well
        conditioned where they meet 1, as at a fold.
        """
        matrix, trivial = self.monodromy, np.empty(0)
        if not np.isfinite(matrix).all():
            return np.full(len(matrix), np.nan + 0.0j)
        if not self.map.periods:
            ahead = self.heading
            basis = np.linalg.qr(np.column_stack([ahead, np.eye(len(ahead))]))[0]
            turned = basis.T @ matrix @ basis
            trivial, matrix = turned[:1, 0], turned[1:, 1:]
        rest = np.linalg.eigvals(matrix).astype(np.complex128)
        # conjugates: positive imaginary part first
        order = np.lexsort((-rest.imag, -np.abs(rest).round(9)))
        return np.concatenate([trivial.astype(np.complex128), rest[order]])

    @property
    def heading(self) -> Vector:
        """Rate of the first state, over the scales and the period."""
        first = self.map.events[0].before
        rate = self.map.flow.field(
            self.parts.values, first, self.parts.states[0], self.parts.start
        )
        return np.asarray(rate / self.map.scale * self.period)

    @property
    def nontrivial(self) -> NDArray[np.complex128]:
        """All multipliers but the trivial one."""
        return self.multipliers[int(not self.map.periods) :]

    @property
    def is_stable(self) -> bool:
        """Whether small disturbances decay."""
        return bool(np.abs(self.nontrivial).max(initial=0.0) < 1.0)

    @cached_property
    def extremes(self) -> Vector:
        """(lowest, highest) of each state and output, (2, states + outputs)."""
        n, path = self.map.flow.size, self.parts.path
        first = path.series.shape[1] - len(self.map.flow.system.traced.outputs)
        which = [*range(n), *range(first, path.series.shape[1])]
        found = []
        for number in which:
            values = np.concatenate(path.ends_of(number)).tolist()
            values += [turn.value for turn in path.turns[number]]
            found.append((min(values), max(values)))
        return np.array(found).T

    @property
    def closing_error(self) -> float:
        """Largest jump between a leg's end and the next one's start, over the cycle's extent."""
        n = self.map.flow.size
        scale = scale_of(self.extremes[:, :n], self.map.flow.system.sizes)
        ends = np.array([crossing.after for crossing in self.parts.crossings])
        return float(
            np.abs((ends - np.roll(self.parts.states, -1, axis=0)) / scale).max()
        )

    def after_part(self, parts: int) -> Vector:
        """How far a part of the period is from the one before, by means over twelfths."""
        means = self._means
        return np.asarray(np.roll(means, len(means) // parts, axis=0) - means).ravel()

    @cached_property
    def _means(self) -> Vector:
        """Of the states over each twelfth of the period, over the extent.

        Unlike states at instants they are continuous where an event passes from one to the next.
        """
        path, n = self.parts.path, self.map.flow.size
        orders = np.arange(1, path.series.shape[2] + 1)
        integrals = path.series[:, :n] / orders
        whole = (integrals * path.steps[:, None, None] ** orders).sum(axis=2)
        times = np.arange(13) / 12 * self.period
        step = self._step_at(times)
        powers = ((times - self.step_begins[step]) / path.unit)[:, None] ** orders
        before = np.cumsum(whole, axis=0) - whole
        up_to = before[step] + np.einsum("tik,tk->ti", integrals[step], powers)
        scale = scale_of(self.extremes[:, :n], self.map.flow.system.sizes)
        return np.asarray(
            np.diff(up_to, axis=0) * (12 * path.unit / self.period) / scale
        )

    @cached_property
    def step_begins(self) -> Vector:
        """When each step of the integrator begins after the first state."""
        path = self.parts.path
        return np.asarray(self.clocks[path.leg] + path.offsets * path.unit)

    def _step_at(self, times: Vector) -> NDArray[np.int64]:
        return np.maximum(np.searchsorted(self.step_begins, times, side="right") - 1, 0)

    @property
    def clocks(self) -> Vector:
        """When each leg begins after the first state."""
        durations = self.parts.durations
        return np.asarray(np.cumsum(durations) - durations)

    def states_at(self, times: Vector) -> tuple[Vector, NDArray[np.int64]]:
        """States and regimes at times after the first state, less than a period."""
        path = self.parts.path
        step, orders = self._step_at(times), np.arange(path.series.shape[2])
        powers = ((times - self.step_begins[step]) / path.unit)[:, None] ** orders
        states = np.einsum(
            "tik,tk->ti", path.series[step, : self.map.flow.size], powers
        )
        return states, path.regimes[path.leg[step]]

    def start(self) -> tuple[Vector, int]:
        """State and regime at t = 0: of the forcing, or far from any event."""
        states, regimes = self.states_at(np.array([self.phase]))
        return states[0], int(regimes[0])

    @cached_property
    def phase(self) -> float:
        """When that is, after the first state."""
        if self.map.periods:
            return -self.parts.start % self.period
        joint = self.map.flow.system.joint
        lengths = [
            0.0 if joint.holds(event.before).any() else duration
            for event, duration in zip(
                self.map.events, self.parts.durations, strict=True
            )
        ]
        longest = int(np.argmax(lengths))
        if self.map.events[longest].switch == FREE:
            return 0.0
        return float(self.clocks[longest] + 0.5 * self.parts.durations[longest])

    @property
    def instants(self) -> Vector:
        """Times from 0 to the period that resolve the motion.

        Even ones, and some in each of the integrator's steps, which are short where it is fast.
        """
        path = self.parts.path
        inside = np.outer(np.arange(_INSIDE) / _INSIDE, path.steps * path.unit)
        steps = (self.step_begins + inside - self.phase) % self.period
        return np.union1d(np.linspace(0.0, self.period, _SAMPLES + 1), steps)

    def followed_in(self, flow: Flow, units: Vector) -> tuple[EventMap, Vector]:
        """Its equations with other followed parameters, scaled by it, and its unknowns there."""
        made, parts = (
            replace(
                self.map,
                flow=flow,
                values=self.parts.values,
                units=units,
                time=self.period,
                scale=scale_of(self.extremes[:, : flow.size], flow.system.sizes),
            ),
            self.parts,
        )
        followed = np.array([parts.values[name] for name in flow.followed])
        return made, made.pack(parts.states, parts.durations, parts.start, followed)


def scale_of(path: Vector, sizes: Vector) -> Vector:
    """Units of the states: their extents in a motion, none far below that of the others.

    A state that hardly moves is known no better than the others.
    """
    extent = np.ptp(path, axis=0) / sizes
    largest = float(extent.max()) or float(np.abs(path / sizes).max()) or 1.0
    return np.asarray(sizes * np.maximum(extent, _LEAST * largest))
