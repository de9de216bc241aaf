"""A sweep over the operating points of a structure in a file: ``FILE.yaml:operating_map``."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np
import xarray as xr

from squealpipe.schema.origin import origin
from squealpipe.structures.assess.operating_map import operating_map
from squealpipe.structures.assess.operating_points import FLAGS, VALUES, OperatingPoints
from squealpipe.structures.schema.operating_map import QUANTITIES
from squealpipe.structures.squeal.plant import band_of
from squealpipe.structures.structure import Structure
from squealpipe.study.chunks import Run
from squealpipe.study.point_sweep import PointSweep
from squealpipe.study.scatter import scattered_values
from squealpipe.systems.inputs.words import suggestion

TASK = operating_map.__name__
REDUCTION = ("n_modes", "frequency_max")
OPERATING_OPTIONS = (
    "mu_of",
    "measured",
    "frequency_band",
    "band_edges",
    "tol",
    *REDUCTION,
)


@dataclass(frozen=True, kw_only=True)
class OperatingSweep(PointSweep):
    """Operating points of a structure, one after the other.

    Attributes:
        task: ``FILE.yaml:operating_map``.
        vary: pressure, speed, mu or temperature → values.
        fixed: those that are one value, and options of ``operating_map``, ``n_modes`` and
            ``frequency_max``.
        operating: the operating points of the whole map.

    Raises:
        FileNotFoundError: no such file.
        ValueError: a file, name or value that is wrong.
    """

    operating: OperatingPoints = field(init=False, compare=False)
    facts: Mapping[str, Any] = field(init=False, compare=False)

    def __post_init__(self) -> None:
        structure = Structure.read(self.task.rpartition(":")[0])
        options = dict(self.fixed)
        # Prefix of an option that is a table of friction, like ``mu_of_temperature``.
        table = "mu_of_"
        tables = {
            name.removeprefix(table): options.pop(name)
            for name in self.fixed
            if name.startswith(table)
        }
        if tables:
            options["mu_of"] = tables
        for name in self.vary:
            if name not in QUANTITIES:
                raise ValueError(
                    f"{name} cannot be varied; {suggestion(name, QUANTITIES)}"
                )
        for name in options:
            known = [*QUANTITIES, *OPERATING_OPTIONS]
            if name not in known:
                raise ValueError(f"{name}: {suggestion(name, known)}")
        asked = {name: option for name, option in options.items() if option is not None}
        asked |= self.vary
        n_modes = asked.pop("n_modes", None)
        band = band_of(structure, asked.pop("frequency_max", None))
        operating = OperatingPoints.of(structure, **asked).reduced(n_modes, band)
        object.__setattr__(self, "operating", operating)
        facts = {"structure": structure.as_dict(), **asked}
        if band is not None:
            facts["frequency_max"] = band
        object.__setattr__(self, "facts", facts)
        axes = {name: values.tolist() for name, values in operating.axes.items()}
        object.__setattr__(self, "vary", axes)

    @property
    def points(self) -> Sequence[Sequence[float]]:
        """The index of each point in the map, as a tuple of one."""
        return [(index,) for index in range(self.operating.count)]

    def scattered(self, item: str) -> Self:
        """Return one part of a scattered sweep, ``i-of-n`` along its longest dimension."""
        axes = {
            name: np.asarray(values)
            for name, values in scattered_values(self.vary, item).items()
        }
        # the structure stays as it was reduced for the whole map
        part = replace(self.operating, axes=axes, noises=None)
        return self._with(part)

    def _with(self, operating: OperatingPoints) -> Self:
        other = object.__new__(type(self))
        vary = {name: values.tolist() for name, values in operating.axes.items()}
        for name, value in {**vars(self), "operating": operating, "vary": vary}.items():
            object.__setattr__(other, name, value)
        return other

    def arrays(self, point: Sequence[float], workers: int | None) -> Run:  # noqa: ARG002 (of other sweeps)
        """Return the results at one point."""
        return {
            name: np.asarray(value)
            for name, value in self.operating.run(int(point[0])).items()
        }

    def merged(self, runs: Callable[[], Iterator[Run]]) -> xr.Dataset:
        """Return the map of all points, in order."""
        rows = list(runs())
        columns = {
            name: np.array([row[name] for row in rows]) for name in (*VALUES, *FLAGS)
        }
        dataset = self.operating.dataset(columns)
        facts = dict(self.facts)
        numbers = facts.pop("structure")
        recorded = {name: facts[name] for name in facts if name not in dataset.coords}
        recorded["tol"] = self.operating.tol
        dataset.attrs.update(origin(TASK, {"structure": _Numbers(numbers), **recorded}))
        return dataset

    def joined(self, parts: Sequence[xr.Dataset]) -> xr.Dataset:
        """Join the parts of a scattered map, in order."""
        along = max(self.vary, key=lambda name: len(self.vary[name]))
        names = (*VALUES, *FLAGS)
        whole = xr.concat([part[[*names]] for part in parts], along)
        columns = {
            name: whole[name].transpose(*self.vary).values.ravel() for name in names
        }
        rows = [
            {name: column[index] for name, column in columns.items()}
            for index in range(self.operating.count)
        ]
        return self.merged(lambda: iter(rows))


@dataclass(frozen=True)
class _Numbers:
    """Numbers of a structure, as its datasets record them."""

    numbers: Mapping[str, Any]

    def as_dict(self) -> Mapping[str, Any]:
        """Return the numbers."""
        return self.numbers
