"""Check the assumptions of each model level along the motion that it computes itself.

Idea: A2 and A3 drop terms that are small only if the motion is; each level's own motion is
therefore measured: its lowest contact force, its speed beside the belt's, the turn of its springs.
Extremes between samples are those of a parabola through three of them. Source: Table 1 of the
paper.
"""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from squealpipe.brake.dynamics.linear_response import response_from_rest
from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.models import a2
from squealpipe.brake.models.a4 import contact_matrix
from squealpipe.brake.models.refusals import refuse_extensions
from squealpipe.brake.schema.dynamics.assumptions import (
    assumptions_schema,
    linear_pull_schema,
)
from squealpipe.brake.schema.dynamics.extremes import extremes, largest_size
from squealpipe.laws import springs
from squealpipe.laws.contact import contact_force
from squealpipe.parameters import SCENES, Parameters, Scene
from squealpipe.schema import Outcome, build
from squealpipe.validation import Angles, Positive, checked
from squealpipe.vibration import parabola

ASSUMPTION_LEVELS = ("A1", "A1-no-separation", "A2", "A3", "A4")


ASSUMED_BY_LEVEL = {
    "A1": ("mass stays off the pivots",),
    "A1-no-separation": ("contact is kept", "mass stays off the pivots"),
    "A2": (
        "contact is kept",
        "belt is faster",
        "angles are constant",
        "springs are linear",
    ),
    "A3": (
        "contact is kept",
        "belt is faster",
        "angles are constant",
        "springs are linear",
    ),
    "A4": ("belt is faster", "angles are constant", "springs are linear"),
}


class LevelMotion(NamedTuple):
    """The motion that a level computes: its path, and extremes that lie between the path's samples.

    Attributes:
        x, y: the path, (time,), m; empty where the level has no motion.
        largest_x, largest_y: of |x| and of y, m.
        max_displacement: largest √(x² + y²), m.
        max_vx: largest ẋ, m/s.
        lowest_force: smallest contact force, N.
    """

    x: np.ndarray
    y: np.ndarray
    outcome: int
    largest_x: float = np.nan
    largest_y: float = np.nan
    max_displacement: float = np.nan
    max_vx: float = np.nan
    lowest_force: float = np.nan


def check_assumptions(params: Parameters, scenes: Iterable[Scene] = ()) -> xr.Dataset:
    """Table 1 of the paper, extended: which assumptions held, by level and scene."""
    chosen = tuple(scenes) or tuple(SCENES.values())
    # assumption → limit of its measure: lowest contact force over the preload, smallest 1 − ẋ/V,
    # largest turn of a spring (rad), largest error of the linear spring force relative to the
    # largest spring force, smallest length of a spring over its free length
    limit_of = {
        "contact is kept": 0.0,
        "belt is faster": 0.0,
        "angles are constant": 0.1,
        "springs are linear": 0.1,
        "mass stays off the pivots": 0.1,
    }
    names = list(limit_of)
    measures = np.full((len(ASSUMPTION_LEVELS), len(chosen), len(names)), np.nan)
    outcomes = np.zeros(measures.shape[:2], dtype=int)
    sizes = {
        name: np.full(measures.shape[:2], np.nan)
        for name in ("largest_x", "largest_y", "max_displacement")
    }
    for row, level in enumerate(ASSUMPTION_LEVELS):
        for column, scene in enumerate(chosen):
            motion = _motion(params, scene, level)
            outcomes[row, column] = motion.outcome
            if not motion.x.size:
                continue
            measures[row, column] = _measures(params, scene, motion)
            for name, values in sizes.items():
                values[row, column] = getattr(motion, name)
    limits = np.array([limit_of[name] for name in names])
    # these hold while their measure is below the limit; the others, above it
    below = np.array(
        [name in ("angles are constant", "springs are linear") for name in names]
    )
    return build(
        assumptions_schema,
        {
            "needed": [
                [name in ASSUMED_BY_LEVEL[level] for name in names]
                for level in ASSUMPTION_LEVELS
            ],
            "measure": measures,
            "limit": limits,
            "held": np.where(below, measures <= limits, measures > limits),
            **sizes,
            "t_end": [scene.t_end * params.time_unit for scene in chosen],
            "outcome": outcomes,
        },
        {
            "level": list(ASSUMPTION_LEVELS),
            "scene": [scene.name for scene in chosen],
            "assumption": names,
        },
    )


@checked
def linear_pull_map(
    params: Parameters, alpha1: Angles, alpha2: Angles, *, t_end: Positive | None = None
) -> xr.Dataset:
    """Map how far the linear model (Eqs. 6, 7) lets the contact spring pull, started at rest.

    Args:
        t_end: end of the motion, s; 50 √(m/k1) by default.
    """
    refuse_extensions(params, "linear_pull_map", "Eqs. (6), (7) have neither")
    t_end = 50.0 * params.time_unit if t_end is None else t_end
    stiffness = springs.linear_stiffness(
        params, springs.geometry(alpha1[:, None], alpha2[None, :])
    )
    step, steps = _steps(params, t_end)
    lowest = np.full(stiffness.k11.shape, np.inf)
    pulling = np.zeros(lowest.shape)
    before, last = np.full((2, *lowest.shape), np.nan)
    for state in _linear_response(params, stiffness, step, steps):
        force = 1.0 - state[..., 1] / params.preload
        # the lowest force lies between samples, at the vertex of the parabola through three
        turned = np.nonzero((last < before) & (last <= force))
        _, vertex = parabola.vertex(before[turned], last[turned], force[turned])
        np.minimum(lowest, force, out=lowest)
        lowest[turned] = np.minimum(lowest[turned], vertex)
        pulling += force < 0
        before, last = last, force
    return build(
        linear_pull_schema,
        {
            "lowest_contact_force": lowest,
            "pulling_fraction": pulling / (steps + 1),
            "t_end": t_end,
            "outcome": np.where(pulling, Outcome.separated, Outcome.converged),
        },
        {"alpha1": alpha1, "alpha2": alpha2},
    )


def _motion(params: Parameters, scene: Scene, level: str) -> LevelMotion:
    """The motion from rest that a level computes; empty where it has none."""
    t_end = scene.t_end * params.time_unit
    if level == "A2":
        return _sliding_state(params, scene)
    if level == "A3":
        return _linear_motion(params, scene, t_end)
    run = simulate(params, scene.alpha1, scene.alpha2, t_end=t_end, model=level)
    reached = np.isfinite(run.x.values)
    x, y = (run[name].values[reached] for name in ("x", "y"))
    if not x.size:
        return LevelMotion(x, y, int(run.outcome))
    lowest, _ = extremes(run, "normalized_contact_force")
    return LevelMotion(
        x,
        y,
        int(run.outcome),
        largest_x=np.nanmax(largest_size(run, "x")),
        largest_y=np.nanmax(extremes(run, "y")[1]),
        max_displacement=float(run.max_displacement),
        max_vx=np.nanmax(extremes(run, "vx")[1]),
        lowest_force=np.nanmin(lowest) * params.k3 * params.preload,
    )


def _sliding_state(params: Parameters, scene: Scene) -> LevelMotion:
    """A2: one state, at y = 0, with the friction of its reaction force."""
    stiffness = springs.linear_stiffness(
        params, springs.geometry(scene.alpha1, scene.alpha2)
    )
    reaction = float(a2.reaction_force(stiffness, params.drag, a2.actuation(params)))
    if np.isnan(reaction) or stiffness.k11 == 0:
        nothing = np.array([])
        return LevelMotion(nothing, nothing, Outcome.singular_static_state)
    x = params.drag * reaction / float(stiffness.k11)
    return LevelMotion(
        np.array([x]),
        np.zeros(1),
        Outcome.converged,
        largest_x=abs(x),
        largest_y=0.0,
        max_displacement=abs(x),
        max_vx=0.0,
        lowest_force=reaction,
    )


def _linear_motion(params: Parameters, scene: Scene, t_end: float) -> LevelMotion:
    """A3 in time: Eqs. (6) and (7) from rest; velocities by central differences."""
    stiffness = springs.linear_stiffness(
        params, springs.geometry(scene.alpha1, scene.alpha2)
    )
    step, steps = _steps(params, t_end)
    states = np.array(list(_linear_response(params, stiffness, step, steps)))
    x, y = states[:, 0], states[:, 1]
    largest_y = _largest(y)
    return LevelMotion(
        x,
        y,
        Outcome.converged,
        largest_x=_largest(np.abs(x)),
        largest_y=largest_y,
        max_displacement=_largest(np.hypot(x, y)),
        max_vx=_largest(np.gradient(x, step)),
        lowest_force=float(contact_force(largest_y, params)),
    )


def _linear_response(
    params: Parameters, stiffness: springs.Stiffness, step: float, steps: int
) -> Any:
    a11, a12, a21, a22 = contact_matrix(stiffness, params.k3, params.drag)
    matrix = (
        np.stack([np.stack([a11, a12], -1), np.stack([a21, a22], -1)], -2) / params.mass
    )
    actuation = a2.actuation(params) / params.mass
    load = np.broadcast_to([params.drag * actuation, actuation], matrix.shape[:-1])
    return response_from_rest(matrix, load, step, steps)


def _steps(params: Parameters, t_end: float) -> tuple[float, int]:
    """Step length and number of steps up to t_end, short enough for the stiffest spring."""
    stiffest = max(1.0, (params.k2 + params.k3) / params.k1)
    # twenty samples for each radian of the stiffest spring
    steps = int(np.ceil(20 * np.sqrt(stiffest) * t_end / params.time_unit))
    return t_end / steps, steps


def _measures(params: Parameters, scene: Scene, motion: LevelMotion) -> list[float]:
    """The number that decides about each assumption, in the order of the limits."""
    g = springs.geometry(scene.alpha1, scene.alpha2)
    x1, y1, x2, y2 = springs.fixed_ends(params, g)
    exact = np.stack(springs.elastic_force(motion.x, motion.y, params, g))
    linear = np.stack(
        springs.linear_elastic_force(
            motion.x, motion.y, springs.linear_stiffness(params, g)
        )
    )
    largest = _largest(np.hypot(*exact))
    turns, lengths = [], []
    for x_fixed, y_fixed, length in (
        (x1, y1, params.length1),
        (x2, y2, params.length2),
    ):
        turn = np.arctan2(motion.y - y_fixed, motion.x - x_fixed) - np.arctan2(
            -y_fixed, -x_fixed
        )
        turns.append(_largest(np.abs(np.angle(np.exp(1j * turn)))))
        squared = springs.squared_distance(motion.x, motion.y, x_fixed, y_fixed)
        lengths.append(-_largest(-np.sqrt(squared)) / length)
    belt = params.belt_speed
    return [
        motion.lowest_force / (params.k3 * params.preload),
        1.0 - motion.max_vx / belt if belt else -np.inf,
        max(turns),
        _largest(np.hypot(*(linear - exact))) / largest if largest > 0 else 0.0,
        min(lengths),
    ]


def _largest(values: np.ndarray) -> float:
    """Return the largest of samples along a path, between them if there are several."""
    few = values.size < 3  # no parabola
    return float(values.max() if few else parabola.largest(values))
