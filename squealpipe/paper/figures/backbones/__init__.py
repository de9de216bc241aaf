"""Periodic motions of A4."""
