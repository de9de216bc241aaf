"""A system with all that can be done with one: the verbs are bound to it here, once."""

from collections.abc import Sequence
from typing import Any

import xarray as xr

from squealpipe.systems.basin import basin
from squealpipe.systems.components import Switch
from squealpipe.systems.definition import Definition
from squealpipe.systems.runs import ensemble, simulate
from squealpipe.systems.tracing import TracedSystem

__all__ = ["Switch", "System"]


class System(TracedSystem):  # noqa: D101 (that of the definition)
    __doc__ = Definition.__doc__

    simulate, ensemble, basin = simulate, ensemble, basin

    def flow(self, followed: Sequence[str] = (), scales: Any = None) -> Any:
        """Return the motion along legs, with derivatives by states and the followed parameters.

        Args:
            scales: in which states, times and parameters are numbers; None: in their own units.
        """
        from squealpipe.systems.cycles.flow import TracedFlow

        return TracedFlow(self, followed, scales)

    def limit_cycle(
        self,
        *,
        start: Any = None,
        guess: Any = None,
        periods: int = 1,
        t_settle: float | None = None,
        **options: Any,
    ) -> xr.Dataset:
        """Find a periodic motion, every event located, with its Floquet multipliers.

        A run from ``start`` settles first; near a ``guess`` Newton's method alone decides, so that
        the motion may be unstable. Forced motions repeat after whole forcing periods, others after
        a time of their own.

        Args:
            start: states from where to settle, where they differ from the system's start.
            guess: states near the cycle instead; at t = 0 of the forcing.
            periods: of the forcing; without it, returns to the rarest event.
            t_settle: s; 200 forcing periods or time scales by default.
            options: ``max_steps`` of a run (10⁷), and parameters by their names.

        Returns:
            Dataset of :func:`squealpipe.systems.cycles.cycle.limit_cycle`: ``period``, extremes,
            ``multiplier_real``, ``multiplier_imag``, ``stable``, events, the path, and ``outcome``.
        """
        from squealpipe.systems.cycles.cycle import limit_cycle

        options |= {"start": start, "guess": guess}
        return limit_cycle(self, periods=periods, t_settle=t_settle, **options)

    def cycle_branch(self, parameter: str, to: float, **options: Any) -> xr.Dataset:
        """A branch of cycles; see :func:`squealpipe.systems.cycles.branch.cycle_branch`."""
        from squealpipe.systems.cycles.branch import cycle_branch

        return cycle_branch(self, parameter, to, **options)

    def cycle_curve(
        self, label: str, parameters: Sequence[str], **options: Any
    ) -> xr.Dataset:
        """A curve in two parameters; see :func:`squealpipe.systems.cycles.curve.cycle_curve`."""
        from squealpipe.systems.cycles.curve import cycle_curve

        return cycle_curve(self, label, parameters, **options)
