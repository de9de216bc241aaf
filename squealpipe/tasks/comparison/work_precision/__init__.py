"""Error against time of every method."""
