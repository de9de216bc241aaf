"""Schemas of computations in time: single runs, their summaries, maps of long runs, assumptions."""
