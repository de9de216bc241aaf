"""Charts of regimes: over both angles, and over κ and μ at the angles of each scene.

In the paper's study they have the onset of the whirl and of its stick too, of A1 with the dashpots
of the branches of cycles: the whirl of Fig. 3, found from rest, leads to those at other angles.
"""

from pathlib import Path
from typing import Any

import numpy as np
from squealpipe.brake.curves.chart import regime_chart
from squealpipe.brake.cycles.branch import cycle_branch
from squealpipe.brake.cycles.curve import cycle_curve
from squealpipe.brake.cycles.cycle import limit_cycle
from squealpipe.parameters import SCENES
from squealpipe.schema import Outcome
from squealpipe.study.job import Job
from squealpipe.systems.branch_labels import Label

COARSE = 31
SMALLEST, LARGEST = 0.002, 2.0  # of κ and μ over those of the study
INSIDE = 0.01  # of the range: branches along its ends are followed so far from them
NO_STICK = 1e-9  # share of the period in a cycle that only begins to stick
STATE = ("x_start", "y_start", "vx_start", "vy_start")

job = Job(snakemake)
settings, params = job.settings, job.params
files = {Path(path).stem: path for path in job.out.friction}
angles = {name: list(job.angles(name).values()) for name in files}
alpha1, alpha2 = np.array(list(angles.values())).T
ranges = [
    np.linspace(min(0.0, *each), max(np.pi, *each), COARSE) for each in (alpha1, alpha2)
]
kappa, mu = (
    np.linspace(SMALLEST, LARGEST, COARSE) * (value or 1.0)
    for value in (params.kappa, params.mu)
)
options = {
    "t_end": settings["dynamics.chart_horizon"] * params.time_unit,
    "tol": settings["dynamics.tol"],
    "workers": snakemake.threads,
}
damping = settings.get("cycles.damping", 0.0) * (params.k1 * params.mass) ** 0.5
damped = params.with_(damping1=damping, damping2=damping)


def onsets(at, branches, limits):
    """The curves of folds and of beginning stick through the special points of branches."""
    found: dict[str, tuple[str, list]] = {
        "whirl": ("fold", []),
        "stick": ("stick_onset", []),
    }
    for branch in branches:
        for label, curves in found.values():
            for point in np.flatnonzero(
                (branch.label == Label[label]) & (branch.stick_fraction < NO_STICK)
            ):
                start = branch.isel(point=point)
                curves.append(
                    cycle_curve(
                        damped,
                        *at,
                        label=label,
                        parameters=[*limits],
                        start=start,
                        to=limits,
                    )
                )
    return {name: curves for name, (_, curves) in found.items()}


def around_friction(at, state):
    """Return where the whirl is born and its stick begins, over κ and μ at two angles."""
    cycle = limit_cycle(damped, *at, guess=state)
    if cycle.outcome != Outcome.converged:
        return {}
    branch = cycle_branch(damped, *at, parameter="mu", to=mu[0], start=cycle)
    limits = {
        "mu": (mu[0], mu[-1]),
        "k3": (kappa[0] * params.k1, kappa[-1] * params.k1),
    }
    return onsets(at, [branch], limits)


def around_angles(at, state):
    """Return the same onsets over both angles, from the sides of their square."""
    found: dict[str, list] = {"whirl": [], "stick": []}
    limits = {
        f"alpha{i}": (each[0], each[-1]) for i, each in enumerate(ranges, start=1)
    }
    low, high = limits["alpha1"]
    inner = INSIDE * (high - low)
    for side in (low + inner, high - inner):
        across = cycle_branch(damped, *at, parameter="alpha1", to=side, start=state)
        if across.end != Outcome.converged:
            return {}
        state_there = [float(across[name][-1]) for name in STATE]
        branches = [
            cycle_branch(
                damped, side, at[1], parameter="alpha2", to=end, start=state_there
            )
            for end in limits["alpha2"]
        ]
        for name, curves in onsets((side, at[1]), branches, limits).items():
            found[name] += curves
    return found


over_angles: dict[str, Any] = {}
state = None
if damping:
    whirl_at = SCENES["F3"].alpha1, SCENES["F3"].alpha2
    first = limit_cycle(
        damped, *whirl_at, t_settle=settings["cycles.settle"] * params.time_unit
    )
    if first.outcome == Outcome.converged:
        state = [float(first[name]) for name in STATE]
        over_angles = around_angles(whirl_at, state)
job.make(
    lambda: regime_chart(
        params,
        *ranges,
        design={"alpha1": alpha1, "alpha2": alpha2},
        **over_angles,
        **options,
    ),
    job.out.angles,
)
for name, path in files.items():
    at = angles[name]
    job.make(
        lambda: regime_chart(
            params,
            *at,
            kappa=kappa,
            mu=mu,
            **(around_friction(at, state) if state else {}),
            **options,
        ),
        path,
        scene=name,
    )
