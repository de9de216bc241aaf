"""Limit cycles of the full model and their branches."""
