"""Piecewise-smooth systems: each is one file of a field, switches and a start."""

from pathlib import Path

# 1.0.0 had the systems of `shipped` in this package itself, and its import paths stay.
__path__.append(str(Path(__file__).with_name("shipped")))
