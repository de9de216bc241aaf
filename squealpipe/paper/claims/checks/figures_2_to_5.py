"""Statements on the time histories of model A1 (Figs. 2–5)."""

import numpy as np

from squealpipe.brake.schema.dynamics.extremes import extremes, largest_size
from squealpipe.codes import Event
from squealpipe.paper.claims.checks.motions import (
    events,
    halves,
    repetition,
    scene,
    until,
    windows,
)
from squealpipe.paper.claims.evidence import Finding, finding
from squealpipe.paper.claims.statement import Check, StatementRows
from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.paper.schema.growth import (
    Growth,
    GrowthRule,
    judge_growth,
    least_growth,
)
from squealpipe.paper.schema.inference import WordsInNumbers
from squealpipe.study.evidence import Evidence

rows = StatementRows("4", "fig02")


def contact_is_kept(name: str) -> Check:
    """F2a–F2c: the lowest contact force of the run, and no separation event."""

    def check(run: Evidence) -> Finding:
        """Lowest contact force over the run, as a share of the preload."""
        motion = scene(run, name)
        lowest = float(extremes(motion, "normalized_contact_force")[0].min())
        lost = events(motion, Event.separation).size
        return finding(
            (lowest, ">", 0),
            f"The lowest contact force is {lowest:.4g} of the preload; {lost} separations up to "
            f"{until(run, motion)}.",
            also=lost == 0,
        )

    return check


for name, angles in (
    ("F2a", "(0.5π, π)"),
    ("F2b", "(π, 0.5π)"),
    ("F2c", "(0.75π, 0.75π)"),
):
    rows.add(name, f"contact is kept throughout at {angles}")(contact_is_kept(name))


@rows.add("F2d", "contact is lost at (0.83π, 0.83π)")
def contact_is_lost(run: Evidence) -> Finding:
    """Number of separations."""
    motion = scene(run, "F2d")
    lost = events(motion, Event.separation)
    first = ", ".join(f"{time / run.parameters.time_unit:.4g}" for time in lost[:3])
    return finding(
        (lost.size, ">", 0),
        f"{lost.size} separations up to {until(run, motion)}, first at {first}.",
    )


@rows.add("F2e", "the first three responses differ little from one another")
def responses_differ_little(run: Evidence) -> Finding:
    """Spread of the extremes of the contact force, as a share of the preload.

    The paper gives no number for "a minimal difference". It may mean little against the preload,
    or less than what sets the first three responses apart from the fourth.
    """
    forces = [
        extremes(scene(run, name), "normalized_contact_force")
        for name in ("F2a", "F2b", "F2c", "F2d")
    ]
    ends = np.array([[low.min(), high.max()] for low, high in forces])
    spread = float(np.ptp(ends[:3], axis=0).max())
    apart = float(np.abs(ends[:3] - ends[3]).max(axis=1).min())
    closer = spread < apart
    undecided = ClaimVerdict.cannot_be_decided
    return finding(
        (spread, "≤", WordsInNumbers.minimal_difference),
        f"The lowest forces are {_listed(ends[:3, 0])} of the preload, the highest "
        f"{_listed(ends[:3, 1])}: a spread of {spread:.3g}, and at least {apart:.3g} from the "
        "fourth response. The text has no number for “minimal”; "
        f"the inference took {WordsInNumbers.minimal_difference:g}.",
        passed=ClaimVerdict.holds if closer else undecided,
        otherwise=undecided if closer else ClaimVerdict.fails,
    )


@rows.add(
    "F3",
    "at (0.4π, 0.6π) the x oscillation grows without bound",
    figure="fig03",
    recorded=ClaimVerdict.holds_only_as_printed,
)
def unstable_response_grows(run: Evidence) -> Finding:
    """Least growth of the largest |x| from window to window at the end of a long run."""
    shown, longer = scene(run, "F3"), scene(run, "F3_long")
    early, late = halves(shown)
    sizes = windows(run, longer)
    growth = Growth(int(judge_growth(sizes)))
    undecided = growth is Growth.undecided
    judged = growth.name.replace("undecided", "is undecided")
    return finding(
        (float(least_growth(sizes)), "≥", GrowthRule.least_ratio),
        f"In windows of {GrowthRule.window:g} √(m/k1) of a run to {until(run, longer)}, "
        "|x| reaches "
        f"{_listed(sizes, digits=5)} l_pre: it {judged}. In the time of the paper's figure it "
        f"reaches {early:.3g} l_pre in the first half of the run to {until(run, shown)} and "
        f"{late:.3g} l_pre in the second.",
        otherwise=ClaimVerdict.cannot_be_decided if undecided else ClaimVerdict.fails,
    )


@rows.add(
    "F4",
    "at (0.2π, 0.8π) there is a bounded limit cycle",
    figure="fig04",
    recorded=ClaimVerdict.fails,
)
def limit_cycle_is_bounded(run: Evidence) -> Finding:
    """Largest change of the state between returns to the belt in a long run, as a share of its
    range, for the number of returns apart for which it is least; that |x| is bounded is a
    further condition.
    """
    motion = scene(run, "F4")
    early, late = halves(motion)
    longest = max(run.parameters.length1, run.parameters.length2)
    largest = float(largest_size(motion, "x").max() / longest)
    longer = scene(run, "F4_long")
    later = float(largest_size(longer, "x").max() / longest)
    bounded = (
        max(largest, later) < WordsInNumbers.bounded_within
        and late < WordsInNumbers.growth_threshold * early
    )
    evidence = (
        f"|x| reaches {largest:.3g} of the longer free length up to {until(run, motion)} "
        f"({early:.3g} l_pre in the first half, {late:.3g} l_pre in the second; "
        f"{WordsInNumbers.growth_threshold:g} times as far counts as growth), and {later:.3g} "
        f"of it up to "
        f"{until(run, longer)}: {'it is bounded' if bounded else 'it has no bound'}. "
    )
    change, apart, number = repetition(longer)
    # Change of the state between returns, as a share of its range, up to which a motion repeats
    repeats = 1e-3
    evidence += (
        f"Of its {number} returns to the belt those {apart} apart are most alike, and there x or a "
        f"velocity differs by up to {100 * change:.2g} % of its range"
        f"{'' if change <= repeats else ': it is no limit cycle'}."
    )
    if "growth" in motion:
        evidence += (
            f" A small change of the start has grown {float(motion.growth):.2g} times by "
            f"{until(run, motion)}."
        )
    # it is of a reading with one sign, not of the equations as printed
    if (
        "transient" in run
        and float(run["transient"].belt_speed) == run.parameters.belt_speed
    ):
        transient = run["transient"]
        ended = int(np.isfinite(transient.lifetime.values).sum())
        evidence += (
            f" Of {transient.lifetime.size} runs from starts at most a billionth of l_pre apart "
            f"{ended} end in the whirl before "
            f"t = {float(transient.t_end) / run.parameters.time_unit:g} √(m/k1)."
        )
    return finding((change, "≤", repeats), evidence, also=bounded)


@rows.add("F5a", "(π, π) and (0, 0) give identical contact forces", figure="fig05")
def runs_are_identical(run: Evidence) -> Finding:
    """Largest difference of the contact forces, as a share of the preload."""
    first, second = (
        scene(run, name).normalized_contact_force for name in ("F5a", "F5b")
    )
    difference = float(np.abs(first.values - second.values).max())
    return finding(
        (difference, "≤", WordsInNumbers.same_force),
        f"The contact forces differ by at most {difference:.1g} of the preload.",
    )


@rows.add(
    "F5b",
    "there the mass jumps again and again, for lack of vertical stiffness",
    figure="fig05",
)
def mass_jumps(run: Evidence) -> Finding:
    """Number of flights."""
    motion = scene(run, "F5a")
    flights = events(motion, Event.separation).size
    height = float(extremes(motion, "y")[1].max() / run.parameters.preload)
    return finding(
        (flights, "≥", WordsInNumbers.again_and_again),
        f"{flights} flights up to {until(run, motion)}, up to y = {height:.3g} l_pre; "
        "the springs lie along x and have no vertical stiffness to first order.",
    )


def _listed(values: np.ndarray, digits: int = 3) -> str:
    return ", ".join(f"{value:.{digits}g}" for value in values)
