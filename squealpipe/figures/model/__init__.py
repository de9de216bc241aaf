"""The model's mechanism."""
