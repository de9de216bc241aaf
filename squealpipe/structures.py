"""Structures with many contacts; their home is :mod:`squealpipe.systems.structures`."""

from squealpipe.systems.structures import Contact, Structure, elastic_pad

__all__ = ["Contact", "Structure", "elastic_pad"]
