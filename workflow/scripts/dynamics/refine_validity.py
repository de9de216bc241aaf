"""Where model A1 keeps contact, at full resolution."""

from squealpipe.execution.job import Job
from squealpipe.tasks.dynamics.refinement import refine_validity_map

job = Job(snakemake)
part, params = job.part, job.params
job.make(
    lambda: refine_validity_map(
        params,
        resolution=part["dynamics.refined_points"],
        coarse=part["dynamics.refined_coarse"],
        t_end=part["dynamics.validity_horizon"] * params.time_unit,
        model=job.model,
        tol=part["dynamics.tol"],
    ),
)
