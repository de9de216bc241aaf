"""Methods and model levels compared."""
