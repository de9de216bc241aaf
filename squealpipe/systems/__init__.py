"""Piecewise-smooth systems: each is one file of a field, switches and a start."""
