"""What the scenes of a study do, which model is enough for them, and what changes them."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.laws.friction_laws import COULOMB, FALLING
from squealpipe.models.refusals import extensions
from squealpipe.parameters import Parameters
from squealpipe.schema import build, meanings
from squealpipe.schema.ladder import QUESTIONS, Level
from squealpipe.schema.origin import recorded
from squealpipe.schema.own import NUMBERS, OWN_SCENES
from squealpipe.tasks.basins.basin import basin_map
from squealpipe.tasks.dynamics.runs import simulate
from squealpipe.tasks.dynamics.summary import PEAKS, summarize
from squealpipe.tasks.ladder.choice import choose_model

DAMPING = (0.02, 0.1)
"""Dashpots of the variants, over √(k m) of their spring."""
STATIC = 1.5
"""Static over sliding friction of the falling law."""
PUSH = 0.5
"""Further velocity along y of the pushed start, over l_pre √(k1/m)."""


def variants(
    params: Parameters, start: tuple[float, ...]
) -> dict[str, tuple[Parameters, Any]]:
    """What is changed → parameters and start."""
    unit = [np.sqrt(stiffness * params.mass) for stiffness in (params.k1, params.k2)]
    speed = params.preload / params.time_unit
    if params.friction_law == COULOMB:
        law = "friction falls with speed"
        static = max(STATIC * params.mu, params.static_mu)
        changed = params.with_(
            friction_law=FALLING[0], mu_static=static, friction_speed=speed
        )
    else:
        law = "friction as at belt speed, constant"
        given = {"mu": abs(params.drag), "mu_static": None, "friction_speed": 1.0}
        changed = params.with_(friction_law=COULOMB, **given)
    x, y, vx, vy = start
    return {
        "as configured": (params, start),
        **{
            f"dashpots of {100 * share:g} % of √(k m)": (
                params.with_(damping1=share * unit[0], damping2=share * unit[1]),
                start,
            )
            for share in DAMPING
        },
        law: (changed, start),
        "pushed off the belt": (params, (x, y, vx, vy + PUSH * speed)),
    }


@recorded(model="A1", method="Taylor series with located events")
def own_scenes(
    params: Parameters, scenes: Mapping[str, Mapping[str, Any]], *, tol: float = 1e-12
) -> xr.Dataset:
    """Runs of A1 in each scene, as configured and with one thing changed.

    Args:
        scenes: name → ``alpha1``, ``alpha2`` (rad), ``start`` (``x``, ``y``, ``vx``, ``vy``; m
            and m/s) and ``t_end`` (√(m/k1)).
    """
    rows = [_scene(params, scene, tol) for scene in scenes.values()]
    columns = {name: np.stack([row[name] for row in rows]) for name in rows[0]}
    return build(
        OWN_SCENES,
        columns,
        {
            "scene": list(scenes),
            "variant": list(variants(params, (0.0, 0.0, 0.0, 0.0))),
            "question": list(QUESTIONS),
            "peak": np.arange(1, PEAKS + 1),
        },
    )


def start_of(scene: Mapping[str, Any]) -> tuple[float, float, float, float]:
    """x, y, vx, vy of a scene of the configuration."""
    x, y, vx, vy = (float(scene["start"][name]) for name in ("x", "y", "vx", "vy"))
    return x, y, vx, vy


def _scene(params: Parameters, scene: Mapping[str, Any], tol: float) -> dict[str, Any]:
    angles, start = (scene["alpha1"], scene["alpha2"]), start_of(scene)
    t_end = scene["t_end"] * params.time_unit
    runs = [
        _run(changed, angles, begin, t_end, tol)
        for changed, begin in variants(params, start).values()
    ]
    return {
        **{name: np.array([run[name] for run in runs]) for name in runs[0]},
        "model": np.array(
            [_level(params, angles, start, name, t_end) for name in QUESTIONS]
        ),
        "alpha1": angles[0],
        "alpha2": angles[1],
        "t_end": t_end,
    }


def _run(
    params: Parameters,
    angles: tuple[float, float],
    start: tuple[float, ...],
    t_end: float,
    tol: float,
) -> dict[str, Any]:
    run = simulate(params, *angles, t_end=t_end, tol=tol, initial_state=start)
    summary = summarize(run)
    kind = basin_map(
        params,
        *angles,
        **dict(zip(("x", "y", "vx", "vy"), start, strict=True)),
        t_end=t_end,
        tol=tol,
        workers=1,
    )
    peaks = summary.dominant_frequency.values
    return {
        **{name: float(summary[name]) for name in NUMBERS},
        "motion": meanings(kind.motion)[int(kind.motion)].replace("_", " "),
        "predictability_horizon": float(kind.predictability_horizon),
        "dominant_frequency": np.pad(
            peaks, (0, PEAKS - peaks.size), constant_values=np.nan
        ),
        "outcome": int(run.outcome),
    }


def _level(
    params: Parameters,
    angles: tuple[float, float],
    start: tuple[float, ...],
    question: str,
    t_end: float,
) -> str:
    """The level that ``choose_model`` takes; A1 where it cannot be asked."""
    if any(start) or extensions(params):
        return Level.a1.label
    return Level[choose_model(params, *angles, question, t_end=t_end).model].label
