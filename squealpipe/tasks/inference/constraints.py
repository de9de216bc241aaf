"""The paper's statements as constraints on the parameters, each with a margin.

A margin is positive where the statement holds and dimensionless. Motions are those of A1 from
rest; horizons are the scenes' ``t_end`` in units of √(m/k1).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np

from squealpipe.codes import LinearRegime
from squealpipe.laws.dashpots import linear_damping
from squealpipe.laws.springs import geometry
from squealpipe.models.a2 import ROUND_OFF
from squealpipe.models.contact_system import ContactSystem, contact_system
from squealpipe.models.damped import damped_system, is_undamped, stability
from squealpipe.parameters import SCENES, Parameters, Scene
from squealpipe.schema import Outcome
from squealpipe.schema.inference import LITTLE
from squealpipe.solvers.a1.ensemble import Ensemble, run_ensemble

GROWTH = 1.5
"""F3 and F4: |x| grows if the second half of the horizon exceeds the first by this factor.

Less than the 2 of |x| ∝ t (``schema.dynamics.runs.GROWTH_THRESHOLD``), for the whirl of Fig. 3 may
saturate before the horizon, and more than the √2 of |x| ∝ √t."""
SAMENESS = 1e-10
"""F5a: how far the two motions may differ, over k3 l_pre and over the horizon."""
JUMPS = 3
"""F5b: how many separations count as "again and again"."""


@dataclass(frozen=True)
class Candidates:
    """Parameter sets, one an entry of each array, and the motions computed for them.

    Attributes:
        fields: names of ``Parameters`` → 1-D arrays of one length.
        tol: tolerance of the integrator.
        workers: processes, as in ``run_ensemble``.
        initial_state: (x, y, ẋ, ẏ) of the runs, (4,) or one for each set, m and m/s.
    """

    fields: Mapping[str, np.ndarray]
    tol: float
    workers: int | None = None
    initial_state: Any = (0.0, 0.0, 0.0, 0.0)

    @cached_property
    def time_unit(self) -> np.ndarray:
        """√(m/k1), s."""
        return np.asarray(np.sqrt(self.fields["mass"] / self.fields["k1"]))

    def run(self, scene: Scene, model: str = "A1") -> Ensemble:
        """The motion at a scene over its horizon, with its second half as the late one."""
        t_end = scene.t_end * self.time_unit
        return run_ensemble(
            self.fields,
            scene.alpha1,
            scene.alpha2,
            t_end=t_end,
            t_late=0.5 * t_end,
            model=model,
            tol=self.tol,
            workers=self.workers,
            initial_state=self.initial_state,
        )

    @cached_property
    def contact(self) -> dict[str, Margin]:
        """Lowest N/(k3 l_pre) at the scenes of Fig. 2, negative where contact is lost.

        From the variant whose contact spring also pulls: it moves as A1 does until N = 0, and
        then tells by how much contact is lost.
        """
        runs = {
            name: self.run(SCENES[name], "A1-no-separation")
            for name in ("F2a", "F2b", "F2c", "F2d")
        }
        return {name: Margin(run.lowest_contact_force, run.outcome) for name, run in runs.items()}

    @cached_property
    def level(self) -> Ensemble:
        """The motion at (π, π), both springs along the belt."""
        return self.run(SCENES["F5a"])

    def linear(self, scene: Scene) -> ContactSystem:
        """The linear system at a scene, with the friction of the belt's direction."""
        p = SimpleNamespace(**self.fields, drag=self.drag)
        return contact_system(p, scene.alpha1, scene.alpha2)

    @cached_property
    def sets(self) -> list[Parameters]:
        """The parameter sets one by one."""
        return parameter_sets(self.fields)

    @cached_property
    def drag(self) -> np.ndarray:
        """Friction over normal force along +x, with the direction of the belt."""
        return np.array([params.drag for params in self.sets])


@dataclass(frozen=True)
class Margin:
    """By how much one statement holds, and how the runs behind that ended, both (size,)."""

    margin: np.ndarray
    outcome: np.ndarray


@dataclass(frozen=True, kw_only=True)
class Constraint:
    """One statement as a constraint on the parameters.

    Attributes:
        name: its id, as in the claims table.
        criterion: what is checked, in words, with thresholds.
        horizon: in units of √(m/k1); NaN where no motion is computed.
        check: the function that measures the margin.
    """

    name: str
    criterion: str
    horizon: float
    check: Callable[[Candidates], Margin]


def _keeps_contact(name: str) -> Callable[[Candidates], Margin]:
    return lambda candidates: candidates.contact[name]


def _loses_contact(candidates: Candidates) -> Margin:
    lowest = candidates.contact["F2d"]
    return Margin(-lowest.margin, lowest.outcome)


def _alike(candidates: Candidates) -> Margin:
    runs = [candidates.contact[name] for name in ("F2a", "F2b", "F2c")]
    lowest = np.stack([np.maximum(run.margin, 0.0) for run in runs])
    return Margin(LITTLE - np.ptp(lowest, axis=0), np.max([run.outcome for run in runs], axis=0))


def _same_levels(candidates: Candidates) -> Margin:
    first, second = candidates.level, candidates.run(SCENES["F5b"])
    force = np.abs(first.peak_contact_force - second.peak_contact_force)
    share = np.abs(first.separated_time - second.separated_time) / first.time
    difference = np.maximum(force, share)
    margin = (SAMENESS - difference) / (SAMENESS + difference)
    return Margin(margin, np.maximum(first.outcome, second.outcome))


def _jumps(candidates: Candidates) -> Margin:
    run = candidates.level
    return Margin((run.separations - (JUMPS - 0.5)) / JUMPS, run.outcome)


def _growth_and_size(candidates: Candidates, scene: Scene) -> tuple[Any, Any, np.ndarray]:
    """ln of late over early |x| and of |x| over 2L, and how the runs ended."""
    run = candidates.run(scene)
    reach = 2.0 * np.maximum(candidates.fields["length1"], candidates.fields["length2"])
    size = np.maximum(run.early_max_x, run.late_max_x) / reach
    return np.log(run.late_max_x / run.early_max_x), np.log(size), run.outcome


def _grows(candidates: Candidates) -> Margin:
    growth, size, outcome = _growth_and_size(candidates, SCENES["F3"])
    return Margin(np.minimum(growth - np.log(GROWTH), size), outcome)


def _stays_bounded(candidates: Candidates) -> Margin:
    growth, size, outcome = _growth_and_size(candidates, SCENES["F4"])
    return Margin(np.minimum(np.log(GROWTH) - growth, -size), outcome)


def _linearly_stable(candidates: Candidates) -> Margin:
    stiffness, _, invariants = candidates.linear(SCENES["F3"])
    fields = candidates.fields
    divergence = invariants.determinant * fields["mass"] ** 2 / (stiffness.k11 * fields["k3"])
    flutter = invariants.discriminant / invariants.half_trace**2
    margin = np.minimum(divergence, np.where(flutter < 0, flutter, np.inf))
    scene = np.array([SCENES["F3"].alpha1]), np.array([SCENES["F3"].alpha2])
    for i, params in enumerate(candidates.sets):
        if is_undamped(params):
            continue
        found = stability(damped_system(params, *scene))
        decay = -found.growth_rate[0] * params.time_unit
        # what decays or grows by no more than round-off is as without damping
        if found.regime[0] != LinearRegime.stable or decay > ROUND_OFF:
            margin[i] = decay
    return _closed(margin)


def _modes_switched(candidates: Candidates) -> Margin:
    fields = candidates.fields
    before = candidates.linear(SCENES["F12"]).stiffness
    after = candidates.linear(SCENES["F13"]).stiffness
    first = before.k22 + fields["k3"] - before.k11
    second = after.k11 - after.k22 - fields["k3"]
    by_springs = np.maximum(np.abs(before.k12), np.abs(after.k12))
    coupling = np.maximum(by_springs, _coupling_by_dashpots(fields))
    isolated = coupling <= ROUND_OFF * fields["k1"]
    margin = np.where(isolated, np.minimum(first, second), -coupling)
    return _closed(margin / fields["k1"])


def _coupling_by_dashpots(fields: Mapping[str, np.ndarray]) -> np.ndarray:
    """Largest |C12| √(k1/m) at the scenes of Figs. 12 and 13, N/m: as stiff as K12 at √(k1/m)."""
    p = SimpleNamespace(**{"damping1": 0.0, "damping2": 0.0, **fields})
    scenes = SCENES["F12"], SCENES["F13"]
    c12 = [linear_damping(p, geometry(scene.alpha1, scene.alpha2)).k12 for scene in scenes]
    return np.asarray(np.max(np.abs(c12), axis=0) * np.sqrt(p.k1 / p.mass))


def _closed(margin: np.ndarray) -> Margin:
    return Margin(margin, np.full(np.shape(margin), int(Outcome.converged), np.int8))


def _in_scene(
    name: str, criterion: str, check: Callable[[Candidates], Margin], scene: str = ""
) -> Constraint:
    return Constraint(
        name=name, criterion=criterion, horizon=SCENES[scene or name].t_end, check=check
    )


CONSTRAINTS: tuple[Constraint, ...] = (
    *(
        _in_scene(name, "contact is kept; margin lowest N/(k3 l_pre)", _keeps_contact(name))
        for name in ("F2a", "F2b", "F2c")
    ),
    _in_scene(
        "F2d",
        "contact is lost; margin −lowest N/(k3 l_pre) if the contact spring could pull",
        _loses_contact,
    ),
    _in_scene(
        "F2e",
        f"lowest N/(k3 l_pre) of F2a to F2c within {LITTLE}; margin {LITTLE} − spread",
        _alike,
        "F2a",
    ),
    _in_scene(
        "F3",
        f"|x| exceeds 2L and its second half is {GROWTH} times the first; "
        f"margin min(ln(|x|/2L), ln(growth/{GROWTH}))",
        _grows,
    ),
    _in_scene(
        "F4",
        f"|x| stays below 2L and its second half below {GROWTH} times the first; "
        f"margin min(ln(2L/|x|), ln({GROWTH}/growth))",
        _stays_bounded,
    ),
    _in_scene(
        "F5a",
        f"peak force and time off the belt at (π, π) and (0, 0) differ by d < {SAMENESS}; "
        f"margin ({SAMENESS} − d)/({SAMENESS} + d)",
        _same_levels,
    ),
    _in_scene(
        "F5b",
        f"at least {JUMPS} separations at (π, π); margin (separations − {JUMPS - 0.5})/{JUMPS}",
        _jumps,
        "F5a",
    ),
    Constraint(
        name="F6d",
        criterion="A3 stable at (0.4π, 0.6π): undamped, μ sgn V < cot 0.4π and no flutter; margin "
        "det/(K11 k3), or disc/(trace/2)² in flutter; damped, less the growth rate times √(m/k1)",
        horizon=np.nan,
        check=_linearly_stable,
    ),
    Constraint(
        name="F13",
        criterion="isolated x mode first at (3π/4, 3π/4) and second at (5π/6, 5π/6); margin of "
        "K11 against K22 + k3, over k1: 1 − κ at the latter; if coupled, −|K12|/k1 or, by unequal "
        "dashpots, −|C12|/√(m k1)",
        horizon=np.nan,
        check=_modes_switched,
    ),
)
"""What the paper says of its figures, where it constrains the parameters."""


def measure(candidates: Candidates) -> dict[str, Margin]:
    """Every statement's margin for every candidate."""
    return {statement.name: statement.check(candidates) for statement in CONSTRAINTS}


def parameter_sets(fields: Mapping[str, np.ndarray]) -> list[Parameters]:
    """``Parameters`` from arrays of one length, one entry each."""
    rows = zip(*(np.asarray(values).tolist() for values in fields.values()), strict=True)
    return [Parameters(**dict(zip(fields, row, strict=True))) for row in rows]


def candidate_of(params: Parameters, *, tol: float) -> Candidates:
    """One candidate from a study's parameters."""
    fields = {name: np.array([value]) for name, value in params.as_dict().items()}
    return Candidates(fields, tol, workers=1)
