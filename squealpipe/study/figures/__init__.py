"""Figures of a study of one's own pad or structure."""
