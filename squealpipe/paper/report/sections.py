"""The sections of the paper's report and of its supplement, with their figures, in order.

The workflow draws exactly these figures.
"""

from typing import NamedTuple


class ReportSection(NamedTuple):
    """A section: its heading and its figures."""

    title: str
    figures: tuple[str, ...]


COMPARED = {
    "model": ReportSection("The model", ("fig01",)),
    "fig02": ReportSection(
        "Fig. 2: contact force in four spring arrangements", ("fig02",)
    ),
    "fig03": ReportSection("Fig. 3: growth", ("fig03",)),
    "fig04": ReportSection("Fig. 4: limit cycle", ("fig04",)),
    "fig05": ReportSection("Fig. 5: springs along the belt", ("fig05",)),
    "fig06": ReportSection(
        "Fig. 6: quasi-static sliding and linear stability", ("fig06",)
    ),
    "fig07": ReportSection(
        "Fig. 7: where the linear analysis is valid", ("fig07", "refined_boundary")
    ),
    "fig08": ReportSection(
        "Figs. 8 and 9: natural frequencies", ("fig08", "fig09", "frequency_shift")
    ),
    "fig10": ReportSection(
        "Figs. 10–12: three similar frequency responses", ("fig10_to_12",)
    ),
    "fig13": ReportSection("Fig. 13: modes switched", ("fig13",)),
}
"""The paper, figure by figure."""

METHOD_SECTIONS = {
    "speed": ReportSection("Speed against accuracy", ("speed_and_accuracy",)),
    "failures": ReportSection("Where methods fail", ("where_methods_fail",)),
    "needed": ReportSection("No more model than a scene needs", ("model_needed",)),
}
"""Questions that a user of the methods asks first; the evidence is in the supplement."""

BEYOND_THE_PAPER = {
    "charts": ReportSection(
        "How far each scene is from a boundary", ("regime_charts",)
    ),
    "whirl": ReportSection("Where the growth of Fig. 3 ends", ("whirl",)),
    "transient": ReportSection("How long the motion of Fig. 4 lasts", ()),
    "orbits": ReportSection(
        "Periodic motions of A4", ("coupled_backbones", "a1_beside_a4")
    ),
    "cycles": ReportSection(
        "Limit cycles with damping", ("cycle_branches", "cycle_path", "impact_branch")
    ),
    "contacts": ReportSection("Beyond the point contact", ("beyond_the_point",)),
    "damping": ReportSection("Critical friction with dashpots", ("critical_friction",)),
    "basins": ReportSection("Other starts", ("basins", "disturbance")),
    "propensity": ReportSection("Uncertain parameters", ("propensity",)),
    "hammering": ReportSection("Kinds of motion", ("hammering_map", "predictability")),
    "robustness": ReportSection(
        "How far each verdict carries", ("verdict_robustness",)
    ),
}
"""Questions that the paper leaves open."""

SUPPLEMENT = {
    "parameters": ReportSection(
        "How the parameters were inferred", ("parameter_inference",)
    ),
    "harmonics": ReportSection(
        "Harmonic balance against exact orbits", ("harmonic_forms",)
    ),
    "speed": ReportSection(
        "Speed against accuracy",
        ("work_precision_benchmark", "work_precision_frequencies"),
    ),
    "failures": ReportSection("Where methods fail", ("failure_atlas",)),
    "ladder": ReportSection("No more model than a scene needs", ("model_ladder",)),
}
"""Methods, accuracy and failures."""

PAPER_FIGURES = tuple(
    name
    for parts in (COMPARED, METHOD_SECTIONS, BEYOND_THE_PAPER, SUPPLEMENT)
    for section in parts.values()
    for name in section.figures
)
"""All figures, in order."""
