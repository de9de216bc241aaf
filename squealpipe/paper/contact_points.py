"""Beyond the point contact: an elastic pad on one, two and more contact points."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.schema import Outcome, build
from squealpipe.structures.schema.contact_points import (
    MOST_FRICTION,
    contact_points_schema,
)
from squealpipe.structures.schema.squealing import NO_ATTRACTOR
from squealpipe.structures.shipped_pad import YOUNG, elastic_pad
from squealpipe.structures.squeal.plant import Plant
from squealpipe.structures.squeal.squealing_modes import squealing_of
from squealpipe.structures.squeal.windows import Running, run
from squealpipe.systems.datasets.versions import versions

SHOWN_PERIODS, EACH = 4, 48
"""Periods of the forces that are kept, and their samples in each."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """Settings of the pads' runs.

    Attributes:
        mu, modal_damping: of the pad.
        n_modes: modes kept, no fewer than contact points.
        samples: random starts.
        t_end: longest time of a run, s.
        tol: of the integrator.
    """

    mu: float = 0.5
    modal_damping: float = 0.01
    n_modes: int = 20
    samples: int = 4
    t_end: float = 0.06
    tol: float = 1e-10


def contact_points(
    points: Sequence[int], stiff_points: int, how: Run, *, workers: int | None = None
) -> xr.Dataset:
    """An elastic pad on so many contact points of equal total stiffness and preload.

    Args:
        points: contact points of each pad.
        stiff_points: of one more, which is a hundred times as stiff.

    Returns:
        Dataset ``contact_points``: over ``design`` critical friction, unstable modes and what a
        small push ends in; over ``point`` shares of time without contact, and forces over time.
    """
    pads = [(str(count), count, YOUNG) for count in points]
    # a hundred times the modulus of friction material: the pad hardly bends
    pads.append((f"{stiff_points}, stiff", stiff_points, 100.0 * YOUNG))
    most = max(count for _, count, _ in pads)
    rows = [_pad(count, young, how, most, workers) for _, count, young in pads]
    return build(
        contact_points_schema,
        {name: np.array([row[name] for row in rows]) for name in rows[0]},
        {
            "design": [name for name, _, _ in pads],
            "point": np.arange(1, most + 1),
            "instant": np.arange(SHOWN_PERIODS * EACH) / EACH,
        },
        {
            "made_by": "squealpipe.paper.contact_points",
            "model": "elastic pad with exact contact and friction",
            "method": "complex modes; Taylor series with located events",
            "tolerance": how.tol,
            "parameters": json.dumps(
                {"mu": how.mu, "modal_damping": how.modal_damping}
            ),
            "arguments": json.dumps({"samples": how.samples, "t_end": how.t_end}),
            **versions(),
        },
    )


def _pad(
    count: int, young: float, how: Run, most: int, workers: int | None
) -> dict[str, Any]:
    """One pad's values, by their names in the dataset."""
    whole = elastic_pad(
        contacts=count, young=young, mu=how.mu, modal_damping=how.modal_damping
    )
    pad: Any = whole.reduce(n_modes=max(how.n_modes, count))
    modes = pad.complex_modes(mu=np.linspace(0.0, MOST_FRICTION, 11))
    if not modes.unstable.any():
        # what only dies out needs no fast modes, whose steps are short
        # a pad that stays quiet at any friction is run in four modes
        pad = pad.reduce(n_modes=min(max(count, 4), pad.size))
    onsets = modes.critical_mu.values[np.isfinite(modes.critical_mu.values)]
    plant = Plant(pad)  # its system is traced and compiled once for both
    answer = squealing_of(
        plant, samples=how.samples, t_end=how.t_end, tol=how.tol, workers=workers
    )
    growing = answer.sizes["mode"]
    ends = answer.dominant_frequency.values
    values: dict[str, Any] = {
        "contacts": count,
        "young": young,
        "n_modes": pad.size,
        "frequency_error": float(answer.frequency_error),
        "growth_rate_error": float(answer.growth_rate_error),
        "critical_mu": onsets.min() if onsets.size else np.nan,
        "unstable": growing,
        "frequency": float(answer.frequency[0]) if growing else np.nan,
        "growth_rate": float(answer.growth_rate[0]) if growing else np.nan,
        "verdict": int(answer.verdict),
        "common_frequency": ends[answer["count"].values.argmax()]
        if ends.size
        else np.nan,
        "outcome": Outcome.unresolved
        if Verdict(int(answer.verdict)) is Verdict.undetermined
        else Outcome.converged,
    }
    places = np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])
    return values | _of_motion(plant, answer, places, most, how.tol)


def _of_motion(
    plant: Plant, answer: xr.Dataset, places: np.ndarray, most: int, tol: float
) -> dict[str, Any]:
    """Return level and contact loss, contact by contact, of the motion that a small push settles
    on.
    """
    count = len(places)

    def padded(values: np.ndarray) -> np.ndarray:
        rows = np.full((most, *values.shape[1:]), np.nan)
        rows[:count] = values
        return rows

    end = int(answer.ends_in[0]) if answer.sizes["mode"] else NO_ATTRACTOR
    moves = end != NO_ATTRACTOR and np.isfinite(float(answer.dominant_frequency[end]))
    nothing = np.full(count, np.nan)
    is_quiet = Verdict(int(answer.verdict)) is Verdict.quiet
    kept = np.zeros(count) if is_quiet else nothing
    values: dict[str, Any] = {
        "position": padded(places),
        "separated_fraction": padded(kept),
        "stick_fraction": padded(kept),
        "peak_force": padded(nothing),
        "lag": padded(nothing),
        "force": padded(np.full((count, SHOWN_PERIODS * EACH), np.nan)),
        **dict.fromkeys(("dominant_frequency", "velocity_rms", "share"), np.nan),
    }
    if not moves:
        return values
    one = answer.isel(attractor=end)
    force = _forces(plant, one, tol)
    line = np.exp(-2j * np.pi * np.arange(force.shape[1]) / EACH)
    phase = np.angle((force - force.mean(axis=1, keepdims=True)) @ line)
    delays = (phase[0] - phase) / (2.0 * np.pi) % 1.0
    moving = np.ptp(force, axis=1) > 0.0  # one that never touches has no phase
    return values | {
        **{
            name: padded(one[name].values)
            for name in ("separated_fraction", "stick_fraction", "peak_force")
        },
        **{
            name: float(one[name])
            for name in ("dominant_frequency", "velocity_rms", "share")
        },
        "lag": padded(np.where(moving & moving[0], delays, np.nan)),
        "force": padded(force[:, : SHOWN_PERIODS * EACH]),
    }


def _forces(plant: Plant, motion: xr.Dataset, tol: float) -> np.ndarray:
    """Normal forces over preloads of a settled motion, (contact, instant)."""
    pad = plant.structure
    start = np.concatenate([motion.displacement.values, motion.velocity.values])
    # delays are taken over 64 periods
    times = np.arange(64 * EACH) / (EACH * float(motion.dominant_frequency))
    samples = run(plant, start[None], times[1:], Running(tol))["samples"][0]
    states = np.concatenate([start[None], samples])[:, : pad.size]
    pressed = pad.preloads - states @ pad.normals * pad.stiffnesses
    return np.asarray(np.maximum(pressed, 0.0).T / pad.preloads[:, None])
