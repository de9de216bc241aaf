"""Figures of pads on several contact points."""
