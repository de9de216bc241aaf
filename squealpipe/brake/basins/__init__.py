"""Runs from other starts than rest: basins and smallest disturbances."""
