"""Model A1 started on periodic motions of A4."""

from squealpipe.brake.backbones.a1_beside_a4 import a1_beside_a4
from squealpipe.brake.backbones.backbone import contact_losing_branches, with_orbits
from squealpipe.study.job import Job

PEAK = 2.0

job = Job(snakemake)
settings = job.settings
found = contact_losing_branches(settings["backbones.coupled"])
chosen = {
    name: found[name] for name in found if not name.endswith("mode 2") or "F10" in name
}
branches, left_out = with_orbits(job.params, chosen, [PEAK])
job.make(
    lambda: a1_beside_a4(
        job.params,
        branches,
        peak=PEAK,
        length_ratios=settings["backbones.length_ratios"],
    ).assign_attrs(left_out=left_out)
)
