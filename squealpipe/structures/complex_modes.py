"""Compute complex modes of a structure as a dataset: growth, frequency, critical friction.

Idea: each combination of belt speed and further factors is a way along friction, on which modes
keep their numbers (:mod:`squealpipe.structures.numbering`); the tables of all ways become one
dataset, whose modes are ordered by the frequency at which they appear. Invariant: a mode has one
number at every friction, also through a merge with another. Cost: the eigenvalue problems along all
ways; :func:`cost_beforehand` states it for large structures.
"""

import functools
import inspect
import json
import warnings
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import numpy as np
import xarray as xr

from squealpipe.inputs import FRICTION_KEYWORDS, UNITS, with_units
from squealpipe.schema import Outcome, build
from squealpipe.structures.confirming import ConfirmedWay
from squealpipe.structures.critical_speeds import critical_speeds
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.factors import Asked, asked_of, with_factors
from squealpipe.structures.meshes.datasets import mesh_variables
from squealpipe.structures.mode_shapes import shape_variables
from squealpipe.structures.numbering import Way
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.schema.structures import modes_over
from squealpipe.structures.sliding import NoSlidingError
from squealpipe.structures.spectrum import Solver, Spectrum
from squealpipe.systems.datasets.versions import versions
from squealpipe.systems.one_thread import one_thread
from squealpipe.systems.progress import with_progress

Given = ParamSpec("Given")
Result = TypeVar("Result")


def _in_units_of_structure(
    function: Callable[Given, Result],
) -> Callable[Given, Result]:
    """Have a function read its arguments, of which the belt speed of a rotation is in rad/s."""
    names = [*inspect.signature(function).parameters, *FRICTION_KEYWORDS]

    @functools.wraps(function)
    def run(*args: Given.args, **kwargs: Given.kwargs) -> Result:
        structure: Any = args[0] if args else kwargs["structure"]
        units = UNITS | {"belt_speed": structure.speed_unit}
        given, named = with_units(names, args, kwargs, units)
        return function(*given, **named)  # type: ignore[arg-type]

    return run


@_in_units_of_structure
@one_thread()
def complex_modes(
    structure: ContactStructure,
    *,
    mu: Any = None,
    belt_speed: Any = None,
    frequency_max: float | None = None,
    n_modes: int | None = None,
    critical: bool = True,
    **factors: Any,
) -> xr.Dataset:
    """Complex modes about steady sliding.

    Args:
        mu: friction of the contacts that have none of their own; an ascending array of it is a
            dimension. None: the structure's. A mapping like ``{"lining": [0.2, 0.4]}`` varies that
            of one contact or of one face, the contacts ``lining_1``, ``lining_2``, …; where every
            contact has its own and nothing is varied, ``critical_scale`` is of all together.
        belt_speed: likewise in any order, m/s, or with a rotation rad/s. An array also has
            ``critical_speed``.
        frequency_max: modes up to there, Hz.
        n_modes: so many modes, by frequency. One of both is needed beyond 1000 degrees of freedom;
            with neither, all modes are computed.
        critical: whether ``critical_mu`` is sought, by following modes along friction: most of the
            work for a large structure. Without it ``onset`` is ``not_sought``. Beyond 300 degrees
            of freedom, where there is a limit, modes are followed in a subspace, which has those of
            the whole at the frictions asked for, and each ``critical_mu`` is located anew in the
            whole: where that does not confirm it, ``onset`` is ``not_followed``. That a mode is
            ``stable`` is known of the whole at the frictions asked for, and of the subspace between
            them.
        factors: further ones, a number or a 1-D array each: ``mu_static``, ``friction_speed`` (m/s)
            or ``modal_damping`` in place of the structure's; factors of what it has, namely of all
            contacts' ``preload`` and ``contact_stiffness``, of one contact's by its name
            (``p1_preload``, ``p1_stiffness``), and of the matrices ``mass``, ``damping`` and
            ``stiffness``. As in :meth:`system`, ``preload`` scales the load that balances it.

    Returns:
        Dataset over (mu, belt_speed, …, mode), with a dimension for each factor that is an array:
        ``growth_rate`` (1/s), ``frequency`` (Hz), ``damping_ratio``, ``unstable`` (growth above its
        error), ``residual``, ``outcome``. By mode ``critical_mu``: the smallest friction in the
        range given (from 0 to ``mu`` for one) at which growth leaves zero, NaN with the reason in
        ``onset``; in its place ``critical_scale``, the factor of all coefficients (from 0 to 1),
        where every contact has its own; and ``merges_with``: the mode whose frequency it meets
        or, with damping, comes near where one of both turns unstable; of several the first, so that
        a third mode may name one of two that name each other. A mode is a pair of eigenvalues, or
        one real eigenvalue; it keeps its number along ``mu``, and from one value of a factor to the
        next, by its shape. ``critical_speed``: the smallest of the speeds in the range of
        ``belt_speed`` at which growth passes zero, NaN with the reason in ``speed_onset``; beyond
        1000 degrees of freedom only of the reduced structure. ``normal_force`` by contact is 0
        where one is open; open contacts are left out.

    Raises:
        ValueError: an argument; there is no steady sliding anywhere.
        RuntimeError: of a large structure, the modes in the band could not be shown to be complete.
    """
    asked = asked_of(
        structure,
        {"mu": mu, "belt_speed": belt_speed, **factors},
        frequency_max=frequency_max,
        n_modes=n_modes,
        critical=critical,
    )
    points = asked.mu.size * asked.belt_speed.size
    points *= int(np.prod([values.size for values in asked.varied.values()]))
    if told := cost_beforehand(structure, points, n_modes):
        warnings.warn(told, stacklevel=4)
    return _dataset(structure, asked)


def cost_beforehand(structure: Any, points: int, n_modes: int | None) -> str | None:
    """Return time and memory that complex modes take, in words; None below 2 min and 4 GB.

    Args:
        points: combinations of friction, belt speed and further factors.
        n_modes: how many modes; None: not known, and 40 are assumed.
    """
    number = n_modes or 40
    # measured: factors of a compact body of hexahedra have 31 to 58 n^(4/3) entries, of a plate a
    # quarter of that; 0.11 µs for each of them and each mode; of 12 bytes real, 20 complex
    entries = 60.0 * structure.size ** (4 / 3)
    bytes_each, slower = (20, 1.7) if structure.damping.nnz else (12, 1.0)
    seconds = 0.11e-6 * slower * entries * number * points
    memory = 0.3e9 + 3 * bytes_each * entries
    if structure.size <= DENSE or (seconds < 120 and memory < 4e9):
        return None
    time = f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
    return (
        f"{structure.size:,} degrees of freedom: about {time} and {memory / 1e9:.2g} GB for "
        f"{number} modes of a compact body at {points} point{'s' if points > 1 else ''} of what is "
        "varied, on one core; a quarter of both for a plate; several times as long if critical "
        "frictions are sought, which are confirmed one by one"
    )


def _dataset(structure: ContactStructure, asked: Asked) -> xr.Dataset:
    """Complex modes as asked."""
    frictions, speeds, varied = asked.mu, asked.belt_speed, asked.varied
    ways = _ways(with_factors(structure, asked.fixed), asked)
    every = list(ways.ravel())
    if not any(way.steps for way in every):
        raise NoSlidingError(every[0].reasons[0])
    rows = np.atleast_1d(frictions).tolist()
    if not frictions.ndim and not any(rows[0] in way.steps for way in every):
        raise NoSlidingError(every[0].reasons[-1])
    tables = _tables(every, rows)
    coords: dict[str, Any] = {
        "mode": np.arange(1, tables["growth_rate"][0].shape[-1] + 1),
        "mu": frictions,
        "belt_speed": speeds,
        **varied,
    }
    if asked.friction.is_factor:
        del coords["mu"]
        tables["critical_scale"] = tables["critical_mu"]
        tables["critical_mu"] = [
            np.full_like(table, np.nan) for table in tables["critical_scale"]
        ]
    if names := [contact.name for contact in structure.contacts]:
        coords["contact"] = names
        tables["normal_force"] = _forces(every, rows, len(names))
    of_mesh, mesh_coordinates = mesh_variables(structure)
    coords |= mesh_coordinates
    shapes = shape_variables(
        structure, ways, rows, _own_friction(structure, asked), _numbers(every, rows)
    )
    scalar = not frictions.ndim, not speeds.ndim
    modes = {
        name: _over(arrays, ways.shape, *scalar) for name, arrays in tables.items()
    }
    if asked.critical and speeds.ndim and structure.size <= DENSE:
        modes |= _critical_speeds(ways, asked)
    dims = tuple(
        name
        for name in ("mu", "belt_speed", *varied)
        if name in coords and coords[name].ndim
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
    complete = (
        "complete: right and left eigenvectors, about other points, "
        "have the same eigenvalues"
    )
    all_of_them = "complete: all eigenvalues by dense algebra"
    attrs = {
        "made_by": "squealpipe.Structure.complex_modes",
        "model": "linear about steady sliding",
        "method": all_of_them if structure.size <= DENSE else complete,
        "tolerance": "round-off",
        "parameters": json.dumps(structure.as_dict()),
        "arguments": json.dumps(
            {**asked.limits.as_dict(), "critical": asked.critical, **asked.fixed}
        ),
        **({"mu_of": asked.friction.name} if asked.friction.name else {}),
        "open_contacts": ", ".join(sorted(opened)) or "none",
        "fixed_degrees_of_freedom": max(
            step.spectrum.fixed for way in every for step in way.steps.values()
        ),
        **versions(),
    }
    dataset = build(modes_over(dims), modes | shapes | of_mesh, coords, attrs)
    if structure.rotation is not None:
        for name in {"belt_speed", "critical_speed"} & set(dataset.variables):
            dataset[name].attrs["units"] = structure.speed_unit
        dataset.belt_speed.attrs["long_name"] = "speed of rotation"
    return dataset


def _own_friction(structure: ContactStructure, asked: Asked) -> float:
    """Return the number of what is varied that the structure has, or the first one asked for."""
    try:
        return asked.friction.now(structure)
    except ValueError:  # contacts of a face that differ
        return float(np.atleast_1d(asked.mu)[0])


def _ways(structure: ContactStructure, asked: Asked) -> np.ndarray:
    """Modes along friction at each combination of factors, (belt speed, further ones)."""
    frictions = np.atleast_1d(asked.mu)
    path = frictions
    if asked.critical and not asked.mu.ndim and structure.contacts and asked.mu > 0:
        # one friction alone: on the way to it from none, modes are followed all the same
        # frictions on the way from none to the one that is asked for, along which modes keep
        # their numbers
        friction_steps = 9
        path = np.linspace(0.0, float(asked.mu), friction_steps)
    # below so many degrees of freedom dense algebra is as fast (300: half a second a friction)
    few = 300
    in_subspace = asked.critical and structure.size > few and not asked.limits.takes_all
    grid = {"belt_speed": np.atleast_1d(asked.belt_speed), **asked.varied}
    shape = tuple(map(len, grid.values()))
    ways = np.empty(shape, object)
    top = 0
    for place in with_progress(list(np.ndindex(shape))):
        at = {
            name: float(values[index])
            for (name, values), index in zip(grid.items(), place, strict=True)
        }
        speed = at.pop("belt_speed")
        changed = with_factors(structure, at)
        solver = Solver(changed, asked.limits, speed, asked.friction)
        way: Way
        if in_subspace:
            way = ConfirmedWay(solver, top, path=path.tolist())
            way.follow(frictions.tolist(), _neighbour(ways, place))
        else:
            way = Way(solver, top, asked.critical)
            way.follow(path.tolist(), _neighbour(ways, place))
        ways[place], top = way, way.top
    return ways


def _critical_speeds(ways: np.ndarray, asked: Asked) -> dict[str, np.ndarray]:
    """Critical speeds over (mu, further factors, mode), scalars left out."""
    rows = np.atleast_1d(asked.mu).tolist()
    numbers = _numbers(list(ways.ravel()), rows)
    located = [
        [
            critical_speeds(list(along), asked.belt_speed, mu, numbers)
            for along in ways.reshape(len(ways), -1).T
        ]
        for mu in rows
    ]
    shape = (*([len(rows)] if asked.mu.ndim else []), *ways.shape[1:], len(numbers))
    each = [one for row in located for modes in row for one in modes]
    return {
        "critical_speed": np.array([one.speed for one in each]).reshape(shape),
        "speed_onset": np.array([one.onset for one in each], np.int8).reshape(shape),
    }


def _neighbour(ways: np.ndarray, place: tuple[int, ...]) -> Way | None:
    """The way at the value before, of the last factor that is not at its first value."""
    for axis in reversed(range(len(place))):
        if place[axis]:
            before = list(place)
            before[axis] -= 1
            return ways[tuple(before)]  # type: ignore[no-any-return]
    return None


def _tables(ways: list[Way], frictions: list[float]) -> dict[str, list[np.ndarray]]:
    """Each variable over (friction, mode), or over mode, for each way."""
    numbers = _numbers(ways, frictions)
    place_of = {number: index for index, number in enumerate(numbers)}
    tables: dict[str, list[np.ndarray]] = {}
    floats = (
        "growth_rate",
        "growth_rate_error",
        "frequency",
        "damping_ratio",
        "residual",
    )
    for way in ways:
        shape = (len(frictions), len(numbers))
        table = {name: np.full(shape, np.nan) for name in floats}
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
            table["outcome"][row, at] = step.spectrum.outcomes[chosen]
        located = way.criticals(numbers)
        table["critical_mu"] = np.array([each.mu for each in located], float)
        table["onset"] = np.array([each.onset for each in located], np.int8)
        partners = [place_of.get(each.partner, -1) for each in located]  # type: ignore[arg-type]
        table["merges_with"] = np.array(partners, np.int32) + 1
        for name, values in table.items():
            tables.setdefault(name, []).append(values)
    return tables


def _numbers(ways: list[Way], frictions: list[float]) -> list[int]:
    """Numbers of modes within the limits anywhere, by the frequency at which they appear."""
    first: dict[int, tuple[int, float, float]] = {}
    for index, (way, mu) in enumerate((way, mu) for way in ways for mu in frictions):
        if (step := way.steps.get(mu)) is None:
            continue
        chosen = way.solver.selected(step.spectrum)
        for number, value in zip(
            step.numbers[chosen], step.spectrum.values[chosen], strict=True
        ):
            # a mode that only comes into the band later stands behind those of the first
            first.setdefault(int(number), (index, value.imag, -value.real))
    # undamped modes that have met differ by round-off alone: the one that grows is the first
    rank, before, ranks = 0, (-1, 0.0), {}
    for number in sorted(first, key=first.__getitem__):
        index, frequency, _ = first[number]
        if index != before[0] or frequency - before[1] > 1e-8 * frequency:
            rank += 1
        before = index, frequency
        ranks[number] = rank, first[number][2]
    return sorted(ranks, key=ranks.__getitem__)


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


def _over(
    tables: list[np.ndarray], grid: tuple[int, ...], one_friction: bool, one_speed: bool
) -> np.ndarray:
    """Tables of all ways as one array over (mu, belt_speed, …), scalars left out."""
    by_friction = tables[0].ndim == 2
    array = np.stack(tables).reshape(*grid, *tables[0].shape)
    if one_speed:
        array = array[0]
    if not by_friction:
        return array
    array = np.moveaxis(array, -2, 0)
    return array[0] if one_friction else array
