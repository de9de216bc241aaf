"""Periodic motions of A4 as datasets."""
