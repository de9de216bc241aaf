"""Harmonic balance against exact orbits over its settings; the paper's own form of it."""

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.backbones.backbone import contact_losing_branches, with_orbits
from squealpipe.tasks.backbones.harmonic_sweeps import compare_harmonic_forms, sweep_harmonic_balance

part = snakemake.params.part
params = for_linear(parameters_of(part), part["read_as"])
sweep = part["backbones.sweep"]
found = contact_losing_branches(part["backbones.coupled"])
branches, left_out = with_orbits(params, found, [2.0, *sweep["peaks"]])
produce(
    lambda: sweep_harmonic_balance(
        params, branches, n_harmonics=part["backbones.n_harmonics"], **sweep
    ).assign_attrs(left_out=left_out),
    config=part, key=snakemake.params.key,
    output=snakemake.output.sweep,
)
produce(
    lambda: compare_harmonic_forms(params, branches).assign_attrs(left_out=left_out),
    config=part, key=snakemake.params.key,
    output=snakemake.output.forms,
)
