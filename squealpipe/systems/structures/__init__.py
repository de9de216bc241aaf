"""Structures: matrices of finite elements with contacts on a belt, and their complex modes."""

from squealpipe.systems.structures.contact import Contact
from squealpipe.systems.structures.elastic_pad import elastic_pad
from squealpipe.systems.structures.meshes.faces import Face, Rotation
from squealpipe.systems.structures.structure import Structure

__all__ = ["Contact", "Face", "Rotation", "Structure", "elastic_pad"]
