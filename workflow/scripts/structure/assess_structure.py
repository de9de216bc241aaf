"""Answer of a structure: verdict, level, what stops it; and a run of its settled motion."""

from squealpipe.store import load
from squealpipe.study.job import Job
from squealpipe.study.structure_study import answered, read_structure, settled_motion

job = Job(snakemake, tells=True)
section, changes = job.settings["structure"], job.settings["modifications"]
structure, squeal = read_structure(section), load(snakemake.input.squeal)
job.make(
    lambda: answered(structure, section, squeal, changes, snakemake.threads),
    job.out.answer,
    inputs=[snakemake.input.squeal],
)
job.make(lambda: settled_motion(structure, section, squeal), job.out.run)
