"""Periodic motions of hybrid systems: flow with events, return map, branches."""
