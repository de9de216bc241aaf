"""How far verdicts carry, and how parameters spread into results."""
