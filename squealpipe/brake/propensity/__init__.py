"""Uncertain parameters spread into results: propensities and their sensitivity."""
