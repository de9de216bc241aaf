"""Class ``Structure``: a structure's definition, with what can be computed of it as methods."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from squealpipe.structures.complex_modes import complex_modes
from squealpipe.structures.contact_table import write_contacts
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.files import from_mesh, read
from squealpipe.structures.meshes.faces import Face, Rotation
from squealpipe.structures.reduction import reduce

if TYPE_CHECKING:
    from squealpipe.systems.system import System


class Structure(ContactStructure):  # noqa: D101 (that of the definition)
    __doc__ = ContactStructure.__doc__

    complex_modes, reduce = complex_modes, reduce

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Self:
        """Read a structure from its file; see :func:`squealpipe.structures.files.read`."""
        return read(path, cls)

    @classmethod
    def from_mesh(
        cls,
        mass: Any,
        stiffness: Any,
        damping: Any = None,
        *,
        mesh: Any,
        contacts: Mapping[str, Face],
        rotation: Rotation | None = None,
        degrees_of_freedom: Any = None,
        units: str | None = None,
        **arguments: Any,
    ) -> Self:
        """Make a structure whose contacts are faces of a mesh.

        Args:
            mass, stiffness, damping: matrices, or files of them.
            mesh: deck of CalculiX or Abaqus (.inp), a file that meshio reads (.msh, .bdf, …), a
                mesh of meshio, or (nodes, faces): positions (n, 3) or {number: position}, and
                {name: facets} by indices from 0 or by these numbers, counterclockwise as seen from
                outside.
            contacts: faces by name; the contacts of ``"lining"`` are ``lining_1``, ``lining_2``, …,
                in ascending order of their nodes.
            rotation: rotation about an axis of the body that the faces press on; without it each
                face states its ``direction``.
            degrees_of_freedom: node and direction of each row of the matrices, as names ``"12.1"``,
                pairs (12, 1) or a ``.dof`` file. None: as the matrix files have them; arrays have 3
                rows for each node.
            units: units of the matrices and the mesh, like ``"mm-t-s"``; SI by default. Numbers of
                faces and of the rotation are SI or texts with a unit.
            arguments: further arguments of :class:`Structure`.

        Raises:
            FileNotFoundError: a file that does not exist.
            ValueError: what is wrong, with the names of face, surface and node, and a remedy.
        """
        return from_mesh(
            cls,
            {"mass": mass, "stiffness": stiffness, "damping": damping},
            mesh,
            contacts,
            rotation,
            degrees_of_freedom,
            units,
            arguments,
        )

    def with_points(self, points: int) -> Self:
        """Return the structure with at most ``points`` contacts for each face of a mesh.

        Neighbours are merged; stiffness, force and first moments of a face stay. Any change of an
        answer is therefore due to how the pressure is spread; see
        :func:`squealpipe.structures.fewer_points.with_points`.
        """
        from squealpipe.structures.fewer_points import with_points

        return with_points(self, points)  # type: ignore[no-any-return]

    def write_contacts(self, path: str | PathLike[str]) -> None:
        """Write the contacts as a table (.csv) that the key ``contacts`` of a file takes.

        Beside directions, stiffness or law, preload and speed the columns say how each contact of a
        mesh came about: its nodes and those that it meets, area, gap and position. Numbers have
        units, so that the table is right in a file of any units. A friction law of a contact's own
        is refused.

        Raises:
            ValueError: a reduced structure, whose contacts act on modes; or such a law.
        """
        if self.modes is not None:
            raise ValueError(
                "contacts of a reduced structure act on its modes; write those of the whole"
            )
        with_law = [
            contact.name
            for contact in self.contacts
            if contact.friction_law is not None
        ]
        if with_law:
            raise ValueError(
                f"contact {with_law[0]} has a friction_law of its own, which a table of contacts "
                "cannot hold"
            )
        names = self.names or [str(row) for row in range(1, self.size + 1)]
        turning = self.rotation is not None
        write_contacts(self.contacts, names, Path(path), turning=turning)

    def system(self, displacements: Mapping[str, Any] | None = None) -> System:
        """Return the structure as a system; see
        :func:`squealpipe.structures.motion_system.system`.
        """
        from squealpipe.structures.motion_system import system

        return system(self, displacements)
