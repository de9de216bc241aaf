"""The pad on two springs: models A1 to A4, and the tasks that make datasets of them."""
