"""Unstable modes of a structure with fewer contact points of each face."""

from squealpipe.study.job import Job
from squealpipe.study.structure_study import modes_with_fewer_points, read_structure

job = Job(snakemake)
section = job.settings["structure"]
structure = read_structure(section)
job.make(lambda: modes_with_fewer_points(structure, section))
