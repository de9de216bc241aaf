"""The sections of the paper's report and of its supplement, with their figures, in order.

The workflow draws exactly these figures.
"""

from typing import NamedTuple


class Section(NamedTuple):
    """A section: its heading and its figures."""

    title: str
    figures: tuple[str, ...]


COMPARED = {
    "model": Section("The model", ("fig01",)),
    "fig02": Section("Fig. 2: contact force in four spring arrangements", ("fig02",)),
    "fig03": Section("Fig. 3: growth", ("fig03",)),
    "fig04": Section("Fig. 4: limit cycle", ("fig04",)),
    "fig05": Section("Fig. 5: springs along the belt", ("fig05",)),
    "fig06": Section("Fig. 6: quasi-static sliding and linear stability", ("fig06",)),
    "fig07": Section(
        "Fig. 7: where the linear analysis is valid", ("fig07", "refined_boundary")
    ),
    "fig08": Section(
        "Figs. 8 and 9: natural frequencies", ("fig08", "fig09", "frequency_shift")
    ),
    "fig10": Section("Figs. 10–12: three alike frequency responses", ("fig10_to_12",)),
    "fig13": Section("Fig. 13: modes switched", ("fig13",)),
}
"""The paper, figure by figure."""

METHODS = {
    "speed": Section("Speed against accuracy", ("speed_and_accuracy",)),
    "failures": Section("Where methods fail", ("where_methods_fail",)),
    "needed": Section("No more model than a scene needs", ("model_needed",)),
}
"""What a user of the methods asks first; the evidence is in the supplement."""

BEYOND = {
    "charts": Section("How far each scene is from a boundary", ("regime_charts",)),
    "whirl": Section("Where the growth of Fig. 3 ends", ("whirl",)),
    "transient": Section("How long the motion of Fig. 4 lasts", ()),
    "orbits": Section("Periodic motions of A4", ("coupled_backbones", "a1_beside_a4")),
    "cycles": Section(
        "Limit cycles with damping", ("cycle_branches", "cycle_path", "impact_branch")
    ),
    "contacts": Section("Beyond the point contact", ("beyond_the_point",)),
    "damping": Section("Critical friction with dashpots", ("critical_friction",)),
    "basins": Section("Other starts", ("basins", "disturbance")),
    "propensity": Section("Uncertain parameters", ("propensity",)),
    "hammering": Section("Kinds of motion", ("hammering_map", "predictability")),
    "robustness": Section("How far each verdict carries", ("verdict_robustness",)),
}
"""What the paper leaves out."""

SUPPLEMENT = {
    "parameters": Section("How the parameters were inferred", ("parameter_inference",)),
    "harmonics": Section("Harmonic balance against exact orbits", ("harmonic_forms",)),
    "speed": Section(
        "Speed against accuracy",
        ("work_precision_benchmark", "work_precision_frequencies"),
    ),
    "failures": Section("Where methods fail", ("failure_atlas",)),
    "ladder": Section("No more model than a scene needs", ("model_ladder",)),
}
"""Methods, accuracy and failures."""

FIGURES = tuple(
    name
    for parts in (COMPARED, METHODS, BEYOND, SUPPLEMENT)
    for section in parts.values()
    for name in section.figures
)
"""All figures, in order."""

OWN = ("own_settled", "own_map", "own_model", "own_motion", "propensity")
"""Figures of the report of a study of one's own."""

STRUCTURE = ("what_squeals", "modes_over_friction")
"""Figures of the report of a structure."""
