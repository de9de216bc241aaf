"""Where model A1 keeps contact, at full resolution."""

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_a1
from squealpipe.store import produce
from squealpipe.tasks.dynamics.refinement import refine_validity_map

part = snakemake.params.part
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
    output=snakemake.output[0],
)
