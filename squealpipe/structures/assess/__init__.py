"""Assessment of a structure: squeal or hammering, frequency, level, cause, and what stops it."""
