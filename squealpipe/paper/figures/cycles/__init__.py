"""Limit cycles of the full model."""
