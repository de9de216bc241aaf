"""Assessment of a pad: squeal or hammering, frequency, level, cause, and what stops it."""
