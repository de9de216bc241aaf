"""Model A1 started on periodic motions of A4."""

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.backbones.a1_beside_a4 import a1_beside_a4
from squealpipe.tasks.backbones.backbone import contact_losing_branches, with_orbits

PEAK = 2.0

part = snakemake.params.part
found = contact_losing_branches(part["backbones.coupled"])
chosen = {name: found[name] for name in found if not name.endswith("mode 2") or "F10" in name}
branches, left_out = with_orbits(for_linear(parameters_of(part), part["read_as"]), chosen, [PEAK])
produce(
    lambda: a1_beside_a4(
        for_linear(parameters_of(part), part["read_as"]),
        branches,
        peak=PEAK,
        length_ratios=part["backbones.length_ratios"],
    ).assign_attrs(left_out=left_out),
    config=part, key=snakemake.params.key,
    output=snakemake.output[0],
)
