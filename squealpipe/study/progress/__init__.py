"""What `squealpipe run` says while Snakemake works."""
