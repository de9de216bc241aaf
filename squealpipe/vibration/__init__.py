"""Decide what a vibration settles to, by one set of rules for pads and structures."""
