"""Periodic motions of A4: exact orbits, exact and harmonic branches."""
