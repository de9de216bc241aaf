"""Structures with many contacts; their home is :mod:`squealpipe.systems.structures`."""

from squealpipe.systems.structures import (
    Contact,
    Face,
    Rotation,
    Structure,
    elastic_pad,
)

__all__ = ["Contact", "Face", "Rotation", "Structure", "elastic_pad"]
