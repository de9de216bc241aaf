"""Runs in time and what is read off them."""
