"""The report: datasets, figures and claims on one page."""
