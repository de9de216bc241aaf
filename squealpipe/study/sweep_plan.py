"""Plan of a sweep, whatever its task is read from: a name, a system's file or a structure's."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import xarray as xr

from squealpipe.study.chunks import Chunks
from squealpipe.study.scatter import scattered_values


@dataclass(frozen=True, kw_only=True)
class SweepPlan(ABC):
    """A task, the values of what varies, by name, and what stays the same."""

    task: str
    vary: Mapping[str, Sequence[float]]
    fixed: Mapping[str, Any]

    @property
    def names(self) -> list[str]:
        """Swept names in the order given."""
        return list(self.vary)

    def scattered(self, item: str) -> Self:
        """Return one part, ``i-of-n``: some of the values of the longest name."""
        return replace(self, vary=scattered_values(self.vary, item))

    @abstractmethod
    def finished(self, kept: Chunks) -> int:
        """Return the number of runs that are on disk."""

    @abstractmethod
    def dataset(
        self, workers: int | None = None, kept: Chunks | None = None
    ) -> xr.Dataset:
        """Return the results of all runs.

        Args:
            workers: processes; None takes all cores.
            kept: where finished runs are kept on disk; those that are there are not made again.
        """
