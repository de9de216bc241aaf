"""Complex modes of a structure, which of them squeal, and its contacts."""

from squealpipe.store.rerun.key import state_key
from squealpipe.study.job import Job
from squealpipe.study.structure_study import (
    modes_over_friction,
    read_structure,
    squealing,
)

job = Job(snakemake, tells=True)
section = job.settings["structure"]
structure = read_structure(section)
job.make(lambda: modes_over_friction(structure, section), job.out.modes)
job.make(lambda: squealing(structure, section, snakemake.threads), job.out.squeal)
structure.write_contacts(job.out.contacts)
state_key(job.out.contacts, job.key)
