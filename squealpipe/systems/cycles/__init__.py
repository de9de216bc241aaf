"""Periodic motions of systems: event maps, cycles, branches."""
