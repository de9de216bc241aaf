"""Backbones of the paper's scenes and of coupled ones, exact and by harmonic balance."""

from squealpipe.parameters import parameters_of
from squealpipe.reading import for_linear
from squealpipe.store import produce
from squealpipe.tasks.backbones.backbone import backbone, named_scenes

part = snakemake.params.part
params = for_linear(parameters_of(part), part["read_as"])
limits = {
    "y_peak_max": part["backbones.y_peak_max"] * params.preload,
    "x_amplitude_max": part["backbones.x_amplitude_max"] * params.preload,
}
methods = {
    "": {"method": "exact"},
    "_hbm": {"method": "hbm", "n_harmonics": part["backbones.n_harmonics"]},
}
for name, angles in named_scenes(part["backbones.coupled"]).items():
    for mode in (1, 2):
        for ending, options in methods.items():
            produce(
                lambda: backbone(params, *angles, mode=mode, **limits, **options),
                config={**part, "scene": name, "mode": mode, **options}, key=snakemake.params.key,
                output=snakemake.output[f"{name}_mode{mode}{ending}"],
            )
