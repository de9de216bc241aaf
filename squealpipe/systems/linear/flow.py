"""Legs and switches of linear structures on a belt: derivatives by their matrices.

Idea: in one regime all forces are linear in the state, but for friction that depends on the sliding
speed, whose slope is a number for each contact. So every derivative by the state is a product of
the matrices that the loop runs with. Parameters enter by sums, products and exponentials: the
derivative by one is the imaginary part at a parameter with a tiny imaginary part, exact to
round-off (Squire and Trapp, SIAM Review 40, 1998).

Invariant: what is computed here is what :mod:`squealpipe.systems.linear.series` computes for runs.

Cost: a leg with Coulomb friction takes one matrix exponential, (2 modes)³.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg as la
from numpy.typing import NDArray

from squealpipe.systems.cycles.affine import Affine
from squealpipe.systems.cycles.crossing import Crossing
from squealpipe.systems.cycles.flow import Flow
from squealpipe.systems.cycles.legs import LegEnd, Path, Vector
from squealpipe.systems.linear.batch import coefficients_of_contacts, numbers_of_runs
from squealpipe.systems.linear.legs import RUN_SIZES, RUN_TABLE, run_legs
from squealpipe.systems.linear.loop import functions
from squealpipe.systems.linear.matrices import (
    FIRST_OF_PRESS,
    ContactMatrices,
    friction_number,
    full_matrix,
    regime_constant,
)
from squealpipe.systems.linear.numbering import Numbering, surface_number, switch_number
from squealpipe.systems.linear.plan import plan
from squealpipe.systems.linear.sticking import DEPENDENT, limit_left
from squealpipe.systems.scales import Scales
from squealpipe.systems.taylor.lanes import Workspace, invoke, taylor_terms
from squealpipe.systems.taylor.simd import LANES

TINY = 1e-40
"""Imaginary part by which derivatives are taken: its square is nothing beside any number."""


class Forces:
    """Forces at a state in the regimes of all contacts, and their derivatives by the state.

    Numbers may be complex, for derivatives by whatever they depend on; forces and rates can be
    those of many states side by side.

    Attributes:
        press: preload − stiffness · nᵀq, the normal force in contact, N, (c,).
        speed: of sliding w, m/s, (c,).
        coefficient, falls_by: μ and dμ/d|w| of contacts that slip, (c,).
        slip, stick: friction of contacts that slip and stick, N, (c,); that of a tangential spring
            is ``slip``.
        rates: of the state, (size,).
    """

    def __init__(
        self,
        matrices: ContactMatrices,
        coefficients: Vector,
        constants: Vector,
        belt_speed: Any,
        preload: Any,
        state: Vector,
    ) -> None:
        """Compute the forces.

        Args:
            matrices: of the belt's speed.
            coefficients: μ, static limit, reference speed and compression at rest, (4, c).
            constants: of the contacts' regimes, (c, constants).
            belt_speed, preload: m/s; a factor of all preloads.
            state: (size,), or (size, many).
        """
        m = self.matrices = matrices
        self.constants = constants
        sticks = constants[:, regime_constant.is_stuck] > 0.0
        has_spring = m.tangential_springs > 0.0
        self.stuck = np.flatnonzero(sticks & ~has_spring)
        self.stretched = np.flatnonzero(sticks[m.sliders])

        def along(values: Vector) -> Vector:
            return values.reshape(-1, *(1,) * (state.ndim - 1))

        self.mu, self.static, self.reference = map(along, coefficients[:3])
        self.closed = along(constants[:, regime_constant.is_closed])
        self.side = along(constants[:, regime_constant.direction])
        self.springs, pressed = map(along, m.lines(constants, preload))
        q, v, stretch = np.split(state, [m.n_modes, 2 * m.n_modes])
        lift = m.normals.T @ q
        self.press = pressed - self.springs * lift
        self.speed = along(m.speeds) * belt_speed - m.tangentials.T @ v
        self.coefficient, self.falls_by = self._friction_law()
        self.slip = self.side * self.press * self.coefficient
        springs = along(m.tangential_springs)[m.sliders]
        held = m.sliders[self.stretched]
        self.slip[held] = (springs * stretch)[self.stretched]
        self.rate_of_press = -self.springs * (m.normals.T @ v)
        slides = self.spring_per_force * self.rate_of_press
        lengthens = self.side * slides + 0.0 * self.speed  # complex where either is
        lengthens[held] = self.speed[held]
        relieved = self.closed * pressed + self._beyond_stiffness * lift
        self.base = (
            along(m.load) * (preload if m.balanced else 1.0)
            - full_matrix(m.stiffness) @ q
            - full_matrix(m.damping) @ v
            + m.pushes @ relieved
            + m.drags @ self.slip
        )
        self.stick = np.zeros_like(self.slip)
        self.stick[self.stuck] = self.held @ self.base
        rates = self.base + m.drags @ self.stick
        self.rates = np.concatenate([v, rates, lengthens[m.sliders]])

    @cached_property
    def spring_per_force(self) -> Vector:
        """Stretch of each tangential spring in slip for each newton, m/N; 0 without one."""
        springs = self.matrices.tangential_springs
        stiff = np.where(springs > 0.0, springs, np.inf)
        return np.asarray(self.mu / stiff.reshape(self.mu.shape))

    @property
    def _beyond_stiffness(self) -> Vector:
        """Stiffness that the matrix of stiffness has, and a contact has not in its regime."""
        return np.asarray(
            self.matrices.springs.reshape(self.springs.shape)
            - self.closed * self.springs
        )

    def _friction_law(self) -> tuple[Vector, Vector]:
        """Return μ at the sliding speeds of contacts that slip, and dμ/d|w|."""
        laws, mu, reference = self.matrices.laws, self.mu, self.reference
        u, fall = self.side * self.speed / reference, self.static - mu
        value, slope = mu + 0.0 * u, 0.0 * u
        at = laws == friction_number.exponential
        part = fall[at] * np.exp(-u[at])
        value[at] += part
        slope[at] = -part / reference[at]
        at = laws == friction_number.hyperbolic
        value[at] += fall[at] / (1.0 + u[at])
        slope[at] = -fall[at] / reference[at] / (1.0 + u[at]) ** 2
        at = laws == friction_number.table
        if at.any():
            fields = self.constants[
                at, regime_constant.first_of_piece : FIRST_OF_PRESS
            ].T
            start, _, *c = (each.reshape(mu[at].shape) for each in fields)
            x = u[at] - start
            value[at] = mu[at] * (c[0] + x * (c[1] + x * (c[2] + x * c[3])))
            inner = c[1] + x * (2.0 * c[2] + x * 3.0 * c[3])
            slope[at] = mu[at] * inner / reference[at]
        return value, slope

    @cached_property
    def held(self) -> Vector:
        """Friction of contacts that stick, by the accelerations that others give, (stuck, n)."""
        m, stuck = self.matrices, self.stuck
        if not stuck.size:
            return np.zeros((0, m.n_modes))
        return -np.asarray(self._inverse @ m.tangentials[:, stuck].T)

    @cached_property
    def _inverse(self) -> Vector:
        """(T_SᵀM⁻¹T_S)⁺ of the contacts that stick."""
        mobility = self.matrices.mobility[np.ix_(self.stuck, self.stuck)]
        return np.asarray(la.pinvh(mobility, rtol=DEPENDENT))

    def _by_states(self, of_q: Any, of_v: Any) -> Vector:
        return np.hstack(
            [of_q, of_v, np.zeros((len(of_q), len(self.matrices.sliders)))]
        )

    @cached_property
    def press_by(self) -> Vector:
        """Derivative of ``press`` by the state, (c, size)."""
        m = self.matrices
        springs = self.springs.reshape(-1, 1)
        return self._by_states(-springs * m.normals.T, 0.0 * m.normals.T)

    @cached_property
    def speed_by(self) -> Vector:
        """Derivative of ``speed``, (c, size)."""
        m = self.matrices
        return self._by_states(0.0 * m.tangentials.T, -m.tangentials.T)

    @property
    def slip_by_press(self) -> Vector:
        """Derivative of ``slip`` by ``press``, (c,)."""
        return np.asarray(self.side * self.coefficient)

    @property
    def slip_by_speed(self) -> Vector:
        """Derivative of ``slip`` by ``speed``, (c,)."""
        return np.asarray(self.side**2 * self.press * self.falls_by)

    @cached_property
    def slip_by(self) -> Vector:
        """Derivative of ``slip`` by the state, (c, size)."""
        by_press = self.slip_by_press[:, None] * self.press_by
        found = np.asarray(by_press + self.slip_by_speed[:, None] * self.speed_by)
        m = self.matrices
        held = m.sliders[self.stretched]
        found[held, 2 * m.n_modes + self.stretched] = m.tangential_springs[held]
        return found

    @cached_property
    def base_by(self) -> Vector:
        """Derivative of accelerations without those of stick, (n, size)."""
        m = self.matrices
        opened = self._beyond_stiffness[:, None] * m.normals.T
        pull = m.pushes @ opened - full_matrix(m.stiffness)
        drag = -full_matrix(m.damping)
        return self._by_states(pull, drag) + m.drags @ self.slip_by

    @cached_property
    def stick_by(self) -> Vector:
        """Derivative of ``stick``, (c, size)."""
        found = np.zeros_like(self.slip_by)
        found[self.stuck] = self.held @ self.base_by
        return found

    @cached_property
    def rates_by(self) -> Vector:
        """Derivative of the rates, (size, size)."""
        n = self.matrices.n_modes
        rows = self.base_by + self.matrices.drags @ self.stick_by
        lengthens = (self.side * self.spring_per_force)[:, None] * self.rate_of_press_by
        held = self.matrices.sliders[self.stretched]
        lengthens[held] = self.speed_by[held]
        places = np.eye(n, rows.shape[1], n)
        return np.vstack([places, rows, lengthens[self.matrices.sliders]])

    @property
    def rate_of_press_by(self) -> Vector:
        """Derivative of ``rate_of_press`` by the state, (c, size)."""
        across = self.matrices.normals.T
        return self._by_states(0.0 * across, -self.springs.reshape(-1, 1) * across)

    def surface(self, kind: int, i: int) -> tuple[Any, Vector]:
        """Return a surface of a contact and its derivative by the state."""
        if kind == surface_number.pressing:
            return self.press[i], self.press_by[i]
        lag, lag_by = self.side[i] * self.speed[i], self.side[i] * self.speed_by[i]
        # where it slips the slider of a tangential spring follows the normal force
        if (per_force := self.spring_per_force[i]) and self.side[i]:
            lag = lag - per_force * self.rate_of_press[i]
            lag_by = lag_by - per_force * self.rate_of_press_by[i]
        if kind == surface_number.lag:
            return lag, lag_by
        if kind in {surface_number.before_end, surface_number.after_start}:
            knot = self.constants[
                i, regime_constant.first_of_piece + (kind == surface_number.before_end)
            ]
            return lag - self.reference[i] * knot, lag_by
        if kind in {surface_number.press_end, surface_number.press_start}:
            start, end, c0, c1 = self.constants[i, FIRST_OF_PRESS:]
            knot = c0 + c1 * (end - start) * (kind == surface_number.press_end)
            return self.press[i] - knot, self.press_by[i]
        sign = 1.0 if kind == surface_number.margin else -1.0
        friction, friction_by = self.stick[i], self.stick_by[i]
        if i in self.matrices.sliders:
            friction, friction_by = self.slip[i], self.slip_by[i]
        return (
            self.static[i] * self.press[i] - sign * friction,
            self.static[i] * self.press_by[i] - sign * friction_by,
        )

    def holding(self, i: int) -> Any:
        """Return the friction that would keep a contact on the belt, others staying as they are."""
        m, stuck = self.matrices, self.stuck
        friction, whole = self.slip[i] + self.stick[i], m.mobility[i, i]
        row = m.mobility[i, stuck]
        left = whole - row @ self._inverse @ row if stuck.size else whole
        if i in stuck or left <= DEPENDENT * whole:
            return friction
        n = m.n_modes
        return friction - m.tangentials[:, i] @ self.rates[n : 2 * n] / left

    def condition(self, i: int, knot: float | None, direction: float) -> Any:
        """Return what decides which regime a contact enters; see :class:`.numbering.Condition`."""
        if knot is not None:
            return direction * self.speed[i] - knot * self.reference[i]
        if spring := self.matrices.tangential_springs[i]:
            # of a landing, just after which forces grow in proportion to the time
            limit = self.static[i] * self.rate_of_press[i]
            return limit**2 - (spring * self.speed[i]) ** 2
        limit, hidden = self.static[i] * self.press[i], self.matrices.hidden
        return limit_left.py_func(limit, self.holding(i), hidden)


class LinearFlow(Flow):
    """Legs and switches of a linear structure."""

    def __init__(
        self, system: Any, followed: Sequence[str] = (), scales: Scales | None = None
    ) -> None:
        super().__init__(system, followed, scales)
        self.matrices: ContactMatrices = system.matrices
        self.coefficients = system.coefficients
        self.numbering: Numbering = system.numbering
        self._affine: dict[Any, Affine] = {}
        self._room = 64

    @property
    def is_affine(self) -> bool:
        """True if friction depends on no speed."""
        return not self.matrices.curved

    def _forces(self, values: Mapping[str, Any], regime: int, state: Any) -> Forces:
        matrices = self.matrices.at(values["belt_speed"])
        given = coefficients_of_contacts(matrices, self.coefficients, values)
        own = list(self.system.joint.regimes(regime))
        return Forces(
            matrices,
            np.array([*given]).T,
            self.numbering.constants_of_regimes[own],
            values["belt_speed"],
            values["preload"],
            state,
        )

    def _beside(
        self, values: Mapping[str, float], regime: int, state: Vector
    ) -> list[Forces]:
        """Return the forces at each followed parameter with a tiny imaginary part."""
        return [
            self._forces({**values, name: values[name] + 1j * TINY}, regime, state)
            for name in self.followed
        ]

    def forcing(self, values: Mapping[str, float]) -> tuple[float, Vector]:
        """Raise: structures are not forced."""
        raise NotImplementedError

    def field(
        self,
        values: Mapping[str, float],
        regime: int,
        state: Vector,
        time: float,  # noqa: ARG002
    ) -> Vector:
        """Rates of the states."""
        return self._forces(values, regime, state).rates

    def jacobian(
        self, values: Mapping[str, float], regime: int, state: Vector
    ) -> Vector:
        """∂f/∂(states, followed parameters), (n, n + p)."""
        by = [each.rates.imag / TINY for each in self._beside(values, regime, state)]
        return np.column_stack([self._forces(values, regime, state).rates_by, *by])

    def affine_at(self, values: Mapping[str, float], regime: int) -> Affine:
        """Return the rates as a matrix and a constant, where friction depends on no speed."""
        key = (regime, *(values[name] for name in self.system.parameters))
        if key not in self._affine:
            if len(self._affine) >= 64:
                del self._affine[next(iter(self._affine))]
            origin = np.zeros(self.size)
            here = self._forces(values, regime, origin)
            beside = self._beside(values, regime, origin)
            n, p = self.size, len(beside)
            self._affine[key] = Affine(
                here.rates_by,
                here.rates,
                np.array([each.rates_by.imag / TINY for each in beside]).reshape(
                    p, n, n
                ),
                np.array([each.rates.imag / TINY for each in beside]).reshape(p, n),
            )
        return self._affine[key]

    def slopes_along(
        self, values: Mapping[str, float], regimes: NDArray[np.int64], states: Vector
    ) -> Vector:
        """Return derivatives of the rates at many states; see :meth:`.flow.Flow.slopes_along`."""
        found = np.empty((self.size, self.columns, *states.shape[1:]))
        for regime in set(regimes.tolist()):
            chosen = regimes == regime
            found[:, :, :, chosen] = self._slopes_of_many(
                values, regime, states[:, :, chosen]
            )
        return found

    def _slopes_of_many(
        self, values: Mapping[str, float], regime: int, states: Vector
    ) -> Vector:
        """Return derivatives of the rates at many states in one regime, (n, n + p, nodes, many)."""
        flat = states.reshape(self.size, -1)
        here, m = self._forces(values, regime, flat), self.matrices
        still = self._forces(values, regime, np.zeros(self.size))
        # what slip friction makes of the state, carried on by what sticks
        drags = m.drags + m.drags[:, still.stuck] @ (still.held @ m.drags)
        by_press = here.slip_by_press.T - still.slip_by_press
        by_speed = here.slip_by_speed.T - still.slip_by_speed
        rows = (
            by_press[:, :, None] * still.press_by
            + by_speed[:, :, None] * still.speed_by
        )
        found = np.empty((self.size, self.columns, flat.shape[1]))
        found[:, : self.size] = still.rates_by[:, :, None]
        modes = slice(m.n_modes, 2 * m.n_modes)
        found[modes, : self.size] += (drags @ rows).transpose(1, 2, 0)
        for column, other in enumerate(self._beside(values, regime, flat), self.size):
            found[:, column] = other.rates.imag / TINY
        return found.reshape(self.size, self.columns, *states.shape[1:])

    def crossing(
        self,
        values: Mapping[str, float],
        switch: int,
        surface: int,
        regimes: tuple[int, int],
        state: Vector,
        time: float,  # noqa: ARG002
    ) -> Crossing:
        """A switch at a state; see :meth:`.flow.Flow.crossing`."""
        before, after = regimes
        each = self.numbering.switches[switch] if switch >= 0 else None
        here, beside = (
            self._forces(values, before, state),
            self._beside(values, before, state),
        )
        n, p = self.size, len(beside)
        by_state, sign = np.zeros(n), -1.0 if each and each.rises else 1.0
        height, by = 0.0, np.zeros(p)
        if surface >= 0:
            kind, i = divmod(surface, self.numbering.n_components)
            height, by_state = here.surface(kind, i)
            by = np.array([other.surface(kind, i)[0].imag / TINY for other in beside])
        moved, moved_by, moved_by_parameter = state, np.eye(n), np.zeros((n, p))
        conditions: list[float] = []
        if each:
            i, m = each.contact, here.matrices
            if each.what == switch_number.reversal and i not in m.sliders:
                push = np.zeros(n)
                push[m.n_modes : 2 * m.n_modes] = m.drags[:, i] / m.mobility[i, i]
                moved = state + push * here.speed[i]
                moved_by = moved_by + np.outer(push, here.speed_by[i])
                for column, other in enumerate(beside):
                    moved_by_parameter[:, column] = push * other.speed[i].imag / TINY
            conditions = [
                here.condition(i, *condition)
                for _, condition, _ in each.targets
                if condition is not None
            ]
        if len(here.matrices.sliders):
            moved, moved_by = moved.copy(), moved_by.copy()
            self._reset_stretches(
                regimes, here, beside, moved, moved_by, moved_by_parameter
            )
        return Crossing(
            height=float(sign * height),
            height_by_state=sign * by_state,
            height_by_time=0.0,
            height_by=sign * by,
            after=moved,
            after_by_state=moved_by,
            after_by_time=np.zeros(n),
            after_by=moved_by_parameter,
            rate=here.rates,
            rate_after=self.field(values, after, moved, 0.0),
            conditions=np.array(conditions),
        )

    def _reset_stretches(
        self,
        regimes: tuple[int, int],
        here: Forces,
        beside: Sequence[Forces],
        after: Vector,
        by_state: Vector,
        by_parameter: Vector,
    ) -> None:
        """Write the stretches after a switch, but for those of sliders that go on to stick.

        While one slips, or is open, its stretch follows from the state, so that a perturbation of
        it alone is none.

        Args:
            regimes: of all contacts, before and after.
            here, beside: forces before, and at each followed parameter with an imaginary part.
            after, by_state, by_parameter: state after the switch and its derivatives, changed here.
        """
        m = here.matrices
        before, entered = (
            self.numbering.constants_of_regimes[list(self.system.joint.regimes(each))]
            for each in regimes
        )
        for place, i in enumerate(m.sliders, 2 * m.n_modes):
            sticks = before[i, regime_constant.is_stuck] > 0.0
            if sticks and entered[i, regime_constant.is_stuck] > 0.0:
                continue
            # one that comes to stick keeps the stretch of its slip
            slipping = entered if entered[i, regime_constant.direction] else before
            leaves = not entered[i, regime_constant.is_closed]
            side = 0.0 if leaves else slipping[i, regime_constant.direction]
            share = side * here.spring_per_force[i]
            after[place] = share * here.press[i]
            by_state[place] = share * here.press_by[i]
            for column, other in enumerate(beside):
                stretch = side * other.spring_per_force[i] * other.press[i]
                by_parameter[place, column] = stretch.imag / TINY

    def quantity(
        self,
        values: Mapping[str, float],
        event: LegEnd,
        condition: int | None,
        state: Vector,
        time: float,  # noqa: ARG002
    ) -> Vector:
        """Return the rate of a surface or a condition; see :meth:`.flow.Flow.quantity`."""
        regime = event.before
        here, beside = (
            self._forces(values, regime, state),
            self._beside(values, regime, state),
        )
        if event.switch >= 0:
            switch = self.numbering.switches[event.switch]
            i, sign = switch.contact, -1.0 if switch.rises else 1.0
            kind = switch.surface
        else:
            kind, i = divmod(event.surface, self.numbering.n_components)
            sign = 1.0
        if condition is not None:
            asked = [c for _, c, _ in switch.targets if c is not None][condition]
            steps = 1j * TINY * np.eye(self.size)
            around = [self._forces(values, regime, state + step) for step in steps]
            by = [each.condition(i, *asked).imag / TINY for each in (*around, *beside)]
            return np.array([here.condition(i, *asked), *by])

        def rate(forces: Forces) -> Any:
            return forces.surface(kind, i)[1] @ forces.rates

        # its slope along the motion: that of the gradient, which is symmetric, and of the rates
        ahead = self._forces(values, regime, state + 1j * TINY * here.rates)
        by_state = ahead.surface(kind, i)[1].imag / TINY
        by_state = by_state + here.surface(kind, i)[1] @ here.rates_by
        by = [rate(each).imag / TINY for each in beside]
        return sign * np.array([rate(here), *by_state, *by])

    def run(
        self,
        values: Mapping[str, float],
        states: Vector,
        regimes: Sequence[int],
        starts: Vector,
        durations: Vector,
    ) -> Path:
        """Run legs from states (legs, n), each in its regime for its duration."""
        matrices = self.matrices.at(values["belt_speed"])
        numbering, n = self.numbering, self.size
        called, unit = functions(), self.unit(values)
        table = plan(matrices, numbering, called)
        runs = {name: np.array([values[name]]) for name in self.system.parameters}
        given = numbers_of_runs(
            matrices,
            self.coefficients,
            runs,
            np.array([unit]),
            table.pointer.value or 0,
        )[0]
        constants = [self.system.joint.constants(regime) for regime in regimes]
        sizes = np.minimum(
            self.sizes(values), np.maximum(np.abs(states).max(axis=0), 1e-200)
        )
        # Taylor steps to round-off: Newton's method converges to the last digit
        terms, n_surfaces = taylor_terms(1e-16), len(numbering.surfaces)
        n_series = n + n_surfaces + len(numbering.outputs)
        active = np.zeros(n_surfaces, np.int64)
        active[
            surface_number.margin * matrices.n_contacts : (surface_number.margin + 2)
            * matrices.n_contacts
        ] = 1
        counts = np.zeros(len(states), np.int64)
        arrays = {
            "rows": np.zeros((len(given) + len(constants[0]), LANES)),
            "series": np.zeros((terms, n_series)),
            "units": 1.0 / sizes[:, None],
            "constants": np.ascontiguousarray(constants),
            "initial": np.ascontiguousarray(states),
            "durations": durations / unit,
            "active": active,
            "counts": counts,
        }
        arrays["rows"][: len(given), 0] = given
        while True:
            arrays |= {
                "kept": np.empty((self._room, n_series, terms)),
                "steps": np.empty(self._room),
            }
            numbers = (
                table.pointer.value or 0,
                *(len(states), terms, n_series, n_surfaces),
                *(self._room, self.most_steps, called["series"]),
            )
            work = Workspace(
                RUN_TABLE, arrays, dict(zip(RUN_SIZES, numbers, strict=True))
            )
            invoke(run_legs(), work.pointer.value or 0)
            if counts.max() > self.most_steps:
                # a leg without end: one of no duration has a step
                path = self.run(values, states, regimes, starts, 0.0 * durations)
                path.ends[:] = np.nan
                return path
            used = int(counts.sum())
            if used <= self._room:
                break
            self._room = used
        return Path.of(
            arrays["kept"][:used],
            arrays["steps"][:used],
            counts,
            n,
            regimes=regimes,
            starts=starts,
            durations=durations,
            unit=unit,
        )
