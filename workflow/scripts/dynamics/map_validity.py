"""Map of where model A1 keeps contact; of a scattered map the rows of one part."""

from squealpipe.brake.dynamics.runs import validity_map
from squealpipe.study.job import Job
from squealpipe.study.scatter import over_angles

job = Job(snakemake)
job.make(
    lambda: validity_map(
        job.params,
        model=job.model,
        workers=snakemake.threads,
        **over_angles(job, "validity"),
    )
)
