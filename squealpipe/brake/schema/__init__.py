"""Schemas of the datasets that tasks of the pad make."""
