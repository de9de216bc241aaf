"""Inference of the parameters that agree with the paper's statements."""
