"""Whether a structure squeals or hammers, at which frequency, how loud, why, and what stops it."""
