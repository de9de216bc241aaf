"""Map of where model A1 keeps contact, at full resolution."""

from squealpipe.brake.dynamics.refinement import refine_validity_map
from squealpipe.study.job import Job

job = Job(snakemake)
settings, params = job.settings, job.params
job.make(
    lambda: refine_validity_map(
        params,
        resolution=settings["dynamics.refined_points"],
        coarse=settings["dynamics.refined_coarse"],
        t_end=settings["dynamics.validity_horizon"] * params.time_unit,
        model=job.model,
        tol=settings["dynamics.tol"],
        workers=snakemake.threads,
    )
)
