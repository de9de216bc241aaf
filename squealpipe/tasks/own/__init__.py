"""Scenes of a study of one's own."""
