"""Meshes of finite elements: decks, surfaces, and the contacts that come about between them."""
