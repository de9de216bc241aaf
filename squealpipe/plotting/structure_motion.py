"""Read the settled motion of a structure from a dataset ``structure_run``."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np
import xarray as xr

from squealpipe.codes import Regime
from squealpipe.structures.meshes.datasets import mesh_of
from squealpipe.structures.meshes.structure_mesh import StructureMesh

SCHEMA = "structure_run"


@dataclass(frozen=True)
class StructureMotion:
    """A settled motion of a structure, at instants in rising order.

    Attributes:
        time: (n,), s.
        displacement, velocity: of the coordinates, (n, coordinates).
        shapes: displacement of each degree of freedom per coordinate, (freedoms, coordinates).
        contact_place: along and across the belt, (n, contacts, 2), m.
        contact_velocity: likewise, m/s.
        force: normal force over the preload, or over its mean where there is none, (n, contacts).
        regimes: codes of :class:`squealpipe.codes.Regime`, (n, contacts).
        contacts: names.
        mesh: nodes, facets and degrees of freedom; None where there is none.
        contact_position: (contacts, 3), m; None likewise.
        belt_speed: m/s.
    """

    direction_names: ClassVar = {1: "along x", 2: "along y", 3: "along z"}

    time: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    shapes: np.ndarray
    contact_place: np.ndarray
    contact_velocity: np.ndarray
    force: np.ndarray
    regimes: np.ndarray
    contacts: list[str]
    mesh: StructureMesh | None
    contact_position: np.ndarray | None
    belt_speed: float
    frequency: float
    settled: bool = field(default=True, init=False)

    @classmethod
    def read(cls, run: xr.Dataset) -> Self:
        """Read the motion."""
        preload = run.preload.values
        mean = np.maximum(run.normal_force.values.mean(axis=0), 1e-300)
        ways = ("along", "across")
        place, velocity = (
            np.stack([run[f"contact_{name}_{way}"].values for way in ways], axis=2)
            for name in ("displacement", "velocity")
        )
        stated = json.loads(run.attrs.get("parameters", "{}"))
        position = run.contact_position.values if "contact_position" in run else None
        if position is not None and not np.isfinite(position).all():
            position = None
        return cls(
            time=run.time.values,
            displacement=run.displacement.values,
            velocity=run.velocity.values,
            shapes=run.mode_shape.values,
            contact_place=place,
            contact_velocity=velocity,
            force=run.normal_force.values / np.where(preload > 0, preload, mean),
            regimes=run.regime.values,
            contacts=[str(name) for name in run.contact.values],
            mesh=mesh_of(run),
            contact_position=position,
            belt_speed=float(stated.get("belt_speed", 0.0)),
            frequency=float(run.dominant_frequency),
        )

    def nearest(self, instants: np.ndarray) -> np.ndarray:
        """Return the indices of the samples that are nearest to instants, s."""
        return np.searchsorted(0.5 * (self.time[1:] + self.time[:-1]), instants)

    @property
    def opens_most(self) -> int:
        """Place of the contact that is open for the largest share of the time."""
        return int((self.regimes == Regime.separated).mean(axis=0).argmax())

    def heard(self, at: str | None) -> tuple[np.ndarray, str]:
        """Return the velocity (n,), m/s, that is asked for, or the loudest one, and words for it.

        Args:
            at: a contact by its name, a node by its number or ``number.direction``; by default the
                displacement of all degrees of freedom that has the largest rms velocity.

        Raises:
            ValueError: there is no such contact or node.
        """
        if at in self.contacts:
            both = self.contact_velocity[:, self.contacts.index(at)]
            way = int(both.std(axis=0).argmax())
            words = "along the belt" if way == 0 else "across the belt"
            return both[:, way], f"of contact {at} {words}"
        rows = self._rows(at)
        # rms of all by the covariance of the few coordinates
        covariance = np.cov(self.velocity, rowvar=False).reshape(
            2 * (self.velocity.shape[1],)
        )
        shapes = self.shapes[rows]
        squares = np.einsum("ij,jk,ik->i", shapes, covariance, shapes)
        row = int(rows[squares.argmax()])
        return self.velocity @ self.shapes[row], f"of {self._name(row)}"

    def _rows(self, at: str | None) -> np.ndarray:
        """Degrees of freedom that are displacements: of a node, or of all."""
        if self.mesh is None:
            if at is not None:
                raise ValueError(
                    f"at = {at!r}: the run has no mesh; name a contact: {', '.join(self.contacts)}"
                )
            return np.arange(len(self.shapes))
        rows = self.mesh.rows_at(at)
        if not rows.size:
            raise ValueError(
                f"at = {at!r}: no node that moves, and no contact: {', '.join(self.contacts)}; "
                "write 12 for node 12, or 12.2 for its displacement along y"
            )
        return rows

    def _name(self, row: int) -> str:
        if self.mesh is None:
            return f"degree of freedom {row + 1}, counted from 1"
        node, direction = self.mesh.degree_of_freedom[row]
        return f"node {self.mesh.numbers[node]} {StructureMotion.direction_names[int(direction)]}"

    def nodes_at(self, frames: np.ndarray) -> np.ndarray:
        """Return displacements of the nodes from their means, (frames, nodes, 3), m."""
        if self.mesh is None:
            raise ValueError("the run has no mesh")
        away = self.displacement[frames] - self.displacement.mean(axis=0)
        return np.stack([self.mesh.displacements(self.shapes @ each) for each in away])
