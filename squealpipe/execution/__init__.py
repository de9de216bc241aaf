"""The same task many times: catalogue, sweeps, row blocks."""
