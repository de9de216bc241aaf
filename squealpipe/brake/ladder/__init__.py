"""How much model a question needs."""
