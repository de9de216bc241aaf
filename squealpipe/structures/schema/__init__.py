"""Schemas of the datasets that structures make."""
