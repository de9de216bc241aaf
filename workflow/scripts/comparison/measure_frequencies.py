"""Work–precision of harmonic balance on A4."""

import os

# threads cost small matrices more than they save, and make their times uncertain; Snakemake
# sets as many as the rule has
os.environ["OPENBLAS_NUM_THREADS"] = "1"

from squealpipe.paper.comparison.work_precision import work_precision
from squealpipe.study.job import Job

job = Job(snakemake)
job.make(lambda: work_precision(job.params, **job.settings["comparison.harmonic"]))
