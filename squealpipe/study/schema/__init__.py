"""Schemas of sweeps and of a study's own datasets."""
