"""The cheapest model level that suffices for a question."""
