"""Which parameters agree with the paper's statements."""
