"""A sweep of the complex modes of a structure in a file: ``FILE.yaml:complex_modes``."""

from dataclasses import dataclass, field
from typing import Any, Self

import xarray as xr

from squealpipe.structures.factors import asked_of
from squealpipe.structures.structure import Structure
from squealpipe.study.chunks import Chunks
from squealpipe.study.sweep_plan import SweepPlan


@dataclass(frozen=True, kw_only=True)
class StructureSweep(SweepPlan):
    """Complex modes of a structure over ranges; one part, for modes are numbered over all of them.

    Attributes:
        task: ``FILE.yaml:complex_modes``.
        vary: name → values, of friction, belt speed and further factors.
        fixed: further ones, ``frequency_max`` (Hz) and ``n_modes``.

    Raises:
        FileNotFoundError: no such file.
        ValueError: a file, task or name that is wrong.
    """

    swept_options = ("frequency_max", "n_modes")

    structure: Structure = field(init=False, compare=False)

    def __post_init__(self) -> None:
        file, _, task = self.task.rpartition(":")
        swept_task = "complex_modes"
        if task != swept_task:
            raise ValueError(
                f"{self.task}: a structure has the task {swept_task}; write {file}:{swept_task}"
            )
        object.__setattr__(self, "structure", Structure.read(file))
        for name in self.vary:
            if name in StructureSweep.swept_options:
                raise ValueError(f"{name} cannot be varied; fix it")
        asked_of(self.structure, **self._arguments())

    def scattered(self, item: str) -> Self:
        """The whole, which is its only part."""
        if item != "1-of-1":
            raise ValueError(f"{self.task} is made in one part, not {item}")
        return self

    def finished(self, kept: Chunks) -> int:  # noqa: ARG002
        """Return 0: it is computed in one piece."""
        return 0

    def dataset(
        self,
        workers: int | None = None,  # noqa: ARG002
        kept: Chunks | None = None,  # noqa: ARG002
    ) -> xr.Dataset:
        """Return the modes over friction, belt speed and further factors."""
        arguments = self._arguments()
        return self.structure.complex_modes(**arguments.pop("factors"), **arguments)

    def _arguments(self) -> dict[str, Any]:
        factors = {**self.fixed, **self.vary}
        options = {
            name: factors.pop(name)
            for name in StructureSweep.swept_options
            if name in factors
        }
        return {"factors": factors, **options}
