"""Cycles of the impact oscillator of one forcing period, from above its resonance to below."""

from squealpipe.study.job import Job
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator

job = Job(snakemake)
job.make(
    lambda: impact_oscillator.cycle_branch(
        "omega", 0.55, start=impact_oscillator.limit_cycle(omega=2.0)
    )
)
