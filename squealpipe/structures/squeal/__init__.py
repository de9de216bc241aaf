"""Which unstable modes of a structure squeal: starts, settled motions, attractors."""
