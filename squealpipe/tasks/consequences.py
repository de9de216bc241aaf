"""Statements of the paper that did not enter the inference, judged at inferred parameters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome
from squealpipe.tasks.ensemble import run_ensemble
from squealpipe.tasks.linear import natural_frequencies, quasi_static_map, stability_map

POINTS = 61
"""Angles an axis of the linear maps: multiples of π/60, which hold π/2."""
RUNS = 21
"""Angles an axis of the maps of runs."""
HORIZON = 200.0
"""Horizon of the runs, in units of √(m/k1)."""

CONSEQUENCES: dict[str, str] = {
    "S3": "eigenvalues merge somewhere on the angle map",
    "F6b": "no unstable cell has a positive reaction force",
    "F6b_printed": "no unstable cell fulfils Eq. (11) as printed",
    "F7a": "A1 separates in more than half of the angle map",
    "F7_black": "no unstable cell keeps contact: the black region of Fig. 7 is empty",
    "F8c": "in contact, ω1 is largest on α1 + α2 = nπ/2, n odd",
    "F8c_separated": "separated, ω1 is largest on α1 + α2 = nπ/2, n odd",
}
"""Key (the id in the claims table, where one check settles the statement) → what is checked."""


def judge_consequences(
    fields: Mapping[str, np.ndarray], *, tol: float, workers: int | None = None
) -> dict[str, np.ndarray]:
    """Whether each consequence holds at each parameter set.

    Args:
        fields: names of ``Parameters`` → 1-D arrays of one length.
        tol: tolerance of the integrator.
        workers: processes, as in ``run_ensemble``.

    Returns:
        Key of ``CONSEQUENCES`` → booleans of that length.
    """
    names = list(fields)
    sets = [
        Parameters(**dict(zip(names, map(float, values), strict=True)))
        for values in zip(*fields.values(), strict=True)
    ]
    verdicts = [_linear(params) for params in sets]
    separates = _separates(fields, tol, workers) if sets else np.zeros((0, RUNS, RUNS), bool)
    angles = np.linspace(0.0, np.pi, RUNS)
    for params, verdict, lost in zip(sets, verdicts, separates, strict=True):
        unstable = stability_map(params, angles, angles).regime_linear.values > 0
        verdict["F7a"] = lost.mean() > 0.5
        verdict["F7_black"] = not (unstable & ~lost).any()
    return {key: np.array([verdict[key] for verdict in verdicts], bool) for key in CONSEQUENCES}


def _linear(params: Parameters) -> dict[str, bool]:
    angles = np.linspace(0.0, np.pi, POINTS)
    regime = stability_map(params, angles, angles).regime_linear.values
    sliding = quasi_static_map(params, angles, angles)
    frequencies = natural_frequencies(params, angles, angles)
    first = frequencies.omega.sel(mode=1)
    real = frequencies.outcome.sel(mode=1) == Outcome.converged
    number = np.arange(POINTS)
    on_lines = (number[:, None] + number[None, :]) % (POINTS - 1) == (POINTS - 1) // 2
    largest = {}
    for state in ("contact", "separated"):
        omega = first.where(real).sel(contact_state=state).values
        largest[state] = bool(np.nanmax(omega[on_lines]) >= np.nanmax(omega) * (1 - 1e-12))
    return {
        "S3": bool((regime == 1).any()),
        "F6b": not ((regime > 0) & sliding.possible.values).any(),
        "F6b_printed": not ((regime > 0) & sliding.possible_as_printed.values).any(),
        "F8c": largest["contact"],
        "F8c_separated": largest["separated"],
    }


def _separates(fields: Mapping[str, np.ndarray], tol: float, workers: int | None) -> np.ndarray:
    """Whether A1 loses contact from rest, over (parameter set, alpha1, alpha2)."""
    columns = {name: np.asarray(values)[:, None, None] for name, values in fields.items()}
    angles = np.linspace(0.0, np.pi, RUNS)
    run = run_ensemble(
        columns,
        angles[:, None],
        angles[None, :],
        t_end=HORIZON * np.sqrt(columns["mass"] / columns["k1"]),
        stop_at_first_separation=True,
        tol=tol,
        workers=workers,
    )
    return np.asarray(run.outcome == Outcome.separated)
