"""Figs. 2 to 5: model A1 in time."""

from squealpipe.figures import fig02, fig03, fig04, fig05
from squealpipe.figures.style import save_figure
from squealpipe.store import load

runs = {name: load(path) for name, path in snakemake.input.items() if name != "sources"}
save_figure(fig02.draw([runs[name] for name in ("F2a", "F2b", "F2c", "F2d")]), snakemake.output.fig02)
save_figure(fig03.draw(runs["F3"]), snakemake.output.fig03)
save_figure(fig04.draw(runs["F4"]), snakemake.output.fig04)
save_figure(fig05.draw(runs["F5a"], runs["F5b"]), snakemake.output.fig05)
