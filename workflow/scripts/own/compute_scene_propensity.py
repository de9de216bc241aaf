"""Shares and Sobol indices around the first scene of a study of one's own."""

from squealpipe.brake.propensity.propensity import propensity
from squealpipe.parameters import parameters_of
from squealpipe.store import produce

settings = snakemake.params.settings
params, scene = parameters_of(settings), next(iter(settings["scenes"].values()))
angles = scene["alpha1"], scene["alpha2"]
produce(
    lambda: propensity(
        params,
        *angles,
        distributions=settings["robustness.distributions"],
        samples=settings["robustness.samples"],
        spring_correlation=settings["robustness.spring_correlation"],
        t_end=settings["robustness.horizon"] * params.time_unit,
        workers=snakemake.threads,
    ),
    config=settings,
    key=snakemake.params.key,
    output=snakemake.output[0],
)
