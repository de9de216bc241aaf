"""Complex modes of a structure as a dataset: growth, frequency and critical friction by mode."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.methods.progress import with_progress
from squealpipe.parameters import brief, is_finite_number, is_whole_number
from squealpipe.schema import Outcome, build, find
from squealpipe.schema.origin import versions
from squealpipe.schema.structures import name_over
from squealpipe.systems.structures.band import COMPLETE
from squealpipe.systems.structures.definition import Structure
from squealpipe.systems.structures.numbering import Way
from squealpipe.systems.structures.pencil import DENSE
from squealpipe.systems.structures.sliding import NoSlidingError
from squealpipe.systems.structures.spectrum import ALL, Limits, Solver, Spectrum
from squealpipe.validation import real_array

STEPS, STEPS_IF_LARGE = 9, 3
"""Frictions on the way from none to one friction."""
FLOATS = ("growth_rate", "growth_rate_error", "frequency", "damping_ratio", "residual")


def complex_modes(
    structure: Structure,
    *,
    mu: Any = None,
    belt_speed: Any = None,
    frequency_max: float | None = None,
    n_modes: int | None = None,
) -> xr.Dataset:
    """Complex modes about steady sliding.

    Args:
        mu: friction; an ascending array of it is a dimension. None: the structure's.
        belt_speed: likewise, m/s.
        frequency_max: modes up to there, Hz.
        n_modes: so many modes, by frequency. One of both is needed beyond 1000 degrees of freedom;
            with neither, all modes are computed.

    Returns:
        Dataset over (mu, belt_speed, mode), of both what is an array: ``growth_rate`` (1/s),
        ``frequency`` (Hz), ``damping_ratio``, ``unstable`` (growth above its error), ``residual``,
        ``outcome``. By mode ``critical_mu``: the smallest friction in the range given (from 0 to
        ``mu`` for one) at which growth leaves zero, NaN with the reason in ``onset``, and
        ``merges_with``. A mode is a pair of eigenvalues, or one real eigenvalue; it keeps its
        number along ``mu`` by its shape. ``normal_force`` by contact is 0 where one is open; open
        contacts are left out.

    Raises:
        ValueError: an argument; there is no steady sliding anywhere.
        RuntimeError: of a large structure, the modes in the band could not be shown to be complete.
    """
    limits = _limits(structure, frequency_max, n_modes)
    frictions = _factor("mu", structure.mu if mu is None else mu)
    speeds = _factor(
        "belt_speed", structure.belt_speed if belt_speed is None else belt_speed
    )
    if (frictions < 0).any():
        raise ValueError(f"mu = {brief(mu)}: numbers of 0 or greater are needed")
    if frictions.ndim and (np.diff(frictions) <= 0).any():
        raise ValueError(f"mu = {brief(mu)}: it must ascend")
    ways = _ways(structure, limits, frictions, speeds)
    if not any(way.steps for way in ways):
        raise NoSlidingError(ways[0].reasons[0])
    asked = np.atleast_1d(frictions).tolist()
    if not frictions.ndim and not any(asked[0] in way.steps for way in ways):
        raise NoSlidingError(ways[0].reasons[-1])
    tables = _tables(ways, asked)
    coords: dict[str, Any] = {
        "mode": np.arange(1, tables["growth_rate"][0].shape[-1] + 1),
        "mu": frictions,
        "belt_speed": speeds,
    }
    if names := [contact.name for contact in structure.contacts]:
        coords["contact"] = names
        tables["normal_force"] = _forces(ways, asked, len(names))
    scalar = not frictions.ndim, not speeds.ndim
    modes = {name: _over(arrays, *scalar) for name, arrays in tables.items()}
    dims = tuple(
        name for name, one in zip(("mu", "belt_speed"), scalar, strict=True) if not one
    )
    opened = {
        contact.name
        for contact, force in zip(
            structure.contacts,
            np.moveaxis(modes.get("normal_force", np.zeros(0)), -1, 0),
            strict=True,
        )
        if (force == 0).any()
    }
    attrs = {
        "made_by": "squealpipe.Structure.complex_modes",
        "model": "linear about steady sliding",
        "method": ALL if structure.size <= DENSE else COMPLETE,
        "tolerance": "round-off",
        "parameters": json.dumps(structure.as_dict()),
        "arguments": json.dumps({"frequency_max": frequency_max, "n_modes": n_modes}),
        "open_contacts": ", ".join(sorted(opened)) or "none",
        **versions(),
    }
    return build(find(name_over(dims)), modes, coords, attrs)


def _limits(
    structure: Structure, frequency_max: float | None, n_modes: int | None
) -> Limits:
    if frequency_max is not None and not (
        is_finite_number(frequency_max) and frequency_max > 0
    ):
        raise ValueError(
            f"frequency_max = {brief(frequency_max)}: a number greater than 0, Hz, is needed"
        )
    if n_modes is not None and not (is_whole_number(n_modes) and n_modes >= 1):
        raise ValueError(
            f"n_modes = {brief(n_modes)}: a whole number from 1 on is needed"
        )
    if structure.size > DENSE and frequency_max is None and n_modes is None:
        raise ValueError(
            f"{structure.size} degrees of freedom: give frequency_max (Hz) or n_modes; all modes "
            f"are computed up to {DENSE}"
        )
    return Limits(
        None if frequency_max is None else float(frequency_max),
        None if n_modes is None else int(n_modes),
    )


def _factor(name: str, value: Any) -> np.ndarray:
    array = real_array(name, value)
    if array.ndim > 1 or not array.size:
        raise ValueError(
            f"{name} has shape {array.shape}: a number or a 1-D array is needed"
        )
    return array


def _ways(
    structure: Structure, limits: Limits, frictions: np.ndarray, speeds: np.ndarray
) -> list[Way]:
    """Modes along friction, one belt speed after another."""
    asked = np.atleast_1d(frictions)
    if not frictions.ndim and structure.contacts and frictions > 0:
        # one friction alone: on the way to it from none, modes are followed all the same
        few = STEPS if structure.size <= DENSE else STEPS_IF_LARGE
        asked = np.linspace(0.0, float(frictions), few)
    ways: list[Way] = []
    for speed in with_progress(np.atleast_1d(speeds).tolist()):
        way = Way(Solver(structure, limits, speed))
        way.follow(asked.tolist(), ways[-1] if ways else None)
        ways.append(way)
    return ways


def _tables(ways: list[Way], frictions: list[float]) -> dict[str, list[np.ndarray]]:
    """Each variable over (friction, mode), or over mode, for each way."""
    numbers = _numbers(ways, frictions)
    place_of = {number: place for place, number in enumerate(numbers)}
    tables: dict[str, list[np.ndarray]] = {}
    for way in ways:
        shape = (len(frictions), len(numbers))
        table = {name: np.full(shape, np.nan) for name in FLOATS}
        table["unstable"] = np.zeros(shape, bool)
        table["outcome"] = np.full(shape, Outcome.not_computed, np.int8)
        for row, mu in enumerate(frictions):
            step = way.steps.get(mu)
            if step is None:
                table["outcome"][row] = Outcome.no_sliding_state
                continue
            columns = [place_of.get(int(number), -1) for number in step.numbers]
            chosen = np.array(columns, int) >= 0
            at = np.array(columns, int)[chosen]
            for name, values in _of_modes(step.spectrum).items():
                table[name][row, at] = values[chosen]
            table["outcome"][row, at] = Outcome.converged
        located = [way.critical(number) for number in numbers]
        table["critical_mu"] = np.array([each[0] for each in located], float)
        table["onset"] = np.array([each[1] for each in located], np.int8)
        partners = [place_of.get(each[2], -1) for each in located]  # type: ignore[arg-type]
        table["merges_with"] = np.array(partners, np.int32) + 1
        for name, values in table.items():
            tables.setdefault(name, []).append(values)
    return tables


def _numbers(ways: list[Way], frictions: list[float]) -> list[int]:
    """Numbers of modes within the limits anywhere, by the frequency at which they appear."""
    first: dict[int, tuple[int, float, float]] = {}
    for place, (way, mu) in enumerate((way, mu) for way in ways for mu in frictions):
        if (step := way.steps.get(mu)) is None:
            continue
        chosen = way.solver.selected(step.spectrum)
        for number, value in zip(
            step.numbers[chosen], step.spectrum.values[chosen], strict=True
        ):
            # a mode that only comes into the band later stands behind those of the first
            first.setdefault(int(number), (place, value.imag, -value.real))
    return sorted(first, key=first.__getitem__)


def _of_modes(spectrum: Spectrum) -> dict[str, np.ndarray]:
    values, size = spectrum.values, np.abs(spectrum.values)
    return {
        "growth_rate": values.real,
        "growth_rate_error": spectrum.growth_errors,
        "frequency": values.imag / (2 * np.pi),
        "damping_ratio": -values.real / np.where(size > 0, size, 1.0),
        "unstable": values.real > spectrum.growth_errors,
        "residual": spectrum.residuals,
    }


def _forces(ways: list[Way], frictions: list[float], number: int) -> list[np.ndarray]:
    """Normal forces over (friction, contact) for each way, NaN without steady sliding."""
    nothing = np.full(number, np.nan)
    steps = [[way.steps.get(mu) for mu in frictions] for way in ways]
    return [
        np.array(
            [nothing if each is None else each.spectrum.state.force for each in row]
        )
        for row in steps
    ]


def _over(tables: list[np.ndarray], one_friction: bool, one_speed: bool) -> np.ndarray:
    """Tables of all belt speeds as one array over (mu, belt_speed, …), scalars left out."""
    by_friction = tables[0].ndim == 2
    array = np.stack(tables, axis=1 if by_friction else 0)
    if one_speed:
        array = array[:, 0] if by_friction else array[0]
    return array[0] if by_friction and one_friction else array
