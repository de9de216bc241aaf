"""Taylor series of hybrid systems: symbols, recurrences, lanes, roots."""
