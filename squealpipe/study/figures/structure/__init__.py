"""Figures of the report of a structure."""
