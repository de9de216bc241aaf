"""Cycles of the impact oscillator of one forcing period, from above its resonance to below."""

from squealpipe.store import produce
from squealpipe.systems.impact_oscillator import impact_oscillator


produce(
    lambda: impact_oscillator.cycle_branch(
        "omega", 0.55, start=impact_oscillator.limit_cycle(omega=2.0)
    ),
    config={}, key=snakemake.params.key, output=snakemake.output[0],
)
