"""Boundaries over two parameters as curves."""
