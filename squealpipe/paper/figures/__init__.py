"""Figures: datasets in, pictures out."""
