"""Figures of the robustness of verdicts, and of how uncertain parameters spread into results."""
