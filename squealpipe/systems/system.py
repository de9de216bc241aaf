"""A system with all that can be done with one: the verbs are bound to it here, once."""

from collections.abc import Sequence
from typing import Any

import xarray as xr

from squealpipe.schema.systems import check
from squealpipe.systems.basin import basin
from squealpipe.systems.components import Switch
from squealpipe.systems.definition import Definition
from squealpipe.systems.runs import ensemble, simulate
from squealpipe.systems.tracing import TracedSystem

__all__ = ["Switch", "System"]


class System(TracedSystem):  # noqa: D101 (that of the definition)
    __doc__ = Definition.__doc__

    simulate, ensemble, basin = simulate, ensemble, basin

    def limit_cycle(self, **options: Any) -> xr.Dataset:
        """A periodic motion; see :func:`squealpipe.systems.cycles.cycle.limit_cycle`."""
        from squealpipe.systems.cycles.cycle import limit_cycle

        return check(limit_cycle(self, **options))

    def cycle_branch(self, parameter: str, to: float, **options: Any) -> xr.Dataset:
        """A branch of cycles; see :func:`squealpipe.systems.cycles.branch.cycle_branch`."""
        from squealpipe.systems.cycles.branch import cycle_branch

        return check(cycle_branch(self, parameter, to, **options))

    def cycle_curve(
        self, label: str, parameters: Sequence[str], **options: Any
    ) -> xr.Dataset:
        """A curve in two parameters; see :func:`squealpipe.systems.cycles.curve.cycle_curve`."""
        from squealpipe.systems.cycles.curve import cycle_curve

        return check(cycle_curve(self, label, parameters, **options))
