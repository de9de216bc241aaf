"""Motions in time and their maps."""
