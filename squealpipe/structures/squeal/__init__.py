"""Squeal of a structure: starts, settled motions, attractors of its unstable modes."""
