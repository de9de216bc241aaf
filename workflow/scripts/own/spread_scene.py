"""Shares and Sobol indices around the first scene of a study of one's own."""

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.propensity.distributions import centred
from squealpipe.tasks.propensity.propensity import propensity

part = snakemake.params.part
params, scene = parameters_of(part), next(iter(part["scenes"].values()))
angles = scene["alpha1"], scene["alpha2"]
produce(
    lambda: propensity(
        params,
        *angles,
        distributions=part["spread.distributions"] or centred(params, *angles),
        samples=part["spread.samples"],
        spring_correlation=part["spread.spring_correlation"],
        t_end=part["spread.horizon"] * params.time_unit,
        workers=snakemake.threads,
    ),
    config=part, key=snakemake.params.key, output=snakemake.output[0],
)
