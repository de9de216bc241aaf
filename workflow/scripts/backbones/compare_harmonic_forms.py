"""The paper's own form of harmonic balance, mended and as printed, beside exact orbits."""

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.backbones.backbone import contact_losing_branches, with_orbits
from squealpipe.tasks.backbones.harmonic_forms import compare_harmonic_forms

part = snakemake.params.part
params = for_linear(parameters_of(part), part["read_as"])
branches, left_out = with_orbits(params, contact_losing_branches(part["backbones.coupled"]), [2.0])
produce(
    lambda: compare_harmonic_forms(params, branches).assign_attrs(left_out=left_out),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
)
