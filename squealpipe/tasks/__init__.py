"""Tasks: a model and a method make a labelled dataset."""
