"""Which results an edit makes stale, and what will be computed again."""
