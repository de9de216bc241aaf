"""Complex modes of a structure, which of them squeal, what stops it, a run of it, its contacts."""

from squealpipe.store import load
from squealpipe.store.rerun.key import state_key
from squealpipe.study.job import Job
from squealpipe.study.structure_study import (
    answered,
    modes_over_friction,
    read_structure,
    settled_motion,
    squealing,
)

job = Job(snakemake)
section = job.settings["structure"]
structure = read_structure(section)
job.make(lambda: modes_over_friction(structure, section), job.out.modes)
job.make(lambda: squealing(structure, section, snakemake.threads), job.out.squeal)
answer = load(job.out.squeal)
job.make(
    lambda: answered(structure, section, answer, snakemake.threads), job.out.answer
)
job.make(lambda: settled_motion(structure, section, answer), job.out.run)
structure.write_contacts(job.out.contacts)
state_key(job.out.contacts, job.key)
