"""The paper's report and its explorer."""
