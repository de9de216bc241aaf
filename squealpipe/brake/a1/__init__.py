"""Ensembles of event-driven runs of A1, its variants and A4, and integrators beside them."""
