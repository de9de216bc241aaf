"""Piecewise-smooth systems: each is one file of fields, switches and a start."""
