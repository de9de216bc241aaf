"""Harmonic balance against exact orbits over its settings; the paper's own form of it."""

from squealpipe.parameters import parameters_of
from squealpipe.store import produce
from squealpipe.tasks.backbones import contact_losing_branches
from squealpipe.tasks.harmonic_sweeps import compare_harmonic_forms, sweep_harmonic_balance

part = snakemake.params.part
params = parameters_of(part)
branches = contact_losing_branches(part["backbones.coupled"])
produce(
    lambda: sweep_harmonic_balance(
        params, branches, n_harmonics=part["backbones.n_harmonics"], **part["backbones.sweep"]
    ),
    config=part,
    output=snakemake.output.sweep,
)
produce(
    lambda: compare_harmonic_forms(params, branches),
    config=part,
    output=snakemake.output.forms,
)
