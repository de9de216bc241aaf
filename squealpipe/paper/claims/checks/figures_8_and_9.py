"""Statements on the natural frequencies (Figs. 8 and 9)."""

import numpy as np
import xarray as xr

from squealpipe.paper.claims.evidence import Finding, finding
from squealpipe.paper.claims.maps import (
    AT_SCENES,
    angle_sum_over_pi,
    cell,
    is_multiple,
    place,
    share,
)
from squealpipe.paper.claims.statement import StatementRows
from squealpipe.paper.schema.claims import ClaimVerdict
from squealpipe.paper.schema.inference import WordsInNumbers
from squealpipe.schema import Outcome
from squealpipe.study.evidence import Evidence, MissingDataError

rows = StatementRows("7", "fig08")


@rows.add("F8a", "in contact ω1 → 0 near α1 = α2 = π/2")
def first_vanishes_in_contact(run: Evidence) -> Finding:
    """ω1 at (0.5π, 0.5π), as a share of its largest value."""
    contact = _state(run, "contact")
    first = contact.omega.sel(mode=1)
    middle = cell(run, "natural_frequencies", 0.5, 0.5).omega.sel(
        contact_state="contact"
    )
    relative = float(middle.sel(mode=1) / first.max())
    zeros = (first <= WordsInNumbers.vanishing * first.max()).sum()
    divergent = (contact.outcome.sel(mode=1) == Outcome.divergence).sum()
    return finding(
        (relative, "≤", WordsInNumbers.vanishing),
        f"ω1 at (0.5π, 0.5π) is {relative:.2g} of its largest value. In all, ω1 is zero in "
        f"{int(zeros)} cells, {int(divergent)} of them by divergence.",
    )


@rows.add("F8b", "separated, ω1 = 0 along α1 + α2 = nπ")
def first_vanishes_on_lines(run: Evidence) -> Finding:
    """Largest ω1 on those lines, as a share of its largest value."""
    separated = _state(run, "separated")
    first = separated.omega.sel(mode=1)
    on_line = is_multiple(angle_sum_over_pi(separated))
    largest = float(first.where(on_line).max() / first.max())
    elsewhere = float(first.where(~on_line).min() / first.max())
    return finding(
        (largest, "≤", WordsInNumbers.vanishing),
        f"On the {int(on_line.sum())} cells with α1 + α2 = nπ, ω1 is at most {largest:.2g} of its "
        f"largest value; elsewhere at least {elsewhere:.2g} of it.",
        also=elsewhere > WordsInNumbers.vanishing,
    )


@rows.add(
    "F8c",
    "ω1 is largest at α1 + α2 = nπ/2 (n odd)",
    recorded=ClaimVerdict.fails,
    consequence="F8c",
)
def first_is_largest_on_lines(run: Evidence) -> Finding:
    """Excess of the largest ω1² over that on the lines, the larger of both contact states."""
    state = run["natural_frequencies"].sel(mode=1)
    unit = run.parameters.k1 / run.parameters.mass
    # a grid with an even number of angles has no cell on the lines, the paper's scenes have
    scenes = run[f"{AT_SCENES}natural_frequencies"].sel(mode=1)
    square, of_scenes = _omega_squared(state), _omega_squared(scenes)
    over = ["alpha1", "alpha2"]
    lines = [
        each.where(is_multiple(angle_sum_over_pi(each), 0.5, odd=True)).max(over)
        for each in (square, of_scenes)
    ]
    largest, line = square.max(over), xr.concat(lines, "map").max("map")
    separated, contact = (
        float(largest.sel(contact_state=name) / line.sel(contact_state=name) - 1)
        for name in ("separated", "contact")
    )
    first, second = place(state, square.sel(contact_state="contact"))
    # rounding of the angles alone may exceed the value on the line by so much
    return finding(
        (max(separated, contact), "≤", 1e-9),
        f"Separated, the largest ω1² exceeds that on α1 + α2 = π/2 and 3π/2 by {separated:.1g} of "
        "it. In contact, flutter aside, it is "
        f"{float(largest.sel(contact_state='contact')) / unit:.4g} k1/m at "
        f"({first:.3g}π, {second:.3g}π), against "
        f"{float(line.sel(contact_state='contact')) / unit:.4g} k1/m on those lines. For even n "
        "ω1 = 0 there when separated.",
    )


@rows.add("F8d", "the region where ω1 vanishes is larger when separated", section="9")
def vanishing_region_grows(run: Evidence) -> Finding:
    """Ratio of the areas where ω1 is small, separated to contact."""
    first = run["natural_frequencies"].omega.sel(mode=1)
    return _larger_when_separated(
        first <= WordsInNumbers.small_share * first.max(["alpha1", "alpha2"]),
        f"ω1 is below {WordsInNumbers.small_share:g}",
    )


@rows.add("F9a", "where ω1 = 0, ω2 is largest", figure="fig09")
def second_is_largest_where_first_vanishes(run: Evidence) -> Finding:
    """ω2 there, as a share of its largest value."""
    separated, contact = _state(run, "separated"), _state(run, "contact")
    lines = is_multiple(angle_sum_over_pi(separated))
    second = separated.omega.sel(mode=2)
    on_lines = float(second.where(lines).min() / second.max())
    in_contact = contact.omega.sel(mode=2)
    middle = cell(run, "natural_frequencies", 0.5, 0.5).omega.sel(
        contact_state="contact"
    )
    at_centre = float(middle.sel(mode=2) / in_contact.max())
    first_angle, second_angle = place(contact, in_contact)
    return finding(
        (min(on_lines, at_centre), "≥", WordsInNumbers.near_largest),
        f"Where ω1 = 0, ω2 is {on_lines:.4g} of its largest value when separated (α1 + α2 = nπ) "
        f"and {at_centre:.4g} in contact at (0.5π, 0.5π); there the largest is at "
        f"({first_angle:.3g}π, {second_angle:.3g}π).",
    )


@rows.add("F9b", "ω1 and ω2 shift in opposite directions", figure="fig09")
def shifts_are_opposite(run: Evidence) -> Finding:
    """Share of steps between cells with opposite signs."""
    shares = {}
    unit = run.parameters.k1 / run.parameters.mass
    for name in ("contact", "separated"):
        state = _state(run, name)
        real = (state.outcome != Outcome.complex_pair) & (
            state.outcome != Outcome.divergence
        )
        omega = state.omega.where(real.all("mode"))
        steps = [omega.diff(axis) for axis in ("alpha1", "alpha2")]
        products = np.concatenate(
            [(step.sel(mode=1) * step.sel(mode=2)).values.ravel() for step in steps]
        )
        moving = np.isfinite(products) & (np.abs(products) > 1e-18 * unit)
        if not moving.any():
            raise MissingDataError(f"the natural frequencies do not vary ({name})")
        shares[name] = float((products[moving] < 0).mean())
    return finding(
        (min(shares.values()), "≥", 0.999),
        f"From cell to cell ω1 and ω2 move in opposite directions in "
        f"{100 * shares['contact']:.4g} % of the steps in contact and "
        f"{100 * shares['separated']:.4g} % when separated: ω1² + ω2² is the same at all angles.",
    )


@rows.add(
    "F9c",
    "the region where ω2 is largest is larger when separated",
    figure="fig09",
    section="9",
)
def largest_region_grows(run: Evidence) -> Finding:
    """Ratio of the areas where ω2 is near its largest value, separated to contact."""
    second = run["natural_frequencies"].omega.sel(mode=2)
    return _larger_when_separated(
        second >= WordsInNumbers.near_largest * second.max(["alpha1", "alpha2"]),
        f"ω2 is above {WordsInNumbers.near_largest:g}",
    )


def _omega_squared(state: xr.Dataset) -> xr.DataArray:
    squared: xr.DataArray = (
        state.omega.where(state.outcome == Outcome.converged).fillna(0.0) ** 2
    )
    return squared


def _larger_when_separated(cells: xr.DataArray, what: str) -> Finding:
    contact, separated = (
        share(cells.sel(contact_state=name)) for name in ("contact", "separated")
    )
    return finding(
        (separated / max(contact, 1e-12), ">", 1.0),
        f"{what} of its largest value in {100 * contact:.3g} % of the map in contact and in "
        f"{100 * separated:.3g} % when separated.",
    )


def _state(run: Evidence, name: str) -> xr.Dataset:
    return run["natural_frequencies"].sel(contact_state=name)
