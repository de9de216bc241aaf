"""Figs. 10 to 13 and the backbones of the coupled scenes."""

from squealpipe.figures import coupled_backbones, fig10, fig11, fig12, fig13
from squealpipe.figures.style import save_figure
from squealpipe.store import load

given, part = snakemake.input, snakemake.params.part
preload = part["parameters"]["preload"]


def branches(scene):
    return [
        [load(given[f"{scene}_mode{mode}{ending}"]) for ending in ("", "_hbm")] for mode in (1, 2)
    ]


for module in (fig10, fig11, fig12, fig13):
    name = module.__name__.rsplit(".", 1)[-1]
    save_figure(module.draw(branches(name.upper()[:1] + name[3:]), preload), snakemake.output[name])
coupled = {scene: branches(scene) for scene in part["backbones.coupled"]}
save_figure(coupled_backbones.draw(coupled, preload), snakemake.output.coupled)
