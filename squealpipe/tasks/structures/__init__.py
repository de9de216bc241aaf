"""Questions to structures that the study of the paper asks."""
