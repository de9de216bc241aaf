"""The smallest disturbance of steady sliding that leads to contact loss, or to the whirl."""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
import xarray as xr
from annotated_types import Ge

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.a1.jobs import Model
from squealpipe.brake.assess.sliding import Design, Sliding, SlidingSearch
from squealpipe.brake.basins.smallest_vector import (
    IMPROVED,
    SearchResult,
    search,
    smallest_linear,
)
from squealpipe.brake.dynamics.motion import linear_time, whirls
from squealpipe.brake.linear.maps import stability_map
from squealpipe.brake.models.variants import VARIANT_RULES
from squealpipe.brake.schema.basins import LeadsTo, smallest_disturbance_schema
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, blank, build
from squealpipe.schema.origin import recorded
from squealpipe.validation import (
    Angle,
    Positive,
    Seed,
    Tolerance,
    Whole,
    Workers,
    one_of,
)


@recorded(method="random directions, bisection, local search")
def smallest_disturbance(
    params: Parameters,
    alpha1: Angle,
    alpha2: Angle,
    *,
    leads_to: Annotated[str, one_of(LeadsTo.__members__)] = "contact_lost",
    model: Model = "A1",
    t_end: Positive | None = None,
    bound: Positive | None = None,
    directions: Annotated[Whole, Ge(8)] = 128,
    seed: Seed = 1,
    tol: Tolerance = 1e-9,
    workers: Workers = None,
) -> xr.Dataset:
    """Find the smallest disturbance of steady sliding that leads to contact loss, or to the whirl.

    A disturbance (x, y, ẋ, ẏ) has the norm √((x² + y²)/l_pre² + (ẋ² + ẏ²)/(l_pre ω)²) with
    ω² = (k1 + k2)/(2m). The smallest one that was found is an upper bound on the smallest there is:
    random directions are tried at 16 radii up to the bound, bisected, and the best four improved.
    How the minimum falls with the number of directions is reported, and so is the largest share of
    directions that can have a smaller one (95 %, order statistics).

    Args:
        alpha1, alpha2: angles, rad.
        leads_to: "contact_lost" (a start out of contact counts) or "whirl" (three turns or more
            around both fixed ends, counted by half turns, so that 2½ may do).
        model: "A1" or one of its variants that can lose contact; "A1-linear-springs" and "A4" have
            no whirl.
        t_end: time within which it is to happen, s; default 200 √(2m/(k1 + k2)).
        bound: largest disturbance tried, in the norm above; default 3 for contact loss, 15 for
            the whirl.

    Returns:
        Dataset ``smallest_disturbance``; its ``linear_distance`` is in closed form,
        ``rest_distance`` that of a start at rest at r = 0. Outcomes: converged, not_reached (by
        none within the bound), already_unstable (any disturbance grows: none is looked for),
        no_sliding_state.
    """
    _check_goal(leads_to, model)
    time = linear_time(params)
    # default horizon, in units of √(2m/(k1 + k2))
    horizon = 200.0 * time if t_end is None else t_end
    goal = LeadsTo[leads_to]
    # default largest disturbance, in the norm of this function
    largest = (
        {LeadsTo.contact_lost: 3.0, LeadsTo.whirl: 15.0}[goal]
        if bound is None
        else bound
    )
    sliding = Sliding.of(Design(params, alpha1, alpha2, model))
    numbers = np.unique(
        np.append(2 ** np.arange(3, directions.bit_length()), directions)
    )
    nothing: dict[str, Any] = {
        **blank(
            smallest_disturbance_schema, directions=numbers.size, improved=IMPROVED
        ),
        "leads_to": goal,
        "regime_linear": stability_map(params, [alpha1], [alpha2]).regime_linear.item(),
        "alpha1": alpha1,
        "alpha2": alpha2,
        "t_end": horizon,
        "bound": largest,
    }
    coordinates = {"directions": numbers, "improved": np.arange(1, IMPROVED + 1)}

    def result(outcome: Outcome, **found: Any) -> xr.Dataset:
        return build(
            smallest_disturbance_schema,
            {**nothing, **found, "outcome": outcome},
            coordinates,
        )

    if sliding is None:
        return result(Outcome.no_sliding_state)
    scale = params.preload * np.array([1.0, 1.0, 1.0 / time, 1.0 / time])
    rest, jacobian = sliding.state, sliding.jacobian
    values = np.linalg.eigvals(jacobian)
    growth = float(values.real.max())
    known = {
        "x_rest": rest[0],
        "y_rest": rest[1],
        "growth_rate": growth,
        "rest_distance": float(np.linalg.norm(rest / scale)),
    }
    if growth > SlidingSearch.grows * float(np.abs(values).max()):
        return result(Outcome.already_unstable, **known)
    if goal == LeadsTo.contact_lost:
        known["linear_distance"] = smallest_linear(
            jacobian * (scale / scale[:, None]),
            np.eye(4)[1],
            (params.preload - rest[1]) / params.preload,
            horizon,
        )
    unfinished = 0

    def happens(vectors: np.ndarray) -> np.ndarray:
        nonlocal unfinished
        run = run_ensemble(
            params,
            alpha1,
            alpha2,
            t_end=horizon,
            model=model,
            tol=tol,
            workers=workers,
            initial_state=rest + scale * vectors,
            stop_at_first_separation=goal == LeadsTo.contact_lost,
            tracked=(),
        )
        finished = np.isin(run.outcome, (Outcome.converged, Outcome.separated))
        unfinished += int(np.sum(~finished))
        if goal == LeadsTo.contact_lost:
            return np.asarray(np.isfinite(run.first_separation_time))
        return whirls(run)

    found = search(happens, 4, largest, directions, np.random.default_rng(seed))
    known |= _described(found, numbers, scale)
    reached = int(np.isfinite(found.radius).sum())
    outcome = Outcome.converged if reached else Outcome.not_reached
    return result(outcome, **known, reached=reached, unfinished=unfinished)


def _described(
    found: SearchResult, numbers: np.ndarray, scale: np.ndarray
) -> dict[str, Any]:
    """The variables of a search."""
    lowest = np.minimum.accumulate(found.radius)[numbers - 1]
    move = scale * found.vector
    # with 95 % confidence
    return {
        "distance": float(np.linalg.norm(found.vector)),
        **{
            f"{name}_disturbance": move[i]
            for i, name in enumerate(("x", "y", "vx", "vy"))
        },
        "distance_by_number": np.where(np.isfinite(lowest), lowest, np.nan),
        "improved_distance": np.where(
            np.isfinite(found.improved), found.improved, np.nan
        ),
        "share_below": 1.0 - (1.0 - 0.95) ** (1.0 / found.radius.size),
    }


def _check_goal(leads_to: str, model: str) -> None:
    rules = VARIANT_RULES[model]
    if not rules.separates:
        raise ValueError(f"model = {model!r} never loses contact; use 'A1'")
    if not rules.drags:
        raise ValueError(
            f"model = {model!r} has no steady sliding along the belt; use 'A1'"
        )
    if leads_to == LeadsTo.whirl.name and rules.linear_springs:
        raise ValueError(
            f"model = {model!r} has no whirl, for its springs do not turn; use 'A1', or "
            "leads_to = 'contact_lost'"
        )
