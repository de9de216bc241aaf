"""Maps and boundaries of the linear models."""
