"""A structure with all that can be done with one: the verbs are bound to it here, once."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any, Self

from squealpipe.structures.complex_modes import complex_modes
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.files import read
from squealpipe.structures.reduction import reduce

if TYPE_CHECKING:
    from squealpipe.systems.system import System


class Structure(ContactStructure):  # noqa: D101 (that of the definition)
    __doc__ = ContactStructure.__doc__

    complex_modes, reduce = complex_modes, reduce

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Self:
        """A structure from its file; see :func:`squealpipe.structures.files.read`."""
        return read(path, cls)

    def system(self, displacements: Mapping[str, Any] | None = None) -> System:
        """As a system; see :func:`squealpipe.structures.motion_system.system`."""
        from squealpipe.structures.motion_system import system

        return system(self, displacements)
