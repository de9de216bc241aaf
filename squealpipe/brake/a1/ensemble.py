"""Ensembles of nonlinear runs: any number of runs, each with its own parameters and angles."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from types import SimpleNamespace
from typing import Any

import numpy as np

from squealpipe.brake.a1.jobs import Jobs, jobs_of
from squealpipe.brake.a1.motion_system import regimes_of
from squealpipe.codes import Event, Regime
from squealpipe.laws.springs import fixed_ends, geometry
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome
from squealpipe.systems.integrate import LARGEST, RunOptions
from squealpipe.systems.integrate import integrate as integrate_system
from squealpipe.systems.system import System
from squealpipe.systems.taylor.layout import outcomes
from squealpipe.systems.trace import TIME
from squealpipe.validation import Positive, Seed, Workers, checked

NEAR_PIVOT = 1e-3
"""Distance from a pivot, in free lengths, from which an overflow is its doing."""
LARGEST_REACH, LARGEST_CONTACT_FORCE = f"{LARGEST}reach", f"{LARGEST}contact_force"
TRACKED = ("x", "vx", "contact_force", LARGEST_REACH)
"""Quantities of the system whose extremes an :class:`Ensemble` may hold."""


def _count(kind: Event, counts: str = "counts") -> Any:
    """Number of events of a kind."""
    return property(
        lambda self: self._shaped(
            self._raw[counts][..., self._kinds[:-1] == kind].sum(axis=-1)
        )
    )


def _column(name: str, place: int | None = None) -> Any:
    """A column of the raw results, or all of them."""

    def values(self: Ensemble) -> np.ndarray:
        column = self._raw[name] if place is None else self._raw[name][..., place]
        return self._shaped(column)

    return property(values)


def _turns(name: str) -> Any:
    """Net turns around both fixed ends, to half a turn; 0 where they turn against one another."""

    def turns(self: Ensemble) -> np.ndarray:
        first, second = np.moveaxis(self._raw[name], -1, 0)
        least = 0.5 * np.sign(first) * np.minimum(np.abs(first), np.abs(second))
        return self._shaped(np.where(first * second > 0, least, 0.0))

    return property(turns)


def _spent(regime: Regime, durations: str = "durations") -> Any:
    """Total time in a regime, s."""

    def time(self: Ensemble) -> np.ndarray:
        time_spent = self._raw[durations][..., self._regimes[:-1] == regime].sum(
            axis=-1
        )
        return self._shaped(time_spent)

    return property(time)


def _largest(name: str, part: str) -> Any:
    """Largest |x| or |ẋ|, m or m/s; 0 of a part that was not reached."""

    def size(self: Ensemble) -> np.ndarray:
        ends = np.abs(self._extremes(name, part)).max(axis=0)
        return self._shaped(np.where(np.isfinite(ends), ends, 0.0))

    return property(size)


class Ensemble:
    """Results of an ensemble; arrays have the broadcast shape of its inputs, SI units."""

    separations, contacts = _count(Event.separation), _count(Event.contact)
    sticks = _count(Event.stick)
    slips = _count(Event.slip)
    reversals = _count(Event.reversal)
    separated_time, stick_time = _spent(Regime.separated), _spent(Regime.stick)
    early_max_x, early_max_vx = _largest("x", "early_"), _largest("vx", "early_")
    """Before ``t_late``; those that are late from there on."""
    late_max_x, late_max_vx = _largest("x", "late_"), _largest("vx", "late_")
    sample_separations = _count(Event.separation, "sample_counts")
    """Sums up to each sample, with ``sums``; likewise the following."""
    sample_contacts = _count(Event.contact, "sample_counts")
    sample_separated_time = _spent(Regime.separated, "sample_durations")
    sample_stick_time = _spent(Regime.stick, "sample_durations")
    sample_turns = _turns("sample_half_turns")
    sample_log_growth = _column("sample_growth", 0)
    """The growth is that at the end of the step before."""
    turns, log_growth = _turns("half_turns"), _column("log_growth")
    """Counterclockwise positive; ln of the growth of a perturbation, 0 without ``tangent``."""
    time = _column("reached")
    predictability_horizon = _column("horizon")
    """Time reached, and that at which an error of ``tol`` has grown to l_pre/1000 (NaN: not before
    the end), s."""
    steps, final_state = _column("steps"), _column("final")
    samples = _column("samples")
    """States (…, 4) x, y, ẋ, ẏ at ``times``, m and m/s; NaN past ``time``."""
    event_times = _column("event_times")
    event_states = _column("event_states")
    """The first ``log_events`` events, s, and the states after them; NaN after the last one."""

    def __init__(
        self, jobs: Jobs, raw: dict[str, np.ndarray], tracked: Sequence[str]
    ) -> None:
        self.jobs, self._raw = jobs, raw
        self._tracked = [each.removeprefix(LARGEST) for each in tracked]
        system = jobs.systems[0]
        self._regimes = np.array([*regimes_of(system), -1])
        kinds = [Event.__members__.get(name, -1) for name in system.traced.kinds]
        self._kinds = np.array([*kinds, -1])

    def _shaped(self, values: Any) -> np.ndarray:
        """Values of the runs in the caller's shape."""
        values = np.asarray(values)
        return np.asarray(values.reshape(self.jobs.shape + values.shape[1:]))

    @cached_property
    def _preload_force(self) -> np.ndarray:
        """Return k3 l_pre of each run, N."""
        return np.asarray(self.jobs.values["k3"] * self.jobs.values["preload"])

    def _extremes(self, name: str, part: str = "") -> tuple[np.ndarray, np.ndarray]:
        """Smallest and largest value of a tracked quantity."""
        values = self._raw[f"{part}extremes"][:, self._tracked.index(name)]
        return values[:, 0], values[:, 1]

    @cached_property
    def outcome(self) -> np.ndarray:
        """``schema.Outcome`` of each run."""
        codes = self._raw["outcome"]
        lost = codes >= outcomes.stopped
        hidden = (Outcome.not_finite, Outcome.hidden_event, Outcome.discontinuity)
        unknown = np.isin(codes, hidden)
        if unknown.any():
            # a state that is lost next to a pivot is so by its doing, and so is the sight of it
            lost |= unknown & self._next_to_pivot()
        outcomes_of_runs = np.where(lost, Outcome.singular_geometry, codes)
        outcomes_of_runs[codes == outcomes.by_event] = Outcome.separated
        outcomes_of_runs[codes == outcomes.by_turns] = Outcome.amplitude_reached
        if self.jobs.stop_at_first_separation:
            outcomes_of_runs[self._raw["starts_apart"]] = Outcome.separated
        return self._shaped(outcomes_of_runs.astype(np.int8))

    def _next_to_pivot(self) -> np.ndarray:
        """Return whether each run ended next to the fixed end of a spring."""
        away = self._raw["final"][:, None, :2] - self._raw["points"]
        lengths = np.stack(
            [self.jobs.values[name] for name in ("length1", "length2")], axis=-1
        )
        near = np.linalg.norm(away, axis=-1) < NEAR_PIVOT * lengths
        return np.asarray(near.any(axis=1))

    @cached_property
    def first_separation_time(self) -> np.ndarray:
        """s, NaN where contact was never lost."""
        firsts = self._raw["firsts"][:, self._kinds[:-1] == Event.separation]
        lost = np.where(
            self._raw["starts_apart"], 0.0, np.fmin.reduce(firsts, 1, initial=np.nan)
        )
        return self._shaped(lost)

    @property
    def peak_contact_force(self) -> np.ndarray:
        """Largest N/(k3 l_pre); 0 where no step was made."""
        largest = np.maximum(self._extremes("contact_force")[1], 0.0)
        return self._shaped(largest / self._preload_force)

    @property
    def lowest_contact_force(self) -> np.ndarray:
        """Smallest N/(k3 l_pre); 0 where contact was lost."""
        lowest = self._extremes("contact_force")[0] / self._preload_force
        kept = np.isnan(self.first_separation_time.reshape(-1))
        return self._shaped(np.where(kept, lowest, 0.0))

    @property
    def return_peak_contact_force(self) -> np.ndarray:
        """The largest from the first return to the belt on; NaN: none."""
        peak = self._extremes("contact_force", "late_")[1] / self._preload_force
        return self._shaped(np.where(np.isfinite(peak), peak, np.nan))

    @property
    def impact_speed(self) -> np.ndarray:
        """Largest |ẏ| at a return to the belt, m/s; NaN: none."""
        fastest = self._raw["peaks"][:, self._kinds[:-1] == Event.contact, 3].max(
            axis=1, initial=0
        )
        speed = np.where(self.contacts.reshape(-1) > 0, fastest, np.nan)
        return self._shaped(speed)

    @property
    def max_displacement(self) -> np.ndarray:
        """Largest √(x² + y²), m; 0 where no step was made."""
        square = np.maximum(self._extremes("reach")[1], 0.0)
        return self._shaped(np.sqrt(square))

    @property
    def max_vx(self) -> np.ndarray:
        """Largest ẋ, m/s."""
        return self._shaped(self._extremes("vx")[1])

    @cached_property
    def events(self) -> np.ndarray:
        """Their sum."""
        return self._shaped(self._raw["counts"][:, self._kinds[:-1] >= 0].sum(axis=1))

    def between_samples(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Smallest and largest value of a tracked quantity since the instant before each sample.

        Lengths and velocities in SI units, the contact force over k3 l_pre; NaN past ``time``.
        """
        values = self._raw["sample_extremes"][:, :, self._tracked.index(name)]
        if name == "contact_force":
            values = values / self._preload_force[:, None, None]
        low, high = np.moveaxis(values, -1, 0)
        return self._shaped(low), self._shaped(high)

    @property
    def sample_regimes(self) -> np.ndarray:
        """Regimes there; −1 past ``time``."""
        return self._shaped(
            self._regimes[self._raw["sample_regimes"][..., 0]].astype(np.int8)
        )

    @property
    def logged(self) -> np.ndarray:
        """True if the log holds all events of a run."""
        return np.asarray(self.events <= self._raw["event_times"].shape[1])

    @property
    def event_kinds(self) -> np.ndarray:
        """Their kinds; −1 after the last one."""
        return self._shaped(self._kinds[self._raw["event_kinds"]].astype(np.int8))


@checked
def run_ensemble(
    parameters: Parameters | Mapping[str, Any],
    alpha1: Any,
    alpha2: Any,
    *,
    tracked: Sequence[str] = TRACKED,
    sums: bool = False,
    extremes_between: bool = False,
    tangent: bool = False,
    log_events: Seed = 0,
    size: Positive = 1.0,
    turns: bool = True,
    workers: Workers = None,
    **options: Any,
) -> Ensemble:
    """Integrate many runs at once.

    Args:
        parameters, alpha1, alpha2, options: as :func:`squealpipe.brake.a1.jobs.jobs_of` has
            them; the results have the shape to which they are broadcast.
        tracked: of :data:`TRACKED`, those whose extremes are read.
        sums: keep what has added up at ``times``, too.
        extremes_between: keep the extremes of what is tracked between these instants, for
            :meth:`Ensemble.between_samples`.
        log_events: number of events a run to keep; knots of a law's table are none of A1.
        size: of the motion, over l_pre; ``tol`` is relative to it. Steps grow by its 14th root at a
            tolerance of 1e-9, by its 10th root at 1e-6.
        turns: count those around the fixed ends, which may also end a run.
        workers: processes; None takes all cores. The results are the same bit for bit.
    """
    jobs = jobs_of(parameters, alpha1, alpha2, **options)
    return integrate(
        jobs,
        tracked,
        sums=sums,
        extremes_between=extremes_between,
        tangent=tangent,
        log_events=log_events,
        size=size,
        turns=turns,
        workers=workers,
    )


def integrate(jobs: Jobs, tracked: Sequence[str], **options: Any) -> Ensemble:
    """The results of some runs; the arguments are those of :func:`run_ensemble`."""
    parts = [
        (rows, _run(jobs, system, rows, tracked, **options))
        for system, rows in jobs.groups()
    ]
    _, raw = parts[0]
    if len(parts) > 1:
        size = len(jobs.t_end)
        raw = {
            key: np.empty((size, *first.shape[1:]), first.dtype)
            for key, first in raw.items()
        }
        for rows, part in parts:
            for key, values in part.items():
                raw[key][rows] = values
    return Ensemble(jobs, raw, tracked)


def _run(
    jobs: Jobs,
    system: System,
    rows: Any,
    tracked: Sequence[str],
    workers: int | None = None,
    size: float = 1.0,
    turns: bool = True,
    **options: Any,
) -> dict[str, np.ndarray]:
    """Raw results of the runs of one system, one row each."""
    values = {name: value[rows] for name, value in jobs.values.items()}
    sizes = None
    if size != 1.0:
        lengths = size * values["preload"]
        speeds = lengths * np.sqrt(values["k1"] / values["mass"])
        sizes = np.stack([lengths, lengths, speeds, speeds], axis=-1)
    t_end, t_late = jobs.t_end[rows], jobs.t_late[rows]
    is_apart = np.array([name in {"separated", "released"} for name in system.regimes])
    first = None
    if jobs.stop_at_first_separation:  # what starts apart has ended
        now = {TIME: np.zeros(len(t_end)), **values}
        first = system.first_regimes(now, len(t_end))
        t_end = np.where(is_apart[first[:, 0]], 0.0, t_end)
    g = geometry(values["alpha1"], values["alpha2"])
    points = np.stack(fixed_ends(SimpleNamespace(**values), g), axis=-1).reshape(
        -1, 2, 2
    )
    until = "separation" if jobs.stop_at_first_separation else None
    most_steps, most_events = jobs.most
    raw = integrate_system(
        system,
        values,
        t_end,
        RunOptions(
            regime=first,
            t_late=t_late,
            late_from="contact" if jobs.late_from_return else None,
            until=until,
            around=points if turns else None,
            most_turns=jobs.stop_at_turns,
            tracked=tracked,
            times=jobs.times[rows],
            logged=Event.__members__,
            most_steps=most_steps[rows],
            most_events=most_events[rows],
            unit_sizes=sizes,
            **options,
        ),
        tol=jobs.tol,
        workers=workers,
    )
    apart = is_apart[raw.pop("first_regimes")[:, 0]]
    return raw | {"starts_apart": apart, "points": points}


def run_map(
    parameters: Parameters,
    alpha1: np.ndarray,
    alpha2: np.ndarray,
    results: Callable[[Ensemble], Mapping[str, np.ndarray]],
    *,
    at_once: int = 2**17,
    **options: Any,
) -> dict[str, np.ndarray]:
    """Results of runs over 1-D arrays of both angles, rad, made in blocks of rows.

    Args:
        results: what is kept of the runs of a block, each over (alpha1, alpha2).
        at_once: runs in a block, at least one row.
    """
    rows = max(1, at_once // alpha2.size)
    blocks = [
        results(
            run_ensemble(
                parameters, alpha1[first : first + rows, None], alpha2, **options
            )
        )
        for first in range(0, alpha1.size, rows)
    ]
    return {
        name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]
    }
