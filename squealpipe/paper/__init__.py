"""The study of the 2021 paper: its statements, figures, parameters and report."""
