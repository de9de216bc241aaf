"""The paper's own form of harmonic balance, mended and as printed, beside exact orbits."""

from squealpipe.brake.backbones.backbone import contact_losing_branches, with_orbits
from squealpipe.brake.backbones.harmonic_forms import compare_harmonic_forms
from squealpipe.study.job import Job

job = Job(snakemake)
settings, params = job.settings, job.params
branches, left_out = with_orbits(
    params, contact_losing_branches(settings["backbones.coupled"]), [2.0]
)
job.make(
    lambda: compare_harmonic_forms(params, branches).assign_attrs(left_out=left_out)
)
