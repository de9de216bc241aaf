"""Checks: rows of statements, one module for each part of the paper."""
