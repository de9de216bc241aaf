"""Figures: one rule for each topic, from what the figures of the report declare to read.

Included after all rules that make datasets. A figure that reads a dataset which this study does
not make is left out.
"""

from squealpipe.study.figures import declared
from squealpipe.study.report.lineage import lineage
from squealpipe.paper.report.sections import PAPER_FIGURES
from squealpipe.study.report.sections import OWN as OWN_FIGURES, STRUCTURE as OF_STRUCTURE

MADE = lineage(workflow.rules, f"{RESULTS}/data/")
SHOWN_FIGURES = PAPER_FIGURES if STUDY.paper else OWN_FIGURES if STUDY.structure is None else OF_STRUCTURE
READ_BY = {name: declared.datasets_of(name, MADE) for name in SHOWN_FIGURES}
READ_BY = {name: found for name, found in READ_BY.items() if found is not None}


def figure(name):
    """PNG and SVG of a figure, which become targets."""
    paths = [f"{RESULTS}/figures/{name}.{suffix}" for suffix in ("png", "svg")]
    TARGETS.extend(paths)
    return paths


for topic in dict.fromkeys(map(declared.topic, READ_BY)):
    figures = [name for name in READ_BY if declared.topic(name) == topic]
    datasets = list(dict.fromkeys(read for name in figures for read in READ_BY[name]))  # scenes as given

    rule:
        name:
            f"draw_{topic}"
        input:
            datasets=[MADE[name]["path"] for name in datasets],
        output:
            **{name: figure(name) for name in figures},
        params:
            figures=figures,
            datasets=datasets,
            modules=[from_root(declared.find_module(name)) for name in figures],
        script:
            "../../scripts/report/draw_figures.py"
