"""Exact periodic orbits of piecewise linear systems, and their branches."""
