"""Statements on the nonlinear frequency responses (Figs. 10–13)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from squealpipe.claims.evidence import Finding, MissingDataError, Run, finding
from squealpipe.schema import Outcome

ALONE = 1e-9
"""Amplitude, as a share of the other one's, below which a direction takes no part."""

NEARLY_THE_SAME = 0.01
"""Relative difference of frequencies that no one would see in the paper's figures."""

BENDS = 0.01
"""Relative drop of the frequency that is visible in the paper's figures."""

USABLE = (Outcome.converged, Outcome.linear_mode, Outcome.isolated_mode, Outcome.grazing)


def branch(run: Run, scene: str, mode: int) -> xr.Dataset:
    """The points of an exact backbone that are orbits."""
    dataset = run[f"backbone/{scene}_mode{mode}"]
    points = dataset.isel(point=np.isin(dataset.outcome, USABLE))
    if not points.sizes["point"]:
        raise MissingDataError(f"the backbone of {scene}, mode {mode}, has no orbit")
    return points


def isolated_first_mode(scene: str) -> Callable[[Run], Finding]:
    """F10: mode 1 moves x alone, mode 2 both."""

    def check(run: Run) -> Finding:
        alone, both = (_participation(branch(run, scene, mode)) for mode in (1, 2))
        omega1, omega2 = (_linear_omega(branch(run, scene, mode)) for mode in (1, 2))
        return finding(
            alone[1] / alone[0],
            "≤",
            ALONE,
            f"Near ω1 = {omega1:.4g} the y amplitude is {alone[1] / alone[0]:.1g} of that of x; "
            f"near ω2 = {omega2:.4g} x reaches {both[0]:.3g} and y {both[1]:.3g}.",
            also=both[0] > 0.01 * both[1] > 0,
        )

    return check


def same_as_first(scene: str) -> Callable[[Run], Finding]:
    """F11, F12: frequencies and x amplitudes against those of (π/2, π), at equal y_peak."""

    def check(run: Run) -> Finding:
        reference, other = branch(run, "F10", 2), branch(run, scene, 2)
        linear = _linear_omega(reference)
        difference = _largest_difference(reference, other, "omega") / linear
        amplitude = _largest_difference(reference, other, "x_amplitude") / run.parameters.preload
        first = abs(_linear_omega(branch(run, scene, 1)) / _linear_omega(branch(run, "F10", 1)) - 1)
        return finding(
            max(difference, first),
            "≤",
            NEARLY_THE_SAME,
            f"Against (0.5π, π), ω1 differs by {first:.1g}, ω2 along the branch by at most "
            f"{difference:.1g} and the x amplitude by at most {amplitude:.1g} l_pre.",
        )

    return check


def bends_down(scene: str, mode: int = 2) -> Callable[[Run], Finding]:
    """F10b, F11b, F12b: y passes l_pre and the frequency then falls."""

    def check(run: Run) -> Finding:
        points = branch(run, scene, mode)
        preload = run.parameters.preload
        reached = float(points.y_peak.max() / preload)
        linear = _linear_omega(points)
        drop = 1 - float(points.omega[int(points.y_peak.values.argmax())]) / linear
        below = points.omega.where(points.y_peak < preload)
        flat = float(abs(below / linear - 1).max())
        return finding(
            drop,
            ">",
            BENDS,
            f"ω stays at {linear:.4g} (to {flat:.1g}) until y reaches l_pre, and is "
            f"{100 * drop:.3g} % lower at y = {reached:.3g} l_pre.",
            also=reached > 1,
        )

    return check


def modes_are_switched(run: Run) -> Finding:
    """F13: mode 1 loses contact, mode 2 is x alone."""
    first, second = branch(run, "F13", 1), branch(run, "F13", 2)
    x_amplitude, y_amplitude = _participation(second)
    reached = float(first.y_peak.max() / run.parameters.preload)
    return finding(
        y_amplitude / x_amplitude,
        "≤",
        ALONE,
        f"Mode 1 (ω = {_linear_omega(first):.4g}) reaches y = {reached:.3g} l_pre and so loses "
        f"contact; in mode 2 (ω = {_linear_omega(second):.4g}) the y amplitude is "
        f"{y_amplitude / x_amplitude:.1g} of that of x.",
        also=reached > 1,
    )


def modes_switch_at_separation(run: Run) -> Finding:
    """C1: whether the mode that loses contact changes its place in the order of frequencies."""
    kept, lines = 0, []
    for scene, contact_mode in (("F10", 2), ("F11", 2), ("F12", 2), ("F13", 1)):
        moving = branch(run, scene, contact_mode)
        isolated = _linear_omega(branch(run, scene, 3 - contact_mode))
        side = np.sign(moving.omega - isolated)
        crossings = int((side != side[0]).sum())
        kept += crossings == 0
        lines.append(
            f"{scene}: {float(moving.omega.min()):.4g} to {float(moving.omega.max()):.4g} "
            f"against {isolated:.4g}"
        )
    return finding(
        4 - kept,
        ">",
        0,
        "The mode that loses contact stays on its side of the isolated x mode on all backbones "
        f"({'; '.join(lines)}). What differs between Figs. 12 and 13 is set by the angles, "
        "K11 against K22 + k3, before contact is lost.",
    )


def _linear_omega(points: xr.Dataset) -> float:
    return float(points.omega[0])


def _participation(points: xr.Dataset) -> tuple[float, float]:
    return float(points.x_amplitude.max()), float(points.y_amplitude.max())


def _largest_difference(reference: xr.Dataset, other: xr.Dataset, name: str) -> float:
    """Largest difference at equal y_peak over the range that both branches reach."""
    top = min(float(reference.y_peak.max()), float(other.y_peak.max()))
    peaks = np.linspace(float(reference.y_peak[0]), top, 50)
    curves = [np.interp(peaks, points.y_peak, points[name]) for points in (reference, other)]
    return float(np.max(np.abs(curves[1] - curves[0])))
