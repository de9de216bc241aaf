"""Panels, axes and keys that several figures share."""
