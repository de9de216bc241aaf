"""Backbones of the paper's scenes and of coupled ones, exact and by harmonic balance."""

from squealpipe.brake.backbones.backbone import backbone, named_scenes
from squealpipe.study.job import Job

job = Job(snakemake)
settings, params = job.settings, job.params
limits = {
    "y_peak_max": settings["backbones.y_peak_max"] * params.preload,
    "x_amplitude_max": settings["backbones.x_amplitude_max"] * params.preload,
}
methods = {
    "": {"method": "exact"},
    "_hbm": {"method": "hbm", "n_harmonics": settings["backbones.n_harmonics"]},
}
for name, angles in named_scenes(settings["backbones.coupled"]).items():
    for mode in (1, 2):
        for ending, options in methods.items():
            job.make(
                lambda: backbone(params, *angles, mode=mode, **limits, **options),
                job.out[f"{name}_mode{mode}{ending}"],
                scene=name,
                mode=mode,
                **options,
            )
