"""What is kept and found again: shared contents, the index of runs, runs as trees, deposits."""
