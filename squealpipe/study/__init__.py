"""Studies: configuration, sweeps, progress and reports of one's own."""
