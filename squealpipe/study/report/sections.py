"""The sections of the paper's report and of its supplement, with their figures, in order.

The workflow draws exactly these figures.
"""

from typing import NamedTuple


class Part(NamedTuple):
    """A section: its heading and its figures."""

    title: str
    figures: tuple[str, ...]


COMPARED = {
    "model": Part("The model", ("fig01",)),
    "fig02": Part("Fig. 2: contact force in four spring arrangements", ("fig02",)),
    "fig03": Part("Fig. 3: growth", ("fig03",)),
    "fig04": Part("Fig. 4: limit cycle", ("fig04",)),
    "fig05": Part("Fig. 5: springs along the belt", ("fig05",)),
    "fig06": Part("Fig. 6: quasi-static sliding and linear stability", ("fig06",)),
    "fig07": Part("Fig. 7: where the linear analysis is valid", ("fig07", "refined_boundary")),
    "fig08": Part("Figs. 8 and 9: natural frequencies", ("fig08", "fig09", "frequency_shift")),
    "fig10": Part("Figs. 10–12: three alike frequency responses", ("fig10_to_12",)),
    "fig13": Part("Fig. 13: modes switched", ("fig13",)),
}
"""The paper, figure by figure."""

BEYOND = {
    "charts": Part("How far each scene is from a boundary", ("regime_charts",)),
    "whirl": Part("Where the growth of Fig. 3 ends", ("whirl",)),
    "transient": Part("How long the motion of Fig. 4 lasts", ()),
    "orbits": Part("Periodic motions of A4", ("coupled_backbones", "a1_beside_a4")),
    "cycles": Part("Limit cycles with damping", ("cycle_branches", "cycle_path", "impact_branch")),
    "damping": Part("Critical friction with dashpots", ("critical_friction",)),
    "starts": Part("Other starts", ("basins", "disturbance")),
    "spread": Part("Uncertain parameters", ("propensity",)),
    "hammering": Part("Kinds of motion", ("hammering_map", "predictability")),
    "reach": Part("How far each verdict carries", ("verdict_reach",)),
}
"""What the paper leaves out."""

SUPPLEMENT = {
    "parameters": Part("How the parameters were inferred", ("parameter_inference",)),
    "harmonics": Part("Harmonic balance against exact orbits", ("harmonic_forms",)),
    "speed": Part(
        "Speed against accuracy", ("work_precision_benchmark", "work_precision_frequencies")
    ),
    "failures": Part("Where methods fail", ("failure_atlas",)),
    "ladder": Part("No more model than a scene needs", ("model_ladder",)),
}
"""Methods, accuracy and failures."""

FIGURES = tuple(
    name
    for parts in (COMPARED, BEYOND, SUPPLEMENT)
    for part in parts.values()
    for name in part.figures
)
"""All figures, in order."""

OWN = ("own_model", "own_motion", "own_map", "regime_charts", "propensity", "critical_friction")
"""Figures of the report of a study of one's own."""
