"""The datasets of one run, loaded on demand and noted down."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import xarray as xr

from squealpipe.parameters import TABLE, Parameters
from squealpipe.store import load


class MissingDataError(LookupError):
    """A check needs a dataset that the run does not have, or one too coarse for it."""


@dataclass
class Evidence(Mapping[str, xr.Dataset]):
    """The datasets of one run by name; each that is looked at is noted in ``used``.

    Attributes:
        sources: dataset name → file, or the dataset itself.
        used: names looked at since the last :meth:`forget`.
    """

    parameters: Parameters
    sources: Mapping[str, Path | xr.Dataset]
    used: list[str] = field(default_factory=list)
    _loaded: dict[str, xr.Dataset] = field(default_factory=dict)

    def __getitem__(self, name: str) -> xr.Dataset:
        if name not in self.sources:
            extensions = [
                key for key in self.parameters.as_dict() if TABLE[key].extension
            ]
            why = (
                f"the study leaves out what cannot carry {', '.join(extensions)}"
                if extensions
                else "it is not part of this study, or not computed yet"
            )
            raise MissingDataError(f"the run has no dataset {name}: {why}")
        if name not in self.used:
            self.used.append(name)
        if name not in self._loaded:
            source = self.sources[name]
            self._loaded[name] = (
                source if isinstance(source, xr.Dataset) else load(source)
            )
        return self._loaded[name]

    def __contains__(self, name: object) -> bool:
        return name in self.sources

    def __iter__(self) -> Iterator[str]:
        return iter(self.sources)

    def __len__(self) -> int:
        return len(self.sources)

    def forget(self) -> list[str]:
        """Names used, each with its id; starts a new note."""
        names = [
            f"{name} ({self._loaded[name].attrs.get('dataset_id', 'not stored')})"
            for name in self.used
        ]
        self.used = []
        return names
