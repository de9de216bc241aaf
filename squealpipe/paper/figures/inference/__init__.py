"""The parameters that agree with the paper."""
