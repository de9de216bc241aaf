"""Integrate many runs of a system by compiled code, and return raw arrays.

Idea: the series, switches and resets of a system are written once as machine code, kept on disk
under a digest of the text; a batch of runs is laid out in rows of lanes that this code advances
side by side (:mod:`squealpipe.systems.taylor.loop`). Invariant: a run's result does not depend on
the runs beside it. Cost: compilation takes seconds once.
"""

import math
import weakref
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealpipe.systems.processes import run_shared
from squealpipe.systems.taylor import lanes, layout
from squealpipe.systems.taylor.loop import loop
from squealpipe.systems.taylor.scalar import ScalarSource
from squealpipe.systems.taylor.series import HybridSystem
from squealpipe.systems.taylor.simd import FEW, LANES
from squealpipe.systems.trace import TIME, TIME_UNIT, Names
from squealpipe.systems.tracing import TracedSystem as System

LARGEST = "largest "

MOST_STEPS, MOST_EVENTS = 10_000_000, 10_000_000
"""A run has at most so many by default, alone, in an ensemble or on the way to a cycle."""


def symbolic(system: System) -> HybridSystem:
    """Return the symbols from which the series of a system are written."""
    t = system.integrated
    return HybridSystem(
        variables=t.variables,
        rates=t.rates,
        events=(*t.surfaces, *t.outputs),
        parameters=(*t.parameters, *t.all_constants),
        explicit_time=len(t.variables) > t.size,
    )


_compiled_systems: weakref.WeakKeyDictionary[
    Any, dict[tuple[bool, bool], lanes.CompiledSystem]
] = weakref.WeakKeyDictionary()


def compiled(system: System, *, tangent: bool, few: bool) -> lanes.CompiledSystem:
    """The machine code of a system, built once a process and kept on disk."""
    known = _compiled_systems.setdefault(system.form, {})
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


@dataclass(frozen=True)
class RunOptions:
    """Options of a batch of runs: what is observed, and what may end a run early.

    Attributes:
        regime: in which all start, by name, or the number of each in each component, (runs,
            components); by default what fits each.
        t_late: from when the late extremes are kept, in the system's unit of time.
        late_from: kind of event whose first begins the late part, if ``t_late`` does not.
        until: kind of event whose first ends a run, as ``by_event``.
        around: points (runs, points, 2) in the plane of the first two states around which half
            turns are counted, counterclockwise.
        most_turns: net turns around all of them that end a run, as ``by_turns``.
        tracked: states and outputs whose extremes are kept, by default all; after ``LARGEST`` the
            largest value alone.
        times: instants at which the state is kept, (instants,) or (runs, instants).
        sums: keep there what has added up, too.
        extremes_between: keep there the extremes of what is tracked since the instant before (the
            first: since the run's begin), from the series of the steps and not from the samples.
        tangent: follow a perturbation, for its growth and the horizon of predictability.
        log_events: room for the events of each run.
        logged: kinds of events that are logged, by default all, as a record of one run needs.
        most_steps, most_events: of each run.
        unit_sizes: typical sizes of the states, by default the system's.
        t_start: what the system's functions take for the time where a run begins; all other
            times count from there.
    """

    regime: Any = None
    t_late: Any = math.inf
    late_from: str | None = None
    until: str | None = None
    around: np.ndarray | None = None
    most_turns: Any = math.inf
    tracked: Sequence[str] | None = None
    times: np.ndarray | None = None
    sums: bool = False
    extremes_between: bool = False
    tangent: bool = False
    log_events: int = 0
    logged: Container[str] | None = None
    most_steps: Any = MOST_STEPS
    most_events: Any = MOST_EVENTS
    unit_sizes: np.ndarray | None = None
    t_start: float = 0.0


_default_options = RunOptions()


def integrate(
    system: System,
    values: Mapping[str, np.ndarray],
    t_end: np.ndarray,
    options: RunOptions = _default_options,
    *,
    tol: float,
    workers: int | None = None,
) -> dict[str, np.ndarray]:
    """Raw results of some runs, one row each.

    Args:
        values: each state and parameter as an array, (runs,).
        t_end: (runs,), in the system's unit of time.
        tol: tolerance of the Taylor integrator, relative to the states' sizes.
        workers: processes; None takes all cores.

    Returns:
        One row a run: ``final``; ``extremes``, ``early_extremes`` and ``late_extremes`` (runs,
        tracked, smallest and largest; infinite of a part that was not reached); ``counts``,
        ``firsts`` (NaN: never) and ``peaks`` (largest magnitude of each state before the event)
        of each kind of event; ``durations`` of regimes; ``outcome``, ``steps`` and ``n_events``;
        ``log_growth`` of the perturbation, ``horizon`` (NaN: not passed) and ``reached``, the time
        at the end; ``half_turns``; ``samples`` and ``sample_regimes`` (of each component);
        ``sample_growth``, ``sample_durations``, ``sample_half_turns`` and ``sample_counts``;
        ``sample_extremes`` (runs, instants, tracked, smallest and largest; NaN: not reached);
        ``event_times``, ``event_kinds``, ``event_regimes``, ``event_states``; ``first_regimes``
        (runs, components).

    Raises:
        ValueError: the system's unit of time, or a state's typical size, is not a positive number.
    """
    scales, clock, units = system.scales_in(values), 1.0, [*system.units.values()]
    if scales is not None:
        with np.errstate(all="ignore"):  # scales may overflow: such runs end at once
            values = scales.into(system.units_of_values, values)
            clock = scales.of("s")
            t_end = t_end / clock
            options = scales.options(options, units, alike=not system.has_typical_sizes)
    make = system.batch or Batch
    batch = make(system.for_exponents(values), values, t_end, options, tol)
    batch.loop()  # compiled before processes share the work
    arrays = run_shared(batch.run, batch.shapes(), jobs=len(t_end), workers=workers)
    raw = batch.named(arrays, clock)
    if scales is not None:
        with np.errstate(all="ignore"):
            scales.back(raw, units, batch.tracked_units())
    return raw


class Batch:
    """Runs of one system with what they are given, as the compiled loop reads it."""

    loop = staticmethod(loop)

    def __init__(
        self,
        system: System,
        values: Mapping[str, np.ndarray],
        t_end: np.ndarray,
        options: RunOptions,
        tol: float,
    ) -> None:
        self.system, self.options, self.tol = system, options, tol
        self.size = len(t_end)
        self.unit = unit = _time_units(system, values, t_end)
        self.initial = table_of(self.size, *(values[name] for name in system.states))
        self.sizes = _state_sizes(system, values, self.size, options.unit_sizes)
        self.parameters = self._parameters(values)
        self.regimes = options.regime
        if not isinstance(self.regimes, np.ndarray):
            at_start = {TIME: np.full(self.size, options.t_start), **values}
            self.regimes = system.first_regimes(
                at_start, self.size, self.regimes, in_scales=True
            )
        self.watched = self._watched()
        self.limits = table_of(
            self.size,
            t_end / unit,
            options.t_late / unit,
            options.most_steps,
            options.most_events,
            math.log(layout.LOST_ERROR / tol),
            options.most_turns,
            options.t_start,
        )
        samples = (
            np.empty((1, 0)) if options.times is None else np.atleast_2d(options.times)
        )
        self.sample_times = np.ascontiguousarray(samples / unit[:, None])
        self.points = (
            np.empty((self.size, 0, 2))
            if options.around is None
            else np.ascontiguousarray(options.around, float)
        )
        self.n_kinds = max(1, len(system.integrated.kinds))
        self._compile()

    def _parameters(self, values: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return the numbers of each run as its lane has them, (runs, parameters)."""
        derive, names = self.system.derived
        known = {**values, TIME_UNIT: self.unit}
        derived = derive(*(known[name] for name in names))
        given = (values[name] for name in self.system.parameters)
        return table_of(self.size, *given, *derived, self.unit)

    def _compile(self) -> None:
        """Compile what the system computes, and note what its steps are checked by."""
        few = self.size <= FEW
        code = compiled(self.system, tangent=self.options.tangent, few=few)
        written = symbolic(self.system)
        self.code, self.n_series = code.code, code.n_series
        self.steep, self.bent = written.steep, written.bent

    def tracked_units(self) -> list[str]:
        """Return the unit of each quantity that is tracked."""
        system, tracked = self.system, self.options.tracked
        units = {**system.units, **{n: unit for n, (unit, _) in system.outputs.items()}}
        names = units if tracked is None else tracked
        return [units[name.removeprefix(LARGEST)] for name in names]

    def _watched(self) -> list[tuple[int, bool]]:
        """Place among variables, surfaces and outputs of what is tracked; the largest alone?"""
        t = self.system.integrated
        first_output = len(t.variables) + len(t.surfaces)
        places = [*range(t.size), *(first_output + i for i in range(len(t.outputs)))]
        quantities = [*self.system.states, *self.system.outputs]
        tracked = self.options.tracked
        return [
            (
                places[quantities.index(name.removeprefix(LARGEST))],
                name.startswith(LARGEST),
            )
            for name in (quantities if tracked is None else tracked)
        ]

    def _sums(self) -> list[tuple[str, int]]:
        """Return the sums along a run, and how many numbers each has."""
        if not self.options.sums:
            return []
        return [
            ("growth", 1),
            ("durations", len(self.system.regimes)),
            ("half_turns", self.points.shape[1]),
            ("counts", self.n_kinds),
        ]

    def shapes(self) -> dict[str, Any]:
        """Shape and type of each array of results."""
        t, size = self.system.integrated, self.size
        n_samples, n_logged = self.sample_times.shape[1], self.options.log_events
        n_sums = sum(count for _, count in self._sums())
        n_between = n_samples if self.options.extremes_between else 0
        return {
            "final": ((size, t.size), "f8"),
            "extremes": ((size, len(self.watched), 2, 2), "f8"),
            "counts": ((size, self.n_kinds), "i8"),
            "firsts": ((size, self.n_kinds), "f8"),
            "durations": ((size, len(self.system.regimes)), "f8"),
            "ends": ((size, 3), "i8"),
            "summary": ((size, 3), "f8"),
            "samples": ((size, n_samples, t.size), "f8"),
            "sample_regimes": ((size, n_samples, t.n_components), "i8"),
            "sample_sums": ((size, n_samples, n_sums), "f8"),
            "sample_extremes": ((size, n_between, len(self.watched), 2), "f8"),
            "peaks": ((size, self.n_kinds, t.size), "f8"),
            "half_turns": ((size, self.points.shape[1]), "f8"),
            "event_times": ((size, n_logged), "f8"),
            "event_kinds": ((size, n_logged), "i8"),
            "event_regimes": ((size, n_logged), "i8"),
            "event_states": ((size, n_logged, t.size), "f8"),
        }

    def _counts(self) -> dict[str, int]:
        """Return how many items the loop goes through, and the addresses of code."""
        system, code, t = self.system, self.code, self.system.integrated
        n_constants, n_points = len(t.all_constants), self.points.shape[1]
        n_events = len(t.surfaces) + len(t.outputs)
        n_rows = (
            layout.numbers.first_of_system
            + len(t.variables)
            + t.size
            + 2 * len(self.watched)
        )
        n_rows += len(system.regimes) + 3 * n_points + t.n_components
        n_rows += len(t.parameters) + n_constants
        number: dict[str | None, int] = {kind: i for i, kind in enumerate(t.kinds)}
        options = self.options
        return {
            "n_terms": lanes.taylor_terms(self.tol),
            "n_jobs": self.size,
            "n_states": t.size,
            "n_variables": len(t.variables),
            "n_surfaces": len(t.surfaces),
            "n_outputs": len(t.outputs),
            "n_tracked": len(self.watched),
            "n_parameters": len(t.parameters),
            "n_constants": n_constants,
            "n_regimes": len(system.regimes),
            "n_components": t.n_components,
            "n_table": len(t.constants),
            "n_kinds": self.n_kinds,
            "n_samples": self.sample_times.shape[1],
            "n_sums": sum(count for _, count in self._sums()),
            "n_between": self.sample_times.shape[1] * options.extremes_between,
            "n_logged": options.log_events,
            "n_points": n_points,
            "until": number.get(options.until, -1),
            "late_from": number.get(options.late_from, -1),
            "n_rounds": lanes.ROUNDS,
            "tangent": int(options.tangent),
            "take_step": code.get("series", 0),
            **{name: code.get(name, 0) for name in layout.LOOP_FUNCTIONS},
            "n_series": self.n_series,
            "n_rows": n_rows,
            "n_switches": len(t.switches),
            "n_scratch": max(3 * n_events, len(t.variables), n_constants) + 2,
        }

    def _memory(self, counts: dict[str, int], queue: list[int]) -> dict[str, Any]:
        """Return the arrays that the loop reads and works in, for one process."""
        t, options = self.system.integrated, self.options
        logged = t.kinds if options.logged is None else options.logged
        n_events = len(t.surfaces) + len(t.outputs)
        # outputs are watched in all lanes, surfaces as regimes ask
        active = np.zeros(n_events, np.int64)
        active[[w - len(t.variables) for w, _ in self.watched if w >= t.size]] = -1
        integers = np.full(
            (layout.integers.first_regime + t.n_components, LANES), -1, np.int64
        )
        integers[layout.integers.outcome] = 0  # every lane asks for a job
        # a step's end may differ by a tenth of the tolerance; less than 2e-14 is round-off
        share = max(0.1 * self.tol, 2e-14)
        return {
            "rows": lanes.aligned(counts["n_rows"], LANES),
            "integers": integers,
            **self._series(counts["n_terms"]),
            "sizes": self.sizes,
            "units": lanes.aligned(t.size, LANES),
            "tracked": np.array(self.watched, np.int64),
            "points": self.points,
            "regimes": t.regimes,
            "falls": t.falls,
            "rises": t.rises,
            "component_of": t.component_of,
            "first_constant": t.first_constant,
            "owner": t.owner,
            "marks": t.marks,
            "clocks": t.clocks,
            "ticked": np.zeros((len(t.surfaces), LANES)),
            "active": active,
            "fresh": np.zeros(len(t.surfaces), np.int64),
            "beyond": np.zeros(len(t.surfaces), np.int64),
            "exact": lanes.aligned(t.size + n_events, LANES),
            "steep": self.steep,
            "bent": self.bent,
            "share": np.array([share, self.tol, self.bent.any()], float),
            "noise": np.zeros((len(t.surfaces), 2, LANES)),
            "suspects": np.full(len(t.surfaces), -1, np.int64),
            "scratch": np.zeros((6, counts["n_scratch"])),
            "between": np.zeros((len(self.watched), 2, LANES)),
            "logs": np.array([kind in logged for kind in t.kinds], np.int64),
            "initial": self.initial,
            "parameters": self.parameters,
            "first_regime": self.regimes,
            "limits": self.limits,
            "sample_times": self.sample_times,
            "queue": np.array(queue, np.int64),
        }

    def _series(self, n_terms: int) -> dict[str, np.ndarray]:
        """Return the room for the series, and what they are computed from."""
        return {
            "series": lanes.aligned(self.n_series, n_terms, LANES),
            "inverses": lanes.INVERSES,
        }

    def run(self, arrays: dict[str, np.ndarray], first: int, stride: int) -> None:
        """Every ``stride``-th run from the ``first`` on, in one process."""
        for name in (
            "samples",
            "sample_sums",
            "sample_extremes",
            "event_times",
            "event_states",
            "firsts",
        ):
            arrays[name][first::stride] = np.nan
        arrays["extremes"][first::stride] = [np.inf, -np.inf]
        for name in ("sample_regimes", "event_kinds", "event_regimes"):
            arrays[name][first::stride] = -1
        counts = self._counts()
        memory = arrays | self._memory(counts, [first, self.size, stride])
        # a view of nothing has no address
        memory = {
            name: memory[name] if memory[name].size else np.zeros(1, memory[name].dtype)
            for name in layout.LOOP_ARRAYS
        }
        table = lanes.Workspace(
            layout.LOOP_TABLE,
            memory,
            {name: counts[name] for name in layout.LOOP_SIZES},
        )
        rows, job = memory["rows"], memory["integers"][layout.integers.job]
        at = (
            job,
            rows[layout.numbers.clock],
            rows[layout.numbers.t_end],
            memory["queue"],
        )

        def share() -> float:
            # a lane that begins its first job has a number before it has an end
            with np.errstate(invalid="ignore"):
                return lanes.share_of(*at)

        lanes.drive(self.loop(), table, share)
        if job.max() >= 0 or memory["queue"][0] < self.size:
            raise RuntimeError(
                "an exception in compiled code, reported above, ended the integration before its "
                "runs were finished; please report the parameters"
            )

    def named(
        self, arrays: dict[str, np.ndarray], clock: Any = 1.0
    ) -> dict[str, np.ndarray]:
        """Return the results by name, with ``clock`` as the unit of the times of these runs."""
        extremes = arrays["extremes"]
        arrays["early_extremes"], arrays["late_extremes"] = np.moveaxis(extremes, 2, 0)
        low, high = extremes[..., 0].min(axis=2), extremes[..., 1].max(axis=2)
        arrays["extremes"] = np.stack([low, high], axis=-1)
        columns = arrays.pop("ends").T
        arrays["outcome"], arrays["steps"], arrays["n_events"] = columns
        columns = arrays.pop("summary").T
        arrays["log_growth"], arrays["horizon"], arrays["reached"] = columns
        sums, begin = arrays.pop("sample_sums"), 0
        for name, count in self._sums():
            arrays[f"sample_{name}"] = sums[..., begin : begin + count]
            begin += count
        times = {"durations", "event_times", "firsts", "horizon", "reached"}
        with np.errstate(all="ignore"):
            unit = self.unit * clock
            for name in times | ({"sample_durations"} & set(arrays)):
                values = arrays[name]
                arrays[name] = values * unit.reshape(-1, *(1,) * (values.ndim - 1))
        arrays["first_regimes"] = self.regimes
        return arrays


def _time_units(
    system: System, values: Mapping[str, np.ndarray], t_end: np.ndarray
) -> np.ndarray:
    """Unit of time of each run."""
    scale = system.time_scale
    given = scale(Names("the system", values)) if callable(scale) else float(scale)
    unit = np.broadcast_to(given, t_end.shape).astype(float)
    with np.errstate(over="ignore"):
        fits = (unit > 0.0) & (t_end / unit < math.inf)
    if not fits.all():
        raise ValueError(
            f"{system.name}: time_scale = {unit.min()}: a positive, finite time is needed"
        )
    return unit


def _state_sizes(
    system: System,
    values: Mapping[str, np.ndarray],
    size: int,
    given: np.ndarray | None,
) -> np.ndarray:
    """Return the typical size of each state in each run, (runs, states)."""
    with np.errstate(all="ignore"):
        sizes = system.sizes_in(values) if given is None else given
        rows = np.broadcast_to(sizes, (size, len(system.states))).copy()
        fits = (rows > 0.0) & np.isfinite(1.0 / rows) & np.isfinite(rows)
    if not fits.all():
        run, state = np.argwhere(~fits)[0]
        raise ValueError(
            f"{system.name}: the typical size of {system.states[state]} is "
            f"{rows[run, state]:g}: a positive, finite number is needed"
        )
    return rows


def table_of(size: int, *columns: Any) -> np.ndarray:
    """Columns side by side, each a number or an array (size,)."""
    table = np.empty((size, len(columns)))
    for index, column in enumerate(columns):
        table[:, index] = column
    return table
