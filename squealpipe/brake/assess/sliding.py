"""Steady sliding of A1 and small motions about it, in SI units.

The acceleration of A1 is evaluated at complex displacements: the imaginary part of the result
over a tiny step is the exact derivative (Squire and Trapp, SIAM Review 40 (1998) 110–112), for
every law and without a compiled system, so that thousands of designs cost a second.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple, Self

import numpy as np

from squealpipe.brake.models import a1
from squealpipe.brake.models.variants import VARIANT_RULES
from squealpipe.laws.contact import normal_force
from squealpipe.laws.friction_laws import COULOMB
from squealpipe.laws.springs import LONG_SPRING, Geometry, geometry
from squealpipe.parameters import Parameters
from squealpipe.vibration.schema import Mechanism


@dataclass(frozen=True)
class SlidingSearch:
    """Thresholds of the search for steady sliding and of its stability."""

    grows: float = 1e-7
    """Growth rate, over the largest |s|, above which steady sliding is unstable; below it is the
    round-off of an undamped pair. Ten times as much hides slow growth."""
    grows_with_damping: float = 1e-13
    """Such a rate where a force depends on velocity, so that no root is on the axis by symmetry."""
    first_steps: int = 4
    """Newton steps while friction is raised from zero. Half as many may jump to another
    equilibrium."""
    most_newton_steps: int = 40
    """Newton steps under the whole friction; more do not help one that does not converge."""
    friction_steps: int = 64
    """Steps in time in which friction is raised, and as many under the whole, where Newton's method
    fails. Twice as many take twice as long."""
    pace: float = 20.0
    """Time of each of these steps, over 1/rate of the design. Larger ones are nearer to
    Newton's."""
    most_doubled: int = 400
    """Most steps after those; each of the first of them takes twice the time of the one before."""
    longest_step: float = 0.1
    """Longest step of the mass, over the shorter spring. Larger ones may cross a pivot."""
    balance: float = 1e-11
    """Force left over at an equilibrium, over that of the preload: some thousand times
    round-off."""
    complex_step: float = 1e-30
    """Imaginary step of the derivatives, over a length or a speed of the system; since nothing is
    subtracted, any tiny number does."""


class Design(NamedTuple):
    """A brake: parameters, angles (rad) and "A1" or one of its variants."""

    params: Parameters
    alpha1: float
    alpha2: float
    model: str = "A1"

    def at(self, parameter: str, value: float) -> Self:
        """Return the brake with another value of a parameter or angle."""
        if parameter == "alpha1":
            return self._replace(alpha1=value)
        if parameter == "alpha2":
            return self._replace(alpha2=value)
        return self._replace(params=self.params.with_(**{parameter: value}))

    @property
    def rate(self) -> float:
        """√((k1 + k2)/2m), rad/s, the unit of frequencies."""
        p = self.params
        return float(np.sqrt((p.k1 + p.k2) / (2.0 * p.mass)))

    @property
    def period(self) -> float:
        """2π over :attr:`rate`, s."""
        return 2.0 * np.pi / self.rate


@dataclass(frozen=True)
class Sliding:
    """Steady sliding of a design in contact.

    Attributes:
        state: x, y, 0, 0, m.
        force: contact force, N.
        jacobian: (4, 4) derivative of the velocities and accelerations by the state.
    """

    design: Design
    state: np.ndarray
    force: float
    jacobian: np.ndarray

    @classmethod
    @lru_cache(maxsize=4096)  # a search asks several times for the same design
    def of(cls, design: Design) -> Self | None:
        """The one that slowly raised friction leads to from r = 0; None where there is none.

        Newton's method finds it in a few steps; where that fails, or leads out of contact, an
        overdamped mass is followed.
        """
        if design.params.belt_speed == 0.0:
            return None
        for looked_for in (_balanced, _followed):
            place = looked_for(design)
            if place is None:
                continue
            normal = float(normal_force(place[1], 0.0, design.params))
            if place[1] < design.params.preload and normal > 0.0:
                jacobian = _jacobian(design, place, _acceleration(design))
                state = np.array([*place, 0.0, 0.0])
                return cls(design, state, normal, jacobian)
        return None

    @cached_property
    def growth_rate(self) -> float:
        """Largest real part of small motions, 1/s."""
        return float(self._roots.real.max())

    @property
    def is_unstable(self) -> bool:
        """True if small motions grow."""
        return self.margin > 0.0

    @cached_property
    def margin(self) -> float:
        """Growth rate of small motions beyond that of round-off, 1/s."""
        return excess_growth(self.jacobian)

    @cached_property
    def marginal(self) -> float:
        """Growth too slow for any run to show, 1/s."""
        return SlidingSearch.grows * float(np.abs(self._roots).max())

    @cached_property
    def mechanism(self) -> Mechanism:
        """Mechanism by which it is unstable; none where it is stable."""
        if not self.is_unstable:
            return Mechanism.none
        level = _acceleration(self.design, 1.0)
        if excess_growth(_jacobian(self.design, self.state[:2], level)) <= 0.0:
            return Mechanism.falling_friction
        leading = self._roots[np.argmax(self._roots.real)]
        oscillates = abs(leading.imag) > np.sqrt(SlidingSearch.grows) * abs(leading)
        return Mechanism.flutter if oscillates else Mechanism.divergence

    @cached_property
    def push(self) -> np.ndarray:
        """Direction in which small motions grow fastest: displacement of size 1, and velocity.

        Of several that grow alike, as without damping, the slowest.
        """
        values, vectors = np.linalg.eig(self.jacobian)
        slack = 1e-9 * np.abs(values).max() + self.marginal
        leading = np.flatnonzero(values.real >= values.real.max() - slack)
        vector = vectors[:, leading[np.argmin(np.abs(values[leading]))]]
        # the phase at which the mass is farthest out
        square = complex((vector[:2] ** 2).sum())
        vector = np.real(vector * np.exp(-0.5j * np.angle(square)))
        sign = 1.0 if vector[np.argmax(np.abs(vector[:2]))] > 0 else -1.0
        return np.asarray(sign * vector / np.linalg.norm(vector[:2]))

    @cached_property
    def _roots(self) -> np.ndarray:
        return np.asarray(np.linalg.eigvals(self.jacobian))


def _balanced(design: Design) -> tuple[float, float] | None:
    """Return the place of steady sliding, m, by Newton's method from r = 0.

    At the whole friction at once it would jump to another branch where springs are soft.
    """
    raised = [
        ((step + 1) / SlidingSearch.first_steps, math.inf)
        for step in range(SlidingSearch.first_steps)
    ]
    return _approach(
        design, raised + [(1.0, math.inf)] * SlidingSearch.most_newton_steps
    )


def _followed(design: Design) -> tuple[float, float] | None:
    """Return where an overdamped mass comes to rest, m, while friction is raised slowly from none.

    Pseudo-transient continuation (Kelley and Keyes, SIAM Journal on Numerical Analysis 35 (1998)):
    implicit Euler steps that end as Newton's. Just beyond a fold the mass lingers, then goes far.
    """
    raised = [
        ((step + 1) / SlidingSearch.friction_steps, SlidingSearch.pace)
        for step in range(SlidingSearch.friction_steps)
    ]
    settles = [(1.0, SlidingSearch.pace)] * SlidingSearch.friction_steps
    doubled = [
        min(step, SlidingSearch.most_newton_steps)
        for step in range(SlidingSearch.most_doubled)
    ]
    ends = [(1.0, SlidingSearch.pace * 2.0**step) for step in doubled]
    return _approach(design, raised + settles + ends)


def _approach(
    design: Design, steps: list[tuple[float, float]]
) -> tuple[float, float] | None:
    """A place in balance after steps with a share of friction and a time over 1/rate each.

    Numbers of Python are several times as fast as arrays of two.
    """
    params, stiffness = design.params, design.rate**2
    balance = SlidingSearch.balance * params.k3 * params.preload / params.mass
    longest = SlidingSearch.longest_step * min(params.length1, params.length2)
    farthest = 1e3 * (params.length1 + params.length2)
    x, y, acceleration, last = 0.0, 0.0, _acceleration(design), 1.0
    for share, time in steps:
        if share != last:
            acceleration, last = _acceleration(design, share), share
        try:
            (fx, fy), slopes = _linearized(acceleration, (x, y), (params.preload,) * 2)
            if not (math.isfinite(fx) and math.isfinite(fy)):
                return None
            if share == 1.0 and max(abs(fx), abs(fy)) < balance:
                return x, y
            dx, dy = _step((fx, fy), slopes, stiffness, time, longest)
        except (OverflowError, ZeroDivisionError):  # at a pivot; a singular matrix
            return None
        x, y = x + dx, y + dy
        if not max(abs(x), abs(y)) < farthest:
            return None
    return None


def _step(
    force: tuple[float, float],
    slopes: list[tuple[float, float]],
    stiffness: float,
    time: float,
    longest: float,
) -> tuple[float, float]:
    """An implicit Euler step, of less time where it would go far or against the force.

    Against the force it goes where the time is too long for a place the mass is driven away from.

    Raises:
        ZeroDivisionError: the matrix of the step is singular.
    """
    (fx, fy), ((xx, yx), (xy, yy)) = force, slopes
    while True:
        held = stiffness / time
        dx, dy = _solved(held - xx, -xy, -yx, held - yy, fx, fy)
        too_long = max(abs(dx), abs(dy)) > longest or dx * fx + dy * fy < 0.0
        if math.isinf(time) or not too_long:
            return dx, dy
        time *= 0.5


def _solved(
    a: float, b: float, c: float, d: float, first: float, second: float
) -> tuple[float, float]:
    """Return the solution of a x + b y = first, c x + d y = second, with pivoting."""
    if abs(c) > abs(a):
        a, b, first, c, d, second = c, d, second, a, b, first
    share = c / a
    y = (second - share * first) / (d - share * b)
    return (first - b * y) / a, y


def _acceleration(design: Design, share: float | None = None) -> Any:
    """Acceleration of the mass that slides slower than the belt, m/s².

    Args:
        share: if given, friction has this share of the coefficient of belt speed at any speed.
    """
    params: Any = design.params
    if share is not None:
        # a validated copy would take longer than Newton's step that it is for
        level = {"friction_law": COULOMB, "mu": share * abs(params.drag)}
        params = SimpleNamespace(**vars(params) | level)
    g = Geometry(*map(float, geometry(design.alpha1, design.alpha2)))
    long = tuple(
        length > LONG_SPRING * params.preload
        for length in (params.length1, params.length2)
    )

    linear = VARIANT_RULES[design.model].linear_springs
    form = a1.Suspension(linear, long=(long[0], long[1]))
    direction = design.params.belt_direction

    def acceleration(state: Any) -> tuple[Any, Any]:
        return a1.acceleration(
            a1.State(*state), params, g, contact=1.0, direction=direction, form=form
        )

    return acceleration


def _linearized(
    acceleration: Any, place: Any, units: Sequence[float]
) -> tuple[tuple[float, float], list[tuple[float, float]]]:
    """Acceleration of the mass at rest in some place, and its slopes by the first of x, y, ẋ, ẏ.

    Args:
        units: sizes of so many of these, m and m/s.
    """
    rest = (float(place[0]), float(place[1]), 0.0, 0.0)
    ax, ay, slopes = 0j, 0j, []
    for column, unit in enumerate(units):
        step = SlidingSearch.complex_step * unit
        state: list[complex] = [*rest]
        state[column] += 1j * step
        ax, ay = acceleration(state)
        slopes.append((ax.imag / step, ay.imag / step))
    return (ax.real, ay.real), slopes


def _jacobian(design: Design, place: Any, acceleration: Any) -> np.ndarray:
    """(4, 4) derivative of the velocities and accelerations by the state, at rest in some place."""
    length = design.params.preload
    speed = length * design.rate
    _, slopes = _linearized(acceleration, place, (length, length, speed, speed))
    return np.vstack([np.eye(4)[2:], np.transpose(slopes)])


def excess_growth(jacobian: np.ndarray) -> float:
    """Return the growth rate of small motions beyond that of round-off, 1/s.

    Where no force depends on velocity, frequencies that merge lose half of their digits; elsewhere
    the sign of growth tells, however slow it is.
    """
    roots = np.linalg.eigvals(jacobian)
    share = (
        SlidingSearch.grows_with_damping
        if jacobian[2:, 2:].any()
        else SlidingSearch.grows
    )
    return float(roots.real.max() - share * np.abs(roots).max())
