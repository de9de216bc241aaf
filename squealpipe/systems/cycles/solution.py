"""Describe a cycle that was solved for: stability, extremes, and states in time.

Idea: the derivative of one turn is the product of the derivatives of the legs and of the saltation
matrices between them; its eigenvalues are the Floquet multipliers. Cost: one run of a period with
derivatives, which is kept.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from squealpipe.systems.cycles.event_map import FREE, LONG_CHAIN, EventMap, Parts
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.legs import LegEnd, Vector
from squealpipe.systems.trace import TIME


@dataclass(frozen=True)
class CycleAccuracy:
    """Errors of a cycle that round-off explains.

    Attributes:
        family: a second multiplier this close to 1 may belong to a family of cycles. Doubling it
            looks for families where a cycle is nearly at a fold.
        closing: closing error, over the extent, that is always round-off; larger ones are checked.
    """

    family: float = 1e-6
    closing: float = 2e-14


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
        """Its time, in the flow's scale of it."""
        return float(self.parts.durations.sum())

    def scale_of(self, name: str) -> float:
        """Return what 1 is here of a state, parameter or output, in its own unit."""
        return float(self.map.flow.scale_of(name)[0])

    @property
    def second(self) -> float:
        """Return the system's unit of time, s."""
        return self.scale_of(TIME)

    @property
    def parameters(self) -> dict[str, float]:
        """All parameters, each in its unit."""
        values = self.parts.values
        scales = self.map.flow.scale_of(*values)
        return dict(zip(values, (scales * [*values.values()]).tolist(), strict=True))

    @property
    def followed(self) -> Vector:
        """Values of the followed parameters."""
        return np.array([self.parts.values[name] for name in self.map.flow.followed])

    @property
    def events(self) -> tuple[LegEnd, ...]:
        """Its events, without the section."""
        return tuple(event for event in self.map.events if event.switch != FREE)

    @cached_property
    def monodromy(self) -> Vector:
        """The derivative of the first state after a period by itself, over the scales."""
        n, total = self.map.flow.size, np.eye(self.map.flow.size)
        delay = np.full(n, np.nan)  # no cycle begins with an event at once
        for event, slopes, crossing in zip(
            self.map.events, self.parts.slopes, self.parts.crossings, strict=True
        ):
            total = slopes[:, :n] @ total
            if event.switch == FREE:
                continue
            with np.errstate(all="ignore"):
                if not event.at_once:
                    delay = crossing.delay @ total
                total = crossing.after_by_state @ total + np.outer(crossing.jump, delay)
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
        if not (np.isfinite(matrix).all() and self.keeps_its_direction):
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

    @cached_property
    def keeps_its_direction(self) -> bool:
        """True if a free motion's own direction is mapped onto itself, as it has to be.

        Of very stiff cycles round-off takes it, and all multipliers with it.
        """
        if self.map.periods or not np.isfinite(self.monodromy).all():
            return True
        off = self.monodromy @ self.heading - self.heading
        # the derivative may map the cycle's own direction elsewhere by 1 % of its length
        return bool(np.linalg.norm(off) <= 1e-2 * np.linalg.norm(self.heading))

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

    @cached_property
    def is_family_member(self) -> bool:
        """True if there are others like it at the same parameters, as without damping.

        Next to it a multiplier is 1, as at a fold or a pitchfork. There Newton's method leads back
        from a step along the direction that returns; in a family it stays.
        """
        off = np.abs(self.nontrivial - 1.0).min(initial=1.0)
        if off >= CycleAccuracy.family or not self.keeps_its_direction:
            return False
        jacobian = self.map.evaluate(self.point)[1][:, : self.map.size]
        direction = np.linalg.svd(jacobian)[2][-1]
        step = np.zeros_like(self.point)
        # step over the cycle's extent after which another member of a family is looked for
        aside = 0.02
        for length in (aside, -aside, 0.1 * aside):
            # one may lead where Newton's method fails, though there are members
            step[: self.map.size] = length * direction
            beside = self.map.solve(self.point + step)
            if beside is not None:
                moved = float((beside - self.point) @ step)
                if abs(moved) > 0.5 * length**2:
                    return True
        return False

    @cached_property
    def closing_round_off(self) -> float:
        """Largest residual that round-off may leave.

        It is measured at points a few units in the last place away: what their residuals differ
        by beyond the derivative is round-off.
        """
        equations, size = self.map, self.map.size
        values, jacobian = equations.evaluate(self.point)
        number, largest = np.arange(size), 0.0
        # round-off is measured at points next to the solution
        for neighbour in range(1, 6 + 1):
            moved = self.point.copy()
            moved[:size] *= 1.0 + 2.0**-50 * np.sin(number * neighbour + neighbour)
            other = equations.evaluate(moved)[0]
            off = other - values - jacobian @ (moved - self.point)
            largest = max(largest, float(np.abs(off).max()))
        # round-off may be eight times what the neighbours show
        return max(CycleAccuracy.closing, 8.0 * largest)

    @cached_property
    def drifts(self) -> bool:
        """Tell whether a period changes the motion by more than round-off, as slow decay does.

        Next to a family of cycles, where a second multiplier is 1, Newton's method gets no further
        than a motion that does not quite close. What closes to round-off is a member of a family.
        """
        off = np.abs(self.nontrivial - 1.0).min(initial=1.0)
        return bool(
            off < CycleAccuracy.family and self.residual > self.closing_round_off
        )

    def closed(self) -> Cycle:
        """Return the cycle closed as well as it can be.

        Of a long chain of legs Newton's method does not take the smallest correction, without which
        closing errors next to a family are not those of the motion.
        """
        if self.map.size < LONG_CHAIN or not self.drifts:
            return self
        # Newton steps that close a long chain of legs
        point = self.map.solve(self.point, 4, smallest=True)
        return self if point is None else Cycle.at(self.map, point)

    @property
    def is_stable(self) -> bool:
        """True if small disturbances decay."""
        largest = np.abs(self.nontrivial).max(initial=0.0)
        # a multiplier closer to 1 is there by round-off
        return bool(largest < 1.0 - 1e-9 and not self.is_family_member)

    @cached_property
    def extent(self) -> Vector:
        """Units of the states by how far they move in it."""
        n = self.map.flow.size
        return scale_of(self.extremes[:, :n], self.map.flow.sizes(self.parts.values))

    @cached_property
    def extremes(self) -> Vector:
        """(lowest, highest) of each state and output, (2, states + outputs)."""
        n, path = self.map.flow.size, self.parts.path
        first = path.series.shape[1] - len(self.map.flow.system.traced.outputs)
        which = [*range(n), *range(first, path.series.shape[1])]
        pairs = []
        for number in which:
            values = np.concatenate(path.ends_of(number)).tolist()
            values += [turn.value for turn in path.turns[number]]
            pairs.append((min(values), max(values)))
        return np.array(pairs).T

    @property
    def closing_error(self) -> float:
        """Largest jump between a leg's end and the next one's start, over the cycle's extent."""
        ends = np.array([crossing.after for crossing in self.parts.crossings])
        return float(
            np.abs((ends - np.roll(self.parts.states, -1, axis=0)) / self.extent).max()
        )

    def after_part(self, parts: int) -> Vector:
        """Return how far a part of the period is from the one before, by means over twelfths."""
        means = self._means
        return np.asarray(np.roll(means, len(means) // parts, axis=0) - means).ravel()

    @cached_property
    def _means(self) -> Vector:
        """Return the means of the states over each twelfth of the period, over the extent.

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
        means = np.diff(up_to, axis=0) * (12 * path.unit / self.period)
        return np.asarray(means / self.extent)

    @cached_property
    def step_begins(self) -> Vector:
        """Times at which the steps of the integrator begin, from the first state on."""
        path = self.parts.path
        return np.asarray(self.clocks[path.leg] + path.offsets * path.unit)

    def _step_at(self, times: Vector) -> NDArray[np.int64]:
        return np.maximum(np.searchsorted(self.step_begins, times, side="right") - 1, 0)

    @property
    def clocks(self) -> Vector:
        """Times at which the legs begin, from the first state on."""
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
        """Time of the cycle's start (t = 0 of the forcing) after the first state."""
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

    @cached_property
    def instants(self) -> Vector:
        """Times from 0 to the period that resolve the motion.

        Even ones, and some in each of the integrator's steps, which are short where it is fast.
        Those of a stiff motion are short where it is slow, too: some are chosen along its path.
        """
        path, n = self.parts.path, self.map.flow.size
        steps = path.steps * path.unit
        # samples inside so many steps at most: a stiff cycle has more
        most_steps = 3000
        if len(steps) > most_steps:
            moved = np.abs(np.diff(path.series[:, :n, 0], axis=0)) / self.extent
            along = np.append(0.0, np.cumsum(moved.max(axis=1)))
            places = np.linspace(0.0, along[-1], most_steps)
            chosen = np.unique(np.searchsorted(along, places).clip(0, len(steps) - 1))
        else:
            chosen = np.arange(len(steps))
        in_each_step = 4
        inside = np.outer(np.arange(in_each_step) / in_each_step, steps[chosen])
        times = (self.step_begins[chosen] + inside - self.phase) % self.period
        return np.union1d(np.linspace(0.0, self.period, 400 + 1), times)

    def followed_in(self, flow: Flow, units: Vector) -> tuple[EventMap, Vector]:
        """Its equations with other followed parameters, scaled by it, and its unknowns there."""
        flow.most_steps = max(flow.most_steps, self.map.flow.most_steps)
        made = replace(
            self.map,
            flow=flow,
            values=self.parts.values,
            units=units,
            time=self.period,
            scale=self.extent,
        )
        parts = self.parts
        followed = np.array([parts.values[name] for name in flow.followed])
        return made, made.pack(parts.states, parts.durations, parts.start, followed)


def scale_of(path: Vector, sizes: Vector) -> Vector:
    """Units of the states: their extents in a motion, none far below that of the others.

    A state that hardly moves is known no better than the others.
    """
    extent = np.ptp(path, axis=0) / sizes
    largest = float(extent.max()) or float(np.abs(path / sizes).max()) or 1.0
    # a state that hardly moves gets a twentieth of the largest extent as its unit, or its noise
    # would dominate
    return np.asarray(sizes * np.maximum(extent, 0.05 * largest))
