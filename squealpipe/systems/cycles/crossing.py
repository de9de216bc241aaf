"""A switch at the end of a leg, in numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squealpipe.systems.cycles.legs import Vector


@dataclass(frozen=True)
class Crossing:
    """A switch at the end of a leg, in numbers; n states, p directions.

    Attributes:
        height: of the surface; ``height_by_state`` (n,), ``height_by_time``, ``height_by`` (p,).
        after: the state after the reset; ``after_by_state`` (n, n), ``after_by_time`` (n,),
            ``after_by`` (n, p).
        rate, rate_after: of the state, before and after.
        conditions: of the switch's targets, in order.
    """

    height: float
    height_by_state: Vector
    height_by_time: float
    height_by: Vector
    after: Vector
    after_by_state: Vector
    after_by_time: Vector
    after_by: Vector
    rate: Vector
    rate_after: Vector
    conditions: Vector

    @property
    def speed(self) -> float:
        """Return the rate of the surface along the motion, before the event."""
        return float(self.height_by_state @ self.rate) + self.height_by_time

    def is_beyond(self, state: Vector, sizes: Vector) -> bool:
        """Return whether a state lay beyond the surface, so that the switch fired at once."""
        size = np.maximum(np.abs(state), sizes)
        # relative to the surface's terms: closer, round-off hides that a state is beyond it
        return bool(abs(self.height) > 1e-11 * (np.abs(self.height_by_state) @ size))

    @property
    def delay(self) -> Vector:
        """The derivative of the event's time by the state before it."""
        return np.asarray(-self.height_by_state / self.speed)

    @property
    def saltation(self) -> Vector:
        """The derivative of a motion's later state by its earlier one, both at one time."""
        return np.asarray(self.after_by_state + np.outer(self.jump, self.delay))

    @property
    def jump(self) -> Vector:
        """Return the derivative of a motion's later state by the time of the event."""
        return np.asarray(
            self.after_by_state @ self.rate + self.after_by_time - self.rate_after
        )
