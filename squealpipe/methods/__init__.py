"""Methods: they know dynamical systems, not squeal."""
