"""Gaps between the faces of a mesh: how wide they are, and where they are in doubt.

The matrices of a structure hold no distance between its bodies: contacts act on both as if they
touched. A gap that nobody meant shifts the friction of one body against that of the other.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from squealpipe.structures.contact import Contact, face_of
from squealpipe.structures.meshes.pairing import Pairing
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number


class FaceGaps(NamedTuple):
    """Gaps of the contacts of one face.

    Attributes:
        face: its name.
        largest: m, by magnitude; negative where the bodies overlap.
        mean: of their magnitudes, weighted by area, m.
        facet: longest edge of the facets that the contact with the largest gap meets, m.
        node: of that contact.
    """

    face: str
    largest: float
    mean: float
    facet: float
    node: int

    @property
    def is_doubtful(self) -> bool:
        """Tell whether the gap is more than what facets of a curved face leave."""
        # a chord of length h leaves h²/8R to a circle of radius R: 5 % of h where h = 0.4 R, and
        # coarser facets make no contact that is worth computing
        return abs(self.largest) > 0.05 * self.facet

    def __str__(self) -> str:
        """Return largest and mean gap in one sentence."""
        if abs(self.largest) < Pairing.matching * self.facet:
            return f"{self.face}: the faces touch"
        largest = engineering(abs(self.largest), "m")
        kind = "bodies overlap by" if self.largest < 0 else "gap"
        return (
            f"{self.face}: {kind} {largest} at most (node {self.node}), "
            f"{engineering(self.mean, 'm')} in the mean"
        )

    def doubt(self) -> str:
        """Return what is wrong with a doubtful gap, with a remedy."""
        share = number(100.0 * abs(self.largest) / self.facet, 2)
        return (
            f"{self}, {share} % of its facet of {engineering(self.facet, 'm')}; contacts act as if "
            "the faces touched: move the bodies of the mesh together, or state its unit of length, "
            "unless a layer between them is meant"
        )


def gaps_of(contacts: Sequence[Contact]) -> Iterator[FaceGaps]:
    """Yield the gaps of each face of a mesh that meets another one."""
    faces: dict[str, list[Contact]] = {}
    for contact in contacts:
        if contact.origin is not None and contact.origin.against:
            faces.setdefault(face_of(contact.name) or contact.name, []).append(contact)
    for face, members in faces.items():
        origins = [member.origin for member in members if member.origin is not None]
        gaps = np.abs([origin.gap for origin in origins])
        areas = np.array([origin.area for origin in origins])
        # the first of equal ones, however they are rounded
        widest = origins[int((gaps >= (1.0 - 1e-9) * gaps.max()).argmax())]
        mean = float(gaps @ areas / areas.sum())
        yield FaceGaps(face, widest.gap, mean, widest.facet, widest.nodes[0])
