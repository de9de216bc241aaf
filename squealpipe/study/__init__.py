"""What only a study needs: statements, figures, report."""
