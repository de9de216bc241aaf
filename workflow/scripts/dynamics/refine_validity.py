"""Where model A1 keeps contact, at full resolution, and the check against uniform maps."""

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_a1
from squealpipe.store import load, produce
from squealpipe.tasks.dynamics.refinement import check_refinement, refine_validity_map

part, out = snakemake.params.part, snakemake.output
params, model = for_a1(parameters_of(part), part["read_as"])
produce(
    lambda: refine_validity_map(
        params,
        resolution=part["dynamics.refined_points"],
        coarse=part["dynamics.refined_coarse"],
        t_end=part["dynamics.validity_horizon"] * params.time_unit,
        model=model,
        tol=part["dynamics.tol"],
    ),
    config=part, key=snakemake.params.key,
    output=out.refined,
)
produce(
    lambda: check_refinement(
        params,
        load(out.refined),
        points=part["dynamics.uniform_points"],
        model=model,
        tol=part["dynamics.tol"],
    ),
    config=part, key=snakemake.params.key,
    output=out.check,
    inputs=[out.refined],
)
