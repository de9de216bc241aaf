"""Equations of curves of special cycles: folds, period doublings, tori, grazings, stick.

The equations of the cycle's legs and one more, by pseudo-arclength. At a fold their derivative by
the unknowns is singular, at a period doubling that of a disturbance that returns with the other
sign, at a torus that of one that returns turned by an angle, which is one more unknown; a bordered
system gives the equation (Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria,
2000, ch. 3). It is exact; its derivative, which only steers Newton's method, is a difference of
exact Jacobians along the null vector.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squealpipe.systems.branch_labels import Label, Meeting
from squealpipe.systems.cycles.admissible import Margin, MarginKind, margins
from squealpipe.systems.cycles.event_map import FREE, EventMap, PhaseCondition
from squealpipe.systems.cycles.event_order import label_of
from squealpipe.systems.cycles.guess import without_brief_legs
from squealpipe.systems.cycles.legs import LegEnd, Vector
from squealpipe.systems.cycles.line import flip
from squealpipe.systems.cycles.solution import Cycle

_no_margin = Margin(MarginKind.length, -1, FREE)
RETURNS = {Label.fold: 0.0, Label.period_doubling: np.pi, Label.torus: np.nan}
"""Angle by which a disturbance is turned in a period; NaN where it is an unknown."""


Test = Callable[[Vector], float]


@dataclass
class Curve:
    """The equations of a curve.

    Attributes:
        map: of the cycle, with two followed parameters.
        own: the margin that vanishes along it, of a grazing or an onset of stick.
        border: right and left null vector next to the point, of a fold or a period doubling.
    """

    map: EventMap
    label: Label
    own: Margin = _no_margin
    border: tuple[Vector, Vector] = (np.empty(0), np.empty(0))

    def known(self, point: Vector) -> Vector:
        """The unknowns of the cycle at a point, without the angle of a torus."""
        return point[: self.map.size + 2]

    def cycle(self, point: Vector) -> Cycle:
        """The cycle at a point."""
        return Cycle.at(self.map, self.known(point))

    def returning(self, jacobian: Vector, factor: complex) -> Vector:
        """The derivative by the unknowns for disturbances that a period multiplies by a factor."""
        n, size = self.map.flow.size, self.map.size
        matrix = jacobian[:, :size].astype(type(factor))
        last = (self.map.legs - 1) * n
        matrix[last : last + n, :n] += (1.0 - factor) * np.eye(n)
        if self.map.periods:
            matrix[-1, -1] += 1.0 - factor
        return matrix

    def factor(self, point: Vector) -> complex:
        """Return the factor by which a disturbance is multiplied in a period."""
        angle = RETURNS[self.label]
        return (
            complex(np.exp(1j * point[-1])) if np.isnan(angle) else float(np.cos(angle))
        )

    def determinant(self, point: Vector, factor: float) -> float:
        """Zero where a disturbance returns multiplied by the factor."""
        jacobian = self.map.evaluate(self.known(point))[1]
        return float(np.linalg.det(self.returning(jacobian, factor)))

    def renew(self, point: Vector) -> None:
        """Take the borders, and the section of a cycle without events, from a point."""
        if self.map.section is not None:
            cycle = self.cycle(point)
            normal = cycle.heading / np.linalg.norm(cycle.heading)
            self.map = replace(
                self.map, section=PhaseCondition(cycle.parts.states[0], normal)
            )
        if self.label in RETURNS:
            jacobian = self.map.evaluate(self.known(point))[1]
            left, _, right = np.linalg.svd(self.returning(jacobian, self.factor(point)))
            self.border = _real(right[-1].conj()), _real(left[:, -1].conj())

    def evaluate(self, point: Vector) -> tuple[Vector, Vector]:
        """All equations with their Jacobian."""
        values, jacobian = self.map.evaluate(self.known(point))
        more = len(point) - jacobian.shape[1]
        jacobian = np.pad(jacobian, ((0, 0), (0, more)))
        if not np.isfinite(jacobian).all() or not np.isfinite(values).all():
            nothing = np.full(1 + more, np.nan)
            return np.append(values, nothing), np.vstack(
                [jacobian, jacobian[: 1 + more]]
            )
        singular = self.label in RETURNS
        value, row = (
            self._singular(point, jacobian) if singular else self._margin(point)
        )
        return np.append(values, value), np.vstack([jacobian, row])

    def _null(self, jacobian: Vector, factor: complex) -> Iterator[Any]:
        """Right and left solution of the bordered system; the last number of both is 0 on it."""
        size, (right, left) = self.map.size, self.border
        matrix: Any = np.zeros((size + 1, size + 1), type(factor))
        matrix[:size, :size] = self.returning(jacobian, factor)
        matrix[:size, size], matrix[size, :size] = left, right
        return (
            np.linalg.solve(each, np.eye(size + 1)[-1]) for each in (matrix, matrix.T)
        )

    def _singular(self, point: Vector, jacobian: Vector) -> tuple[Any, Vector]:
        size, factor = self.map.size, self.factor(point)
        null, dual = self._null(jacobian, factor)
        row: Any = -dual[:size] @ self._along(point, null[:size].real)
        if isinstance(factor, float):
            return float(null[-1]), row
        row = row - 1j * dual[:size] @ self._along(point, null[:size].imag)
        turned = 1j * factor * self.returning(np.zeros((size, size)), 0.0)
        row = np.append(row, dual[:size] @ turned @ null[:size])
        # an odd function of the angle, which is regular where that is zero or half a turn
        sine, cosine = np.sin(point[-1]), np.cos(point[-1])
        odd = row.imag / sine
        odd[-1] -= null[-1].imag * cosine / sine**2
        return np.array([null[-1].real, null[-1].imag / sine]), np.array(
            [row.real, odd]
        )

    def _along(self, point: Vector, direction: Vector) -> Vector:
        """Return the change of the Jacobian along a direction of the cycle's unknowns."""
        here = self.known(point)
        step = np.append(direction, np.zeros(2))
        size = max(float(np.linalg.norm(step)), 1e-300)
        # relative step of the forward difference: about the root of round-off
        difference = 1e-7
        step *= difference / size
        change = self.map.evaluate(here + step)[1] - self.map.evaluate(here)[1]
        return np.asarray(change * (size / difference))

    def _margin(self, point: Vector) -> tuple[float, Vector]:
        """Return the quantity of a margin as a function of the end of its leg, and its row."""
        equations, leg = self.map, self.own.leg
        if self.own.kind == MarginKind.length:
            at = equations.legs * equations.flow.size + leg
            return float(point[at]), np.eye(len(point))[at]
        parts, event = equations.parts(point), equations.events[leg]
        time = parts.start + float(parts.durations[: leg + 1].sum())
        flow, n = equations.flow, equations.flow.size
        condition = self.own.which if self.own.kind == MarginKind.condition else None
        value, *slopes = flow.quantity(
            parts.values, event, condition, parts.path.ends[leg], time
        )
        by_end, by_time = equations.by_unknowns(parts, leg)
        row = slopes[:n] @ by_end
        if flow.timed:
            row += slopes[n] * by_time
        row[equations.size :] += slopes[n + flow.timed :]
        row *= equations.column_units
        size = max(float(np.abs(row).max()), 1e-300)
        return value / size, row / size

    def tests(self) -> dict[Meeting, Test]:
        """Return the functions that change sign where something else happens."""
        if self.label == Label.fold:
            return {Meeting.cusp: self._cusp, Meeting.fold_flip: self._flip}
        if self.label == Label.period_doubling:
            return {Meeting.fold_flip: self._fold}
        if self.label == Label.torus:
            return {
                Meeting.resonance_1_3: lambda z: z[-1] - 2.0 * np.pi / 3.0,
                Meeting.resonance_1_4: lambda z: z[-1] - np.pi / 2.0,
            }
        if self.label == Label.grazing and self.map.events[self.own.leg].switch == FREE:
            # the touch is the section, or changes nothing: multipliers are those of the motion
            return {Meeting.fold_grazing: self._fold, Meeting.flip_grazing: self._flip}
        if self.label == Label.grazing:
            return {
                Meeting.fold_grazing: lambda z: self.determinant(z, 1.0),
                Meeting.flip_grazing: lambda z: self.determinant(z, -1.0),
            }
        return {}

    def _fold(self, point: Vector) -> float:
        return float(np.prod(self.cycle(point).nontrivial - 1.0).real)

    def _flip(self, point: Vector) -> float:
        return flip(self.cycle(point))

    def _cusp(self, point: Vector) -> float:
        size, jacobian = self.map.size, self.evaluate(point)[1]
        null, _ = self._null(jacobian[:size], 1.0)
        return float(jacobian[-1, :size] @ null[:size])

    def least_margin(self, point: Vector) -> tuple[float, Margin | None]:
        """The margin next to zero that is not the curve's own."""
        others = {k: v for k, v in margins(self.cycle(point)).items() if k != self.own}
        key = min(others, key=lambda k: others[k], default=None)
        return (np.inf, None) if key is None else (others[key], key)


def _real(vector: Vector) -> Vector:
    """The longest real part of a complex vector, whose phase is free."""
    part = (vector * np.exp(-0.5j * np.angle(vector @ vector))).real
    return np.asarray(part / np.linalg.norm(part))


def _without_vanished_legs(cycle: Cycle) -> Cycle:
    """Return the same cycle without the legs that have just vanished.

    At a touch round-off decides whether the run has a pair of events there. With the pair, the
    speeds of both and the length of the leg between them stay zero along the curve, and might be
    taken for its end.
    """
    # largest change of extremes, or negative margin, where a leg has only just vanished
    vanished = 1e-6
    for equations, guess in without_brief_legs(cycle):
        point = equations.solve(guess)
        if point is None:
            continue
        shorter = Cycle.at(equations, point)
        moved = np.abs(shorter.extremes - cycle.extremes)[:, : equations.flow.size]
        same = bool((moved <= vanished * cycle.extent).all())
        least = min(margins(shorter).values(), default=0.0)
        if same and shorter.period > 0.0 and least > -vanished:
            return _without_vanished_legs(shorter)
    return cycle


def curve_of(cycle: Cycle, label: Label) -> tuple[Curve, Vector]:
    """The equations of the curve through a cycle with two followed parameters, and a guess."""
    equations = cycle.map
    if label == Label.torus:
        first = cycle.nontrivial[np.argmin(np.abs(np.abs(cycle.nontrivial) - 1.0))]
        return Curve(equations, label), np.append(cycle.point, abs(np.angle(first)))
    if label in RETURNS:
        return Curve(equations, label), cycle.point
    cycle = _without_vanished_legs(cycle)
    equations = cycle.map
    # a margin of the start that is smaller is taken for the one that vanishes on the curve
    near = {
        k: abs(v)
        for k, v in margins(cycle).items()
        if abs(v) < 1e-4 and k.kind != MarginKind.edge
    }
    near = {k: v for k, v in near.items() if label_of(cycle, {k: 0.0}) == label}
    if not near:
        raise ValueError(f"start: no condition of {label.name} just holds there")
    # an event without speed also turns at the end of its leg, which round-off takes for a touch
    own = min(near, key=lambda k: (k.kind == MarginKind.touch, near[k]))
    if own.kind != MarginKind.touch:
        return Curve(equations, label, own), cycle.point
    # the leg is cut where it touches: there the switch's event has no speed, if it stays there
    parts, leg, event = cycle.parts, own.leg, equations.events[own.leg]
    first = len(equations.flow.system.traced.variables)
    traced = equations.flow.system.traced
    inside = [turn for turn in parts.path.turns[first + own.which] if turn.leg == leg]
    turn = min(inside, key=lambda each: abs(each.value))
    joint = equations.flow.system.joint
    falls = joint.falls(event.before)[own.which] >= 0
    watched = (joint.falls if falls else joint.rises)(event.before)
    number = int(watched[own.which])
    targets = traced.switches[number].targets if number < len(traced.switches) else ()
    stays = (
        len(targets) == 1 and joint.entered(event.before, targets[0][0]) == event.before
    )
    kind = targets[0][2] if stays else FREE
    touch = LegEnd(
        number if stays else FREE,
        own.which,
        1.0 if falls else -1.0,
        event.before,
        event.before,
        kind,
    )
    states, _ = cycle.states_at(np.array([cycle.clocks[leg] + turn.time]))
    start, durations = parts.start, parts.durations
    if event.surface == FREE:
        # without events the section is the touch
        events: tuple[LegEnd, ...] = (touch,)
        start, leg = start + turn.time, 0
    else:
        events = (*equations.events[:leg], touch, *equations.events[leg:])
        states = np.insert(parts.states, leg + 1, states, axis=0)
        durations = np.insert(durations, leg, turn.time)
        durations[leg + 1] -= turn.time
    made = replace(equations, events=events, section=None)
    own = Margin(MarginKind.speed, leg, own.which)
    return Curve(made, label, own), made.pack(states, durations, start, cycle.followed)
