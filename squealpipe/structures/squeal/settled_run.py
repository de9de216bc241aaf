"""Run a structure on along one of its attractors, at equal steps, for films and sounds."""

from __future__ import annotations  # help shows Natural, not its checks

import math
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.structures.meshes.datasets import mesh_variables
from squealpipe.structures.motion_system import regime_codes
from squealpipe.structures.reduction import reduced_again
from squealpipe.structures.schema.squealing import NO_ATTRACTOR, Kind
from squealpipe.structures.schema.structure_run import structure_run_schema
from squealpipe.validation import Natural, Tolerance


@recorded(
    model="structure with exact contact and friction",
    method="Taylor series with located events",
)
def squealing_run(
    structure: Any,
    answer: xr.Dataset,
    *,
    attractor: int | None = None,
    periods: Natural = 500,
    tol: Tolerance = 1e-12,
) -> xr.Dataset:
    """Run a structure on where :func:`squealpipe.squealing_modes` has found that it settles.

    Args:
        structure: that which was asked, or the one that it was reduced to.
        answer: dataset ``squealing_modes`` of it.
        attractor: number of the motion in the answer; by default the one that a small push ends
            in, or where nothing grows the first that moves.
        periods: of the strongest line; fewer where they would need more than 32768 instants.
        tol: tolerance of the Taylor integrator.

    Returns:
        Dataset ``structure_run`` over ``time``, at equal steps: coordinates of the structure as it
        was run, ``mode_shape`` that makes displacements of them, normal force, velocity and regime
        of each contact.

    Raises:
        ValueError: the structure does not vibrate in the answer, or has no such motion.
        RuntimeError: the run could not be finished.
    """
    chosen = _chosen(answer, attractor)
    reduced = _as_it_was_run(structure, answer)
    motion = answer.isel(attractor=chosen)
    size, frequency = reduced.size, float(motion.dominant_frequency)
    fastest = max(float(answer.pole_frequency.max()), frequency)
    # a period of the fastest mode keeps 8 samples, one of the motion 32, as films need
    each_period = max(8.0 * fastest / frequency, 32.0)
    step = 1.0 / (each_period * frequency)
    # with 32 modes and 16 contacts a file of 30 MB
    count = min(math.ceil(periods * each_period * (1.0 - 1e-12)), 2**15)
    times = step * np.arange(count + 1)
    start = {
        f"{name}{place + 1}": float(values[place])
        for name, values in (("q", motion.displacement), ("v", motion.velocity))
        for place in range(size)
    }
    start |= {
        f"{contact.name}_stretch": float(motion.stretch[place])
        for place, contact in enumerate(reduced.contacts)
        if contact.tangential_stiffness is not None
    }
    system = reduced.system()
    run = system.simulate(float(times[-1]), times=times, start=start, tol=tol)
    if int(run.outcome) != Outcome.converged:
        raise RuntimeError(
            f"the run ended at {float(run.end_time):.4g} s of {times[-1]:.4g} s; give fewer periods"
        )
    q, v = (
        np.stack([run[f"{name}{place + 1}"].values for place in range(size)], axis=1)
        for name in ("q", "v")
    )
    contacts = [contact.name for contact in reduced.contacts]
    codes = regime_codes(system, contacts, reduced.speeds * reduced.belt_speed)
    forces = [run[f"{name}_normal_force"].values for name in contacts]
    return _dataset(
        reduced,
        (q, v),
        np.stack(forces, axis=1),
        # a single component has no dimension of its own
        codes[run.regime.values].reshape(-1, len(contacts)),
        times,
        attractor=chosen,
        dominant_frequency=frequency,
        outcome=Outcome.converged,
    )


def resting_run(structure: Any) -> xr.Dataset:
    """Return a dataset ``structure_run`` of no instants, of a structure whose motion dies out."""
    nothing = np.empty((0, structure.size))
    forces = np.empty((0, len(structure.contacts)))
    return _dataset(
        structure,
        (nothing, nothing),
        forces,
        forces,
        np.empty(0),
        attractor=NO_ATTRACTOR,
        dominant_frequency=np.nan,
        outcome=Outcome.not_computed,
    )


def _dataset(
    structure: Any,
    states: tuple[np.ndarray, np.ndarray],
    forces: np.ndarray,
    regimes: np.ndarray,
    times: np.ndarray,
    **scalars: Any,
) -> xr.Dataset:
    """Return a motion with what its structure is."""
    q, v = states
    shapes = np.eye(structure.size) if structure.modes is None else structure.modes
    of_mesh, mesh_coordinates = mesh_variables(structure)
    ways = ("along", structure.tangentials), ("across", structure.normals)
    return build(
        structure_run_schema,
        {
            "displacement": q,
            "velocity": v,
            "mode_shape": shapes,
            **{
                f"contact_{name}_{way}": values @ directions
                for name, values in (("displacement", q), ("velocity", v))
                for way, directions in ways
            },
            "normal_force": forces,
            "regime": regimes,
            "preload": structure.preloads,
            **scalars,
            **of_mesh,
        },
        {
            "time": times,
            "contact": [contact.name for contact in structure.contacts],
            **mesh_coordinates,
        },
    )


def moving_attractors(answer: xr.Dataset) -> np.ndarray:
    """Return the numbers of the attractors that vibrate."""
    moves = answer.kind.values != Kind.steady_sliding
    return np.flatnonzero(moves & np.isfinite(answer.dominant_frequency.values))


def _chosen(answer: xr.Dataset, attractor: int | None) -> int:
    """Return the number of the motion that is asked for, or of the one that matters."""
    moving = moving_attractors(answer)
    if not moving.size:
        raise ValueError(
            "nothing is to be seen or heard: no motion of the structure lasts; raise mu, or see "
            "the answer for why"
        )
    if attractor is None:
        ends = answer.ends_in.values[:1]
        pushed = int(ends[0]) if ends.size else NO_ATTRACTOR
        return pushed if pushed in moving else int(moving[0])
    if attractor not in moving:
        raise ValueError(
            f"attractor = {attractor!r}: the motions that last have numbers "
            f"{', '.join(map(str, moving))}"
        )
    return attractor


def _as_it_was_run(structure: Any, answer: xr.Dataset) -> Any:
    """Return the structure in as many modes as the answer was computed in."""
    number = int(answer.n_modes)
    if structure.size == number:
        return structure
    limit = float(answer.frequency_max)
    return reduced_again(
        structure,
        number,
        int(answer.static_responses),
        limit if math.isfinite(limit) else None,
    )
