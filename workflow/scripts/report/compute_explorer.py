"""Motions from rest, spectra and backbones on a grid of spring angles."""

import numpy as np

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.dynamics.explorer import explorer_data

part = snakemake.params.part
options = dict(part["explorer"])
angles = np.linspace(0.0, np.pi, options.pop("points"))
produce(
    lambda: explorer_data(for_linear(parameters_of(part), part["read_as"]), angles, **options),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
)
