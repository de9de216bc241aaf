"""Statements on the nonlinear frequency responses (Figs. 10–13)."""

import numpy as np
import xarray as xr

from squealpipe.paper.claims.evidence import Finding, finding
from squealpipe.paper.claims.statement import Check, StatementRows
from squealpipe.paper.schema.inference import WordsInNumbers
from squealpipe.schema import Outcome
from squealpipe.study.evidence import Evidence, MissingDataError

rows = StatementRows("7", "fig10_to_12")


def branch(run: Evidence, scene: str, mode: int) -> xr.Dataset:
    """The points of an exact backbone that are orbits."""
    dataset = run[f"backbone/{scene}_mode{mode}"]
    points = dataset.isel(
        point=np.isin(
            dataset.outcome,
            (
                Outcome.converged,
                Outcome.linear_mode,
                Outcome.isolated_mode,
                Outcome.grazing,
            ),
        )
    )
    if not points.sizes["point"]:
        raise MissingDataError(f"the backbone of {scene}, mode {mode}, has no orbit")
    return points


@rows.add("F10", "(π/2, π): near ω1 one peak, in x alone; near ω2 peaks in x and y")
def first_mode_is_isolated(run: Evidence) -> Finding:
    """y amplitude of mode 1, as a share of its x amplitude."""
    alone, both = (_participation(branch(run, "F10", mode)) for mode in (1, 2))
    x, y = (amplitude / run.parameters.preload for amplitude in both)
    omega1, omega2 = (linear_omega(branch(run, "F10", mode)) for mode in (1, 2))
    return finding(
        (alone[1] / alone[0], "≤", WordsInNumbers.alone),
        f"Near ω1 = {omega1:.4g} rad/s the y amplitude is {alone[1] / alone[0]:.1g} of that of x; "
        f"near ω2 = {omega2:.4g} rad/s the amplitude of x reaches {x:.3g} l_pre and that of y "
        f"{y:.3g} l_pre.",
        also=both[0] > 0.01 * both[1] > 0,
    )


def same_as_first(scene: str) -> Check:
    """F11, F12: frequencies and x amplitudes against those of (π/2, π), at equal y_peak."""

    def check(run: Evidence) -> Finding:
        """Largest relative difference of ω from (π/2, π) at equal y."""
        reference, other = branch(run, "F10", 2), branch(run, scene, 2)
        linear = linear_omega(reference)
        difference = _largest_difference(reference, other, "omega") / linear
        amplitude = (
            _largest_difference(reference, other, "x_amplitude")
            / run.parameters.preload
        )
        first = abs(
            linear_omega(branch(run, scene, 1)) / linear_omega(branch(run, "F10", 1))
            - 1
        )
        # no one would see a difference of 1 % in the paper's figures
        return finding(
            (max(difference, first), "≤", 0.01),
            f"Against (0.5π, π), ω1 differs by {first:.2g} of itself, ω2 along the branch by at "
            f"most {difference:.2g} and the x amplitude by at most {amplitude:.2g} l_pre.",
        )

    return check


for name, angles in (("F11", "(π, π/2)"), ("F12", "(3π/4, 3π/4)")):
    rows.add(name, f"{angles}: nearly the same response")(same_as_first(name))


def bends_down(scene: str) -> Check:
    """F10b, F11b, F12b: y passes l_pre and the frequency then falls."""

    def check(run: Evidence) -> Finding:
        """Relative drop of ω along the branch."""
        points = branch(run, scene, 2)
        preload = run.parameters.preload
        reached = float(points.y_peak.max() / preload)
        linear = linear_omega(points)
        drop = 1 - float(points.omega[int(points.y_peak.values.argmax())]) / linear
        below = points.omega.where(points.y_peak < preload)
        flat = float(abs(below / linear - 1).max())
        # a drop of the frequency by 1 % is visible in the paper's figures
        return finding(
            (drop, ">", 0.01),
            f"While y stays below l_pre, ω is {linear:.4g} rad/s (to {flat:.1g} of itself); where "
            "y reaches its "
            f"largest value, {reached:.3g} l_pre, it is lower by {100 * drop:.3g} %.",
            also=reached > 1,
        )

    return check


for name, text in (
    ("F10", "y crosses l_pre and the peak then bends to lower frequency (Fig. 10)"),
    ("F11", "the same in Fig. 11"),
    ("F12", "the same in Fig. 12"),
):
    rows.add(f"{name}b", text)(bends_down(name))


@rows.add(
    "F13",
    "at (5π/6, 5π/6) the modes are switched: contact is lost at the first, the "
    "isolated x motion is the second",
    figure="fig13",
)
def modes_are_switched(run: Evidence) -> Finding:
    """y amplitude of mode 2, as a share of its x amplitude."""
    first, second = branch(run, "F13", 1), branch(run, "F13", 2)
    x_amplitude, y_amplitude = _participation(second)
    reached = float(first.y_peak.max() / run.parameters.preload)
    return finding(
        (y_amplitude / x_amplitude, "≤", WordsInNumbers.alone),
        f"Mode 1 (ω = {linear_omega(first):.4g} rad/s) reaches y = {reached:.3g} l_pre; in mode 2 "
        f"(ω = {linear_omega(second):.4g} rad/s) the y amplitude is "
        f"{y_amplitude / x_amplitude:.1g} of that of x.",
        also=reached > 1,
    )


def linear_omega(points: xr.Dataset) -> float:
    """ω at the start of a branch, rad/s."""
    return float(points.omega[0])


def _participation(points: xr.Dataset) -> tuple[float, float]:
    return float(points.x_amplitude.max()), float(points.y_amplitude.max())


def _largest_difference(reference: xr.Dataset, other: xr.Dataset, name: str) -> float:
    """Largest difference at equal y_peak over the range that both branches reach."""
    top = min(float(reference.y_peak.max()), float(other.y_peak.max()))
    peaks = np.linspace(float(reference.y_peak[0]), top, 50)
    curves = [
        np.interp(peaks, points.y_peak, points[name]) for points in (reference, other)
    ]
    return float(np.max(np.abs(curves[1] - curves[0])))
