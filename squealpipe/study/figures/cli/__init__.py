"""Pictures of single results, for the command line."""
