"""The answer for one structure: verdict, cause, frequency, level, and what stops it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.structures.assess.cures import cures_of
from squealpipe.structures.assess.designs import Design, Structures, pushed, start_at
from squealpipe.structures.assess.records import levels
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.squeal.windows import Running
from squealpipe.validation import Natural, Seed, Tolerance, Workers
from squealpipe.vibration.any_start import any_start, dies_out_always, lead, sides_of
from squealpipe.vibration.boundaries import (
    Cure,
    interval_table,
    linear_intervals,
    nearest_boundary,
    quiet_intervals,
)
from squealpipe.vibration.schema import ASSESS, DIRECTIONS
from squealpipe.vibration.settling import FOR_NUMBERS


@dataclass(frozen=True)
class JudgedStructure:
    """Verdict on a structure and its motions, before the search for what stops it.

    Attributes:
        verdict: what the push ends in.
        motions: states of the whole structure in other motions that last.
        facts: variables of the dataset that are known already.
        family: how designs of it are run in the search.
        modifications: as they were named.
    """

    design: Design
    verdict: Verdict
    motions: list[np.ndarray]
    facts: dict[str, Any]
    family: Structures
    modifications: Mapping[str, Any]

    def without_cures(self) -> xr.Dataset:
        """Return the answer so far: verdict, cause, frequency and level."""
        return self._answer({}, {}, {}, {})

    def with_cures(self) -> xr.Dataset:
        """Return the whole answer; the search takes most of its time."""
        cures, units = cures_of(self.design, self.modifications)
        quiet = self.verdict is Verdict.quiet
        linear = {
            name: linear_intervals(cure, lambda design: design.margin)
            for name, cure in cures.items()
        }
        dies_out = partial(_dies_out, family=self.family)
        intervals = quiet_intervals(cures, linear, dies_out, quiet=quiet)
        nearest = {
            name: nearest_boundary(intervals[name], cure.value, quiet=quiet)
            for name, cure in cures.items()
        }
        sides = sides_of(cures)
        for side in sides:
            side.motions = list(self.motions)
        if not quiet:
            lead(sides, nearest, self.family)
        anywhere = any_start(
            cures,
            sides,
            nearest,
            quiet,
            quiet and not self.motions,
            self.family,
            partial(dies_out_always, subjects=self.family),
            partial(dies_out_always, subjects=self.family, kinds=1),
        )
        return self._answer(
            cures, units, intervals, {"quiet": nearest, "any": anywhere}
        )

    def _answer(
        self,
        cures: Mapping[str, Cure],
        units: Mapping[str, str],
        intervals: Mapping[str, Any],
        found: Mapping[str, Mapping[str, float]],
    ) -> xr.Dataset:
        nearest, anywhere = found.get("quiet", {}), found.get("any", {})
        changes = {name: _change(cure, nearest[name]) for name, cure in cures.items()}
        order = sorted(
            cures,
            key=lambda name: (
                math.inf if math.isnan(changes[name]) else abs(changes[name])
            ),
        )
        tried = {name: cures[name].grid for name in order}

        def table(values: list[float]) -> np.ndarray:
            return np.array(values, float)

        safe = [anywhere.get(name, math.nan) for name in order]
        plant = self.design.plant
        assert plant is not None  # noqa: S101 (without sliding there is no verdict)
        return build(
            ASSESS,
            {
                **self.facts,
                "value": table([cures[name].value for name in order]),
                "quiet_from": table([nearest[name] for name in order]),
                "quiet_from_any_start": table(safe),
                "change": table([changes[name] for name in order]),
                "change_any_start": table(
                    [
                        _change(cures[name], value)
                        for name, value in zip(order, safe, strict=True)
                    ]
                ),
                "lowest_tried": table([float(tried[name].min()) for name in order]),
                "highest_tried": table([float(tried[name].max()) for name in order]),
                **interval_table([intervals[name] for name in order]),
                "unit": np.array([units[name] for name in order], str),
            },
            {
                "cure": np.array(order, str),
                "mode": np.arange(1, len(plant.frequencies) + 1),
                "contact": plant.contacts,
                "direction": list(DIRECTIONS),
            },
        )


@recorded(
    model="structure with exact contact and friction",
    method="Taylor series with located events",
)
def assess_structure(
    structure: Any,
    *,
    modifications: Mapping[str, Any] | None = None,
    samples: Natural = 16,
    seed: Seed = 0,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Return the answer for a structure; see :func:`squealpipe.assess`."""
    return judge_structure(
        structure,
        modifications=modifications,
        samples=samples,
        seed=seed,
        tol=tol,
        workers=workers,
    ).with_cures()


def judge_structure(
    structure: ContactStructure,
    *,
    modifications: Mapping[str, Any] | None = None,
    samples: int,
    seed: int,
    tol: float,
    workers: int | None = None,
) -> JudgedStructure:
    """Run a push, the sudden start and random starts of a structure until they have settled.

    Raises:
        NoSlidingError: there is no steady sliding.
        ValueError: no contact, too large, or a modification that cannot be read.
    """
    design = Design.of(structure)
    plant = design.plant
    assert plant is not None  # noqa: S101 (Design.of has raised)
    if plant.obstacle:
        raise ValueError(f"the structure cannot be run: {plant.obstacle}")
    named = dict(modifications or {})
    cures_of(design, named)  # mistakes are told before the runs
    family = Structures(tol, samples, seed, workers)
    push = pushed(design)
    sudden = start_at(design, np.zeros(2 * plant.size))
    assert push is not None and sudden is not None  # noqa: S101, PT018
    of_push, of_sudden = family.settled([push, sudden], FOR_NUMBERS)
    drawn = family.starts(design, 2, [])
    others = family.settled(drawn) if drawn else []
    how = Running(tol, seed, workers)
    scalars, pictured = levels(design, of_push, how=how)
    sudden_scalars, _ = levels(design, of_sudden, how=how)
    lasting = [run for run in (of_push, of_sudden, *others) if not run.quiet]
    verdict = of_push.verdict
    growth = plant.spectrum.values.real
    outcome = (
        Outcome.unresolved if verdict is Verdict.undetermined else Outcome.converged
    )
    facts = {
        **scalars,
        **{f"sudden_{name}": value for name, value in sudden_scalars.items()},
        **pictured,
        "mechanism": design.mechanism,
        "sliding_growth_rate": float(growth.max()),
        "mode_frequency": plant.frequencies,
        "leading_frequency": float(plant.frequencies[growth.argmax()]),
        "contact_sliding_force": plant.spectrum.state.force,
        "quiet_unless_struck": verdict is Verdict.quiet and bool(lasting),
        "random_starts": len(others),
        "random_starts_noisy": sum(run.lasts for run in others),
        "degrees_of_freedom": design.whole.size,
        "n_modes": plant.size,
        "outcome": outcome,
    }
    motions = [design.to_whole(run.last.final) for run in lasting[:2]]
    # Boundaries are located far more coarsely than this tolerance of the runs that search them
    search_tolerance = 1e-9
    searched = replace(family, tol=max(tol, search_tolerance))
    return JudgedStructure(design, verdict, motions, facts, searched, named)


def _dies_out(cures: Any, values: Any, *, family: Structures) -> list[bool]:
    """Tell whether pushed steady sliding ends quiet; where there is none it does not."""
    rows, starts = [], []
    for row, (cure, value) in enumerate(zip(cures, values, strict=True)):
        design = cure.apply(value)
        start = pushed(design) if design.margin <= 0.0 else None
        if start is not None:
            rows.append(row)
            starts.append(start)
    answers = [False] * len(cures)
    for row, run in zip(rows, family.settle(starts), strict=True):
        answers[row] = run.quiet
    return answers


def _change(cure: Cure, found: float) -> float:
    """Per cent of the present value; of nothing per cent of the largest that is tried."""
    unit = abs(cure.value) or float(cure.above.max(initial=0.0)) or 1.0
    return 100.0 * (found - cure.value) / unit
