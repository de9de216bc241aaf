"""A public benchmark of integrators with events: problems, references, adapters, scores."""
