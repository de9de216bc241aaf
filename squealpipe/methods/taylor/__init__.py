"""Taylor series of hybrid systems: symbols, recurrences, lanes, roots; heyoka for references."""
