"""Statements of the abstract and of Table 1: levels, hammering, earlier models, coupled modes."""

from squealpipe.codes import Event, LinearRegime
from squealpipe.paper.claims.checks.motions import events, scene
from squealpipe.paper.claims.evidence import Finding, finding
from squealpipe.paper.claims.maps import share
from squealpipe.paper.claims.statement import StatementRows
from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.paper.schema.inference import WordsInNumbers
from squealpipe.study.evidence import Evidence

rows = StatementRows("abstract", "fig02")


@rows.add(
    "T1",
    "four model levels, each with its assumptions, which hold along the motions that it computes",
    section="Table 1",
    figure="",
    recorded=ClaimVerdict.fails,
)
def levels_have_assumptions(run: Evidence) -> Finding:
    """Smallest share of scenes, over the levels, in which all of a level's assumptions held."""
    levels = ("A1", "A2", "A3", "A4")
    table = run["assumptions"].sel(level=list(levels))
    broken = ((table.needed == 1) & (table.held == 0)).any("assumption")
    scenes = table.sizes["scene"]
    whole = {level: scenes - int(broken.sel(level=level).sum()) for level in levels}
    counts = ", ".join(f"{level} {number}" for level, number in whole.items())
    turned = table.sel(assumption="angles are constant", level="A4")
    return finding(
        (min(whole.values()) / scenes, "≥", 1.0),
        f"Of {scenes} scenes, the own assumptions of a level held along the motion it computes in: "
        f"{counts}. In A4, which takes the angles as constant to {float(turned.limit):g} rad, a "
        f"spring turns by {float(turned.measure.min()):.2g} to {float(turned.measure.max()):.2g} "
        "rad.",
    )


@rows.add(
    "S1",
    "the pad loses contact and excites the disc with impulsive forces (hammering)",
    section="abstract, 3",
)
def hammering_occurs(run: Evidence) -> Finding:
    """Largest contact force after the first return to the belt at (0.83π, 0.83π), over the load
    from which the motion starts.
    """
    motion = scene(run, "F2d")
    returns = events(motion, Event.contact).size
    force = float(motion.return_peak_contact_force) if returns else 0.0
    speed = (
        float(motion.impact_speed) * run.parameters.time_unit / run.parameters.preload
    )
    hammering = run["hammering_map"]
    strikes = (hammering.impact_rate > 0).values
    forces = hammering.return_peak_contact_force.values[strikes]
    # preloads: from here an impact presses harder than the mass at rest
    above = 1.0 + 1e-6
    # Force after a return, in preloads, from which it is an impulse and not a touch
    impulse = 0.5
    return finding(
        (force, "≥", impulse),
        f"At (0.83π, 0.83π) the mass returns to the belt {returns} times, at up to {speed:.3g} "
        f"l_pre √(k1/m), and is pressed by up to {force:.3g} times the load k3 l_pre from which it "
        f"starts; from {impulse:g} times on a return counts as an impulse. Over all angles it "
        f"returns in {100 * strikes.mean():.3g} % of {strikes.size} cells, with a larger force "
        f"than that at the start in {int((forces > above).sum())}, "
        f"{forces.max(initial=0.0):.3g} times it at most.",
        also=returns >= 2,
    )


@rows.add(
    "S2",
    "assumptions of earlier models (permanent contact, fixed spring angles) are not valid",
    section="abstract, 4",
)
def earlier_assumptions_fail(run: Evidence) -> Finding:
    """Scenes in which A1 breaks each of the two, the smaller number."""
    motion = run["assumptions"].sel(level="A1")
    lost = motion.held.sel(assumption="contact is kept") == 0
    turn = motion.measure.sel(assumption="angles are constant")
    limit = float(motion.limit.sel(assumption="angles are constant"))
    turned = turn > limit
    return finding(
        (min(int(lost.sum()), int(turned.sum())), ">", 0),
        f"In A1 contact is lost in {int(lost.sum())} of {lost.size} scenes, and a spring turns by "
        f"more than {limit:g} rad in {int(turned.sum())}, at least by {float(turn.min()):.2g} and "
        f"at most by {float(turn.max()):.3g} rad.",
    )


@rows.add(
    "S3",
    "the linear model has coupled modes: two merge into one shape",
    figure="fig06",
    section="abstract, 6",
    consequence="S3",
)
def modes_couple(run: Evidence) -> Finding:
    """Largest modal assurance criterion of the two modes: 1 is one shape, 0 two that are
    perpendicular, as without friction. That some cell flutters is a further condition.
    """
    stability = run["stability_map"]
    flutter = stability.regime_linear == LinearRegime.flutter
    similarity = stability.shape_similarity
    largest, usual = float(similarity.max()), float(similarity.median())
    return finding(
        (largest, "≥", WordsInNumbers.alike),
        f"{int(flutter.sum())} of {flutter.size} cells flutter ({100 * share(flutter):.2g} %). The "
        f"criterion reaches {largest:.3g} at most; its median over all cells is {usual:.2g}.",
        also=bool(flutter.any()),
    )
