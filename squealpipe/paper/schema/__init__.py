"""Schemas of the datasets that only the paper's study makes."""
