"""Inputs of systems: words, units, values and the gate for arguments."""
