"""Raw results of runs, one record of a single run, and what its datasets have in common."""

from __future__ import annotations

import json
import math
import weakref
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.methods.processes import run_shared
from squealpipe.methods.taylor import lanes, layout
from squealpipe.methods.taylor.loop import loop
from squealpipe.methods.taylor.scalar import ScalarSource
from squealpipe.methods.taylor.series import HybridSystem
from squealpipe.methods.taylor.simd import FEW, LANES
from squealpipe.schema import SYSTEM, Outcome, flag_table, in_words
from squealpipe.schema.origin import versions
from squealpipe.systems.definition import System
from squealpipe.systems.trace import TIME, TIME_UNIT, Names
from squealpipe.text import suggestion
from squealpipe.validation import real_array

FIRST_LOG = 256
"""Events kept at first; a run that has more is made again with room for all."""
LARGEST = "largest "

MOST_STEPS, MOST_EVENTS = 1e7, 1e7


def symbolic(system: System) -> HybridSystem:
    """What the series of a system are written from."""
    t = system.integrated
    return HybridSystem(
        variables=t.variables,
        rates=t.rates,
        events=(*t.surfaces, *t.outputs),
        parameters=(*t.parameters, *t.all_constants),
        explicit_time=len(t.variables) > t.size,
    )


_COMPILED: weakref.WeakKeyDictionary[
    Any, dict[tuple[bool, bool], lanes.CompiledSystem]
] = weakref.WeakKeyDictionary()


def compiled(system: System, *, tangent: bool, few: bool) -> lanes.CompiledSystem:
    """The machine code of a system, built once a process and kept on disk."""
    known = _COMPILED.setdefault(system.form, {})
    if (tangent, few) not in known:
        t = system.integrated
        scalar = ScalarSource(
            t.variables,
            t.rates,
            t.parameters,
            t.all_constants,
            t.surfaces,
            t.switches,
            t.size,
            t.outputs,
        )
        sources = {"gauge": scalar.gauge(), "change": scalar.change()}
        if t.switched:
            sources["settle"] = scalar.settle(t.switched)
        if tangent:
            sources["jump"] = scalar.jump()
        known[tangent, few] = lanes.compile_system(
            symbolic(system), sources, tangent=tangent, few=few
        )
    return known[tangent, few]


def integrate(
    system: System,
    values: Mapping[str, np.ndarray],
    t_end: np.ndarray,
    *,
    regime: Any = None,
    t_late: Any = math.inf,
    late_from: str | None = None,
    until: str | None = None,
    around: np.ndarray | None = None,
    most_turns: Any = math.inf,
    tracked: Sequence[str] | None = None,
    times: np.ndarray | None = None,
    sums: bool = False,
    tol: float,
    tangent: bool = False,
    log_events: int = 0,
    most_steps: Any = MOST_STEPS,
    most_events: Any = MOST_EVENTS,
    unit_sizes: np.ndarray | None = None,
    workers: int | None = None,
) -> dict[str, np.ndarray]:
    """Raw results of some runs, one row each.

    Args:
        values: each state and parameter as an array, (runs,).
        t_end, t_late: in the system's unit of time.
        late_from: kind of event whose first begins the late part, if ``t_late`` does not.
        until: kind of event whose first ends a run, as ``BY_EVENT``.
        around: points (runs, points, 2) in the plane of the first two states around which half
            turns are counted, counterclockwise.
        most_turns: net turns around all of them that end a run, as ``BY_TURNS``.
        regime: in which all start, by name, or the number of each in each component, (runs,
            components); by default what fits each.
        tracked: states and outputs whose extremes are kept, by default all; after ``LARGEST`` the
            largest value alone.
        times: instants at which the state is kept, (instants,) or (runs, instants).
        sums: keep there what has added up, too.
        most_steps, most_events: of each run.
        unit_sizes: of the states; by default the system's.

    Returns:
        One row a run: ``final``; ``extremes``, ``early_extremes`` and ``late_extremes`` (runs,
        tracked, smallest and largest; infinite of a part that was not reached); ``counts``,
        ``firsts`` (NaN: never) and ``peaks`` (largest magnitude of each state before the event)
        of each kind of event; ``durations`` of regimes; ``ends``: outcome, steps, events;
        ``summary``: growth, horizon, time; ``half_turns``; ``samples`` and
        ``sample_regimes`` (of each component); ``sample_growth``, ``sample_durations``,
        ``sample_half_turns`` and ``sample_counts``; ``event_times``, ``event_kinds``,
        ``event_regimes``, ``event_states``.
    """
    t, size = system.integrated, len(t_end)
    scale = system.time_scale
    unit = np.broadcast_to(
        scale(Names("the system", values)) if callable(scale) else float(scale), (size,)
    ).astype(float)
    with np.errstate(over="ignore"):
        fits = (unit > 0.0) & (t_end / unit < math.inf)
    if not fits.all():
        raise ValueError(
            f"{system.name}: time_scale = {unit.min()}: it is not a unit of time"
        )
    derive, given = system.derived
    known = {**values, TIME_UNIT: unit}
    derived = derive(*(known[name] for name in given))
    parameters = _table(
        size, *(values[name] for name in system.parameters), *derived, unit
    )
    initial = _table(size, *(values[name] for name in system.states))
    regimes = regime
    if not isinstance(regimes, np.ndarray):
        regimes = system.first_regimes({TIME: np.zeros(size), **values}, size, regimes)
    places = [*range(t.size)]
    places += [len(t.variables) + len(t.surfaces) + i for i in range(len(t.outputs))]
    quantities = [*system.states, *system.outputs]
    chosen = quantities if tracked is None else tracked
    watched = [
        (places[quantities.index(each.removeprefix(LARGEST))], each.startswith(LARGEST))
        for each in chosen
    ]
    lost = math.log(layout.LOST_ERROR / tol)
    limits = _table(
        size, t_end / unit, t_late / unit, most_steps, most_events, lost, most_turns
    )
    samples = np.empty((1, 0)) if times is None else np.atleast_2d(times)
    sample_times = np.ascontiguousarray(samples / unit[:, None])
    n_samples = samples.shape[1]
    n_kinds, n_regimes = max(1, len(t.kinds)), len(system.regimes)
    points = (
        np.empty((size, 0, 2))
        if around is None
        else np.ascontiguousarray(around, float)
    )
    n_points = points.shape[1]
    n_sums = (1 + n_regimes + n_points + n_kinds) * sums
    shapes: dict[str, Any] = {
        "final": ((size, t.size), "f8"),
        "extremes": ((size, len(watched), 2, 2), "f8"),
        "counts": ((size, n_kinds), "i8"),
        "firsts": ((size, n_kinds), "f8"),
        "durations": ((size, n_regimes), "f8"),
        "ends": ((size, 3), "i8"),
        "summary": ((size, 3), "f8"),
        "samples": ((size, n_samples, t.size), "f8"),
        "sample_regimes": ((size, n_samples, t.n_components), "i8"),
        "sample_sums": ((size, n_samples, n_sums), "f8"),
        "peaks": ((size, n_kinds, t.size), "f8"),
        "half_turns": ((size, n_points), "f8"),
        "event_times": ((size, log_events), "f8"),
        "event_kinds": ((size, log_events), "i8"),
        "event_regimes": ((size, log_events), "i8"),
        "event_states": ((size, log_events, t.size), "f8"),
    }
    code = compiled(system, tangent=tangent, few=size <= FEW)
    loop()
    terms = lanes.taylor_terms(tol)
    n_rows = (
        layout.FIXED_ROWS + len(t.variables) + t.size + 2 * len(watched) + n_regimes
    )
    n_constants = len(t.all_constants)
    n_rows += 3 * n_points + t.n_components + len(t.parameters) + n_constants
    n_events = len(t.surfaces) + len(t.outputs)
    width = max(3 * n_events, len(t.variables), n_constants) + 2
    written = symbolic(system)
    # outputs are watched in all lanes, surfaces as regimes ask
    watched_events = np.zeros(n_events, np.int64)
    watched_events[[w - len(t.variables) for w, _ in watched if w >= t.size]] = -1
    share = [max(layout.SHARE * tol, layout.ROUND_OFF), tol, written.bent.any()]

    def work(arrays: dict[str, np.ndarray], first: int, stride: int) -> None:
        for name in ("samples", "sample_sums", "event_times", "event_states", "firsts"):
            arrays[name][first::stride] = np.nan
        arrays["extremes"][first::stride] = [np.inf, -np.inf]
        for name in ("sample_regimes", "event_kinds", "event_regimes"):
            arrays[name][first::stride] = -1
        integers = np.full((layout.REGIMES + t.n_components, LANES), -1, np.int64)
        integers[1] = 0  # every lane asks for a job
        rows = lanes.aligned(n_rows, LANES)
        held = arrays | {
            "rows": rows,
            "integers": integers,
            "series": lanes.aligned(code.n_series, terms, LANES),
            "inverses": lanes.INVERSES,
            "sizes": system.sizes if unit_sizes is None else unit_sizes,
            "tracked": np.array(watched, np.int64),
            "points": points,
            "regimes": t.regimes,
            "falls": t.falls,
            "rises": t.rises,
            "component_of": t.component_of,
            "first_constant": t.first_constant,
            "owner": t.owner,
            "active": watched_events.copy(),
            "fresh": np.zeros(len(t.surfaces), np.int64),
            "beyond": np.zeros(len(t.surfaces), np.int64),
            "exact": lanes.aligned(t.size + n_events, LANES),
            "steep": written.steep,
            "bent": written.bent,
            "share": np.array(share, float),
            "noise": np.zeros((len(t.surfaces), 2, LANES)),
            "scratch": np.zeros((6, width)),
            "initial": initial,
            "parameters": parameters,
            "first_regime": regimes,
            "limits": limits,
            "sample_times": sample_times,
            "queue": np.array([first, size, stride], np.int64),
        }
        sizes = {
            "n_terms": terms,
            "n_jobs": size,
            "n_states": t.size,
            "n_variables": len(t.variables),
            "n_surfaces": len(t.surfaces),
            "n_outputs": len(t.outputs),
            "n_tracked": len(watched),
            "n_parameters": len(t.parameters),
            "n_constants": n_constants,
            "n_regimes": n_regimes,
            "n_components": t.n_components,
            "n_table": len(t.constants),
            "n_kinds": n_kinds,
            "n_samples": n_samples,
            "n_sums": n_sums,
            "n_logged": log_events,
            "n_points": n_points,
            "until": t.kinds.index(until) if until in t.kinds else -1,
            "late_from": t.kinds.index(late_from) if late_from in t.kinds else -1,
            "n_rounds": lanes.ROUNDS,
            "tangent": int(tangent),
            "take_step": code.address("series"),
            **{name: code.address(name) for name in layout.FUNCTIONS},
            "n_series": code.n_series,
            "n_rows": n_rows,
            "n_switches": len(t.switches),
        }
        # a view of nothing has no address
        held = {
            k: v if v.size else np.zeros(1, v.dtype)
            for k, v in held.items()
            if k in layout.ARRAYS
        }
        table = lanes.Workspace(
            layout.TABLE, held, {name: sizes[name] for name in layout.SIZES}
        )
        at = integers[layout.JOB], rows[layout.CLOCK], rows[layout.T_END], held["queue"]
        lanes.drive(loop(), table, lambda: lanes.share_of(*at))
        if integers[layout.JOB].max() >= 0 or held["queue"][0] < size:
            raise RuntimeError(
                "an exception in compiled code, reported above, ended the integration before its "
                "runs were finished; please report the parameters"
            )

    arrays = run_shared(work, shapes, jobs=size, workers=workers)
    arrays["early_extremes"], arrays["late_extremes"] = np.moveaxis(
        arrays["extremes"], 2, 0
    )
    low, high = (
        arrays["extremes"][..., 0].min(axis=2),
        arrays["extremes"][..., 1].max(axis=2),
    )
    arrays["extremes"] = np.stack([low, high], axis=-1)
    ends = np.cumsum([1, n_regimes, n_points])
    for name, part in zip(
        ("growth", "durations", "half_turns", "counts"),
        np.split(arrays.pop("sample_sums"), ends, axis=-1) if sums else (),
        strict=False,
    ):
        arrays[f"sample_{name}"] = part
    for name in ("durations", "event_times", "firsts"):
        arrays[name] = arrays[name] * unit[:, None]
    if sums:
        arrays["sample_durations"] = arrays["sample_durations"] * unit[:, None, None]
    arrays["summary"][:, 1:] *= unit[:, None]
    return arrays


def _table(size: int, *columns: Any) -> np.ndarray:
    """Columns side by side, each a number or an array (size,)."""
    rows = [np.broadcast_to(column, size) for column in columns]
    return np.array(rows, float).T.copy()


@dataclass(frozen=True)
class Motion:
    """One run with its events.

    Attributes:
        regimes: numbers, in ``system.joint``, of the first ones and of those after each event.
        times, kinds, states, entered: of the events, the states after them, the regimes entered.
        final: state at the end.
        path, path_regimes: at the asked instants; the regimes of each component.
        outcome, reached, steps: how and when it ended, and after how many steps.
    """

    regimes: np.ndarray
    times: np.ndarray
    kinds: np.ndarray
    states: np.ndarray
    entered: np.ndarray
    final: np.ndarray
    path: np.ndarray
    path_regimes: np.ndarray
    outcome: int
    reached: float
    steps: int


def single_run(
    system: System,
    values: Mapping[str, float],
    t_end: float,
    *,
    regime: Any = None,
    times: np.ndarray | None = None,
    tol: float,
    room: int = FIRST_LOG,
    **options: Any,
) -> Motion:
    """Run a system once from states and parameters; ``room`` is that for events at first."""
    given = {name: np.array([value]) for name, value in values.items()}
    while True:
        raw = integrate(
            system,
            given,
            np.array([t_end]),
            regime=regime,
            times=times,
            tol=tol,
            log_events=room,
            **options,
        )
        _, steps, count = (int(value) for value in raw["ends"][0])
        if count <= room or not room:
            break
        room = count
    first = regime
    if not isinstance(regime, np.ndarray):
        first = system.first_regimes({TIME: np.zeros(1), **given}, 1, regime)
    events = {
        key: raw[f"event_{key}"][0, :count]
        for key in ("times", "kinds", "states", "regimes")
    }
    return Motion(
        system.joint.along(first[0].tolist(), events["regimes"].tolist()),
        events["times"],
        events["kinds"],
        events["states"],
        events["regimes"],
        raw["final"][0],
        raw["samples"][0],
        raw["sample_regimes"][0],
        int(raw["ends"][0, 0]),
        float(raw["summary"][0, 2]),
        steps,
    )


@dataclass(frozen=True)
class Grid:
    """An outer product of starts and parameters.

    Attributes:
        shape: of the product.
        values: each state and parameter in every run, (runs,).
        coordinates: those that vary, as the dimensions of a dataset.
        fixed: the others.
        regime: in which all start, if it is given.
    """

    shape: tuple[int, ...]
    values: dict[str, np.ndarray]
    coordinates: dict[str, Any]
    fixed: dict[str, float]
    regime: str | None


def outer_product(
    system: System, start: Mapping[str, Any] | None, parameters: Mapping[str, Any]
) -> Grid:
    """The grid of what a call gives as 1-D arrays, starts first."""
    given = {
        n: real_array(n, v) for n, v in call_values(system, start, parameters).items()
    }
    for name, value in given.items():
        if value.ndim > 1:
            raise ValueError(
                f"{name} has shape {value.shape}: a number or a 1-D array is needed"
            )
    order = [name for name in start or {} if name != "regime"]
    swept = [name for name in (*order, *parameters) if given[name].ndim]
    shape = tuple(given[name].size for name in swept)
    axes = np.meshgrid(*(given[name] for name in swept), indexing="ij")
    fixed = {name: float(value) for name, value in given.items() if not value.ndim}
    size = math.prod(shape)
    values = {name: np.full(size, value) for name, value in fixed.items()}
    values |= {name: axis.ravel() for name, axis in zip(swept, axes, strict=True)}
    coordinates = {}
    for name in swept:
        at_start = name in system.units
        label = labels(
            f"{name} at t = 0" if at_start else f"parameter {name}",
            system.units.get(name, "1"),
        )
        dim = system.start_names[name] if at_start else name
        coordinates[dim] = (dim, given[name], label)
    return Grid(shape, values, coordinates, fixed, (start or {}).get("regime"))


def scalar(name: str, value: Any) -> float:
    """One finite number."""
    array = real_array(name, value)
    if array.ndim:
        raise ValueError(f"{name} has shape {array.shape}: one number is needed")
    return float(array)


def call_values(
    system: System, start: Mapping[str, Any] | None, parameters: Mapping[str, Any]
) -> dict[str, Any]:
    """States and parameters of a call, the system's where it gives none."""
    start = dict(start or {})
    system.check_regime(start)
    start.pop("regime", None)
    for name in start:
        if name not in system.units:
            raise ValueError(
                f"start: {name!r} is unknown; {suggestion(str(name), system.units)}"
            )
    for name in parameters:
        system.check_parameter(name)
    states = {name: system.start[name] for name in system.units}
    return {**states, **system.parameters, **start, **parameters}


def labels(long_name: str, units: str) -> dict[str, str]:
    """Attributes of a variable."""
    return {"long_name": long_name, "units": units}


def flag(long_name: str, dims: Any, values: Any, table: Mapping[int, str]) -> Any:
    """A flag variable: dimensions, values and the names of its values."""
    attributes = {
        "long_name": long_name,
        "flag_values": np.array(list(table), np.int16),
        "flag_meanings": " ".join(name.replace(" ", "_") for name in table.values()),
    }
    return dims, np.asarray(values, np.int16), attributes


def regime_flag(
    system: System, long_name: str, dims: tuple[str, ...], regimes: np.ndarray
) -> Any:
    """The flag variable of regimes (…, components); over ``component`` where there are several."""
    names = dict(enumerate(system.regimes))
    if (np.asarray(regimes) < 0).any():
        names[-1] = "not_reached"  # instants after the end of a run
    if len(system.composition.names) == 1:
        return flag(long_name, dims, np.asarray(regimes)[..., 0], names)
    return flag(f"{long_name} of each component", (*dims, "component"), regimes, names)


def components_of(system: System) -> dict[str, Any]:
    """The coordinate of a system's components, if there are several."""
    names = system.composition.names
    if len(names) == 1:
        return {}
    return {"component": ("component", list(names), {"long_name": "component"})}


def outcome(system: System, dims: Any, values: Any) -> Any:
    """The flag variable that says how runs ended."""
    table = flag_table(Outcome) | {
        layout.STOPPED + i: name for i, name in enumerate(system.stops)
    }
    dims, values, attributes = flag("how the run ended", dims, values, table)
    return dims, values, attributes | {"comment": in_words(table)}


def attributes(
    system: System, what: str, given: Mapping[str, float], tol: float
) -> dict[str, Any]:
    """What a dataset records of its system and its run."""
    return {
        "title": f"{system.name}: {what}",
        "schema": SYSTEM + what,
        "schema_version": 1,
        "system": json.dumps(system.text),
        "parameters": json.dumps(dict(given)),
        "tolerance": tol,
        "method": "Taylor series with located events",
        "package_version": versions()["package_version"],
    }
