"""Harmonic balance: by closed-form contact integrals, by samples, and Hill's stability."""
