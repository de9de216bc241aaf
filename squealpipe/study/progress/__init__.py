"""Progress of `squealpipe run` while Snakemake works."""
