"""Ensembles of A1 with laws of the user's own: runs of the brake as a system."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from squealpipe.codes import Event, Regime
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction_laws import FALLING, LAWS
from squealpipe.methods.taylor.loop import STOPPED
from squealpipe.parameters import NUMBERS_OF_A1, Parameters
from squealpipe.schema import Outcome
from squealpipe.solvers.a1.records import MARKS
from squealpipe.solvers.a1.system import UNITS
from squealpipe.systems.brake import ANGLES, brake_of, has_own_laws
from squealpipe.systems.runs import integrate
from squealpipe.systems.system import System
from squealpipe.systems.trace import TIME

if TYPE_CHECKING:
    from squealpipe.solvers.a1.jobs import Jobs

STATE = ("x", "y", "vx", "vy")
FORM = ("preload", "length1", "length2", "damping1", "damping2")
"""Numbers on which the form of the system depends."""


@dataclass(frozen=True)
class OwnLaws:
    """What runs with laws of the user's own need beside their orders.

    Attributes:
        system: the brake with these laws.
        damping3: over √(m k1).
        alpha1, alpha2: angles of each run, rad.
    """

    system: System
    damping3: float
    alpha1: Any = None
    alpha2: Any = None


def split(parameters: Any, model: str) -> tuple[Any, OwnLaws | None]:
    """Parameters under laws that A1's own loop has, and those of the user's own, if any.

    Raises:
        ValueError: a variant of A1 is asked for.
    """
    if isinstance(parameters, Mapping):
        return _split_many(parameters, model)
    if not has_own_laws(parameters):
        return parameters, None
    if model != "A1":
        raise ValueError(
            f"model = {model!r}: a table, a law in Python or a contact law is carried by A1 "
            "alone, not by its variants"
        )
    damping3 = parameters.damping3 * parameters.time_unit / parameters.mass
    own = OwnLaws(brake_of(parameters, observed=True), damping3)
    numbers = {name: getattr(parameters, name) for name in ("mu", "k3", "friction_speed")}
    plain = parameters.with_(
        **numbers,
        mu_static=parameters.static_mu,
        friction_law=FALLING[0],
        contact_law=LINEAR,
        damping3=0.0,
    )
    return plain, own


def _split_many(parameters: Mapping[str, Any], model: str) -> tuple[Any, OwnLaws | None]:
    """As :func:`split`, of numbers that vary under one friction law of the user's own."""
    law = parameters.get("friction_law", FALLING[0])
    if not isinstance(law, str) or law in LAWS or parameters.get("contact_law", LINEAR) != LINEAR:
        return parameters, None
    # The form of the system is that of the largest numbers: with dashpots if any run has one.
    decisive: dict[str, Any] = {
        name: float(np.max(value))
        for name, value in parameters.items()
        if name in FORM and value is not None
    }
    plain, own = split(Parameters(**decisive, friction_law=law), model)
    frictions = ("mu", "mu_static", "friction_speed", "friction_law")
    return {**parameters, **{name: getattr(plain, name) for name in frictions}}, own


def run_system(
    jobs: Jobs, own: OwnLaws, wanted: set[str], tangent: bool, log_events: int, workers: int | None
) -> dict[str, np.ndarray]:
    """The results of :class:`squealpipe.solvers.a1.ensemble.Ensemble` that are asked for."""
    orders = jobs.orders
    if np.isfinite(orders["stop_at_x"]).any() or np.isfinite(orders["stop_at_turns"]).any():
        raise ValueError("a run with laws of one's own has no stop at a displacement or at turns")
    size, t_end = len(orders), orders["t_end"]
    values = {name: orders[name] for name in NUMBERS_OF_A1 if name in (orders.dtype.names or ())}
    values |= {name: np.ones(size) for name in UNITS}
    values |= {"damping3": np.full(size, own.damping3), "alpha1": own.alpha1, "alpha2": own.alpha2}
    values |= dict(zip(STATE, jobs.initial.T, strict=True)) | dict.fromkeys(ANGLES, np.zeros(size))

    starts = own.system.first_regimes({TIME: np.zeros(size), **values}, size)

    def run(ends: np.ndarray, **options: Any) -> _Raw:
        raw = integrate(own.system, values, ends, tol=jobs.tol, workers=workers, **options)
        return _Raw(own.system, raw, jobs, starts)

    room = log_events
    while True:
        whole = run(
            t_end, t_late=orders["t_late"], times=jobs.times, tangent=tangent, log_events=room
        )
        most = int(whole.raw["ends"][:, 3].max(initial=0))
        if not log_events or most <= room:
            break
        room = most
    found = whole.results(log_events)
    # a separation ends a run where that is asked for
    lost = np.isfinite(found["first_separation_time"]) & (orders["stop_at_separation"] > 0)
    found["outcome"] = np.where(lost, Outcome.separated, found["outcome"]).astype(np.int8)
    if any(name.startswith("early") for name in wanted):
        early = run(np.minimum(orders["t_late"], t_end)).results(0)
        found |= {f"early_max_{x}": early[f"max_abs_{x}"] for x in ("x", "vx")}
    if "return_peak_contact_force" in wanted:
        first = whole.first("contact")
        later = run(t_end, t_late=np.where(np.isnan(first), np.inf, first))
        peak = later.extreme("contact_force", late=True)[1] / orders["k3"]
        found["return_peak_contact_force"] = np.where(np.isnan(first), np.nan, peak)
    if "impact_speed" in wanted:
        logged = run(t_end, log_events=int(whole.raw["ends"][:, 3].max(initial=0)))
        found["impact_speed"] = logged.impact_speed()
    if any(name.startswith("mark") for name in wanted):
        marks = [run(mark * t_end, tangent=tangent).results(0) for mark in MARKS]
        for name in ("separated_time", "stick_time", "turns", "log_growth", "separations"):
            found[f"mark_{name}"] = np.stack([each[name] for each in marks], axis=-1)
        found["mark_contacts"] = np.stack([each["contacts"] for each in marks], axis=-1)
        found["mark_state"] = np.stack([each["final_state"] for each in marks], axis=-2)
    return {name: found[name] for name in wanted}


class _Raw:
    """Raw results of the system, read as those of A1."""

    def __init__(
        self, system: System, raw: dict[str, np.ndarray], jobs: Jobs, starts: np.ndarray
    ) -> None:
        self.raw, self.system, self.stiffness = raw, system, jobs.orders["k3"]
        self.t, self.length = jobs.time_unit, jobs.length
        self.speed = self.length / self.t
        self.scale = np.stack([self.length, self.length, self.speed, self.speed], axis=-1)
        self.tracked = [*system.states, *system.outputs]
        self.regimes = np.array([_regime(name) for name in system.regimes] + [-1])
        self.starts_apart = self.regimes[starts] == Regime.separated
        kinds = [Event.__members__.get(name) for name in system.traced.kinds]
        self.kinds = np.array([-1 if kind is None else int(kind) for kind in kinds] + [-1])

    def extreme(self, name: str, *, late: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Smallest and largest value."""
        values = self.raw["extremes"][:, self.tracked.index(name)]
        return (values[:, 2], values[:, 3]) if late else (values[:, 0], values[:, 1])

    def first(self, kind: str) -> np.ndarray:
        """When a kind of event occurred first; NaN: never."""
        place = self.system.traced.kinds.index(kind)
        return np.asarray(self.raw["firsts"][:, place])

    def count(self, kind: Event) -> np.ndarray:
        """How often a kind of event occurred."""
        return np.asarray(self.raw["counts"][:, self.kinds[:-1] == kind].sum(axis=1))

    def spent(self, regime: Regime) -> np.ndarray:
        """The time in a regime of A1."""
        return np.asarray(self.raw["durations"][:, self.regimes[:-1] == regime].sum(axis=1))

    def impact_speed(self) -> np.ndarray:
        """Largest |ẏ| at a return to the belt; NaN: none."""
        falls = np.abs(self.raw["event_states"][:, :, 3])
        at_contact = self.kinds[self.raw["event_kinds"]] == Event.contact
        largest = np.where(at_contact, falls, -np.inf).max(axis=1, initial=-np.inf)
        return np.asarray(np.where(np.isfinite(largest), largest, np.nan) * self.speed)

    def results(self, log_events: int) -> dict[str, np.ndarray]:
        """Attributes of an ensemble that one run of each gives."""
        raw, codes = self.raw, self.raw["ends"][:, 0]
        lost_at = np.where(self.starts_apart, 0.0, self.first("separation"))
        low, high = self.extreme("contact_force")
        half = np.trunc(raw["final"][:, 4:6] / np.pi)
        same = half[:, 0] * half[:, 1] > 0
        turns = 0.5 * np.sign(half[:, 0]) * np.abs(half).min(axis=1)
        counts = {f"{kind.name}s": self.count(kind) for kind in Event}
        distances = np.minimum(self.extreme("distance1")[0], self.extreme("distance2")[0])
        found = {
            "outcome": np.where(codes >= STOPPED, Outcome.singular_geometry, codes).astype(np.int8),
            "time": raw["summary"][:, 2] * self.t,
            "first_separation_time": lost_at * self.t,
            "separated_time": self.spent(Regime.separated) * self.t,
            "stick_time": self.spent(Regime.stick) * self.t,
            "peak_contact_force": high / self.stiffness,
            "lowest_contact_force": np.where(np.isnan(lost_at), low / self.stiffness, 0.0),
            "max_displacement": np.sqrt(self.extreme("reach")[1]) * self.length,
            "max_vx": self.extreme("vx")[1] * self.speed,
            "nearest_pivot": np.sqrt(distances),
            "turns": np.where(same, turns, 0.0),
            **counts,
            "events": np.sum(list(counts.values()), axis=0),
            "steps": raw["ends"][:, 2],
            "final_state": raw["final"][:, :4] * self.scale,
            "final_regime": self.regimes[raw["ends"][:, 1]].astype(np.int8),
            "log_growth": _of_motion(raw["summary"][:, 0]),
            "predictability_horizon": raw["summary"][:, 1] * self.t,
            "samples": raw["samples"][..., :4] * self.scale[:, None],
            "sample_regimes": self.regimes[raw["sample_regimes"]].astype(np.int8),
            **self.events(log_events),
        }
        for name, unit in (("x", self.length), ("vx", self.speed)):
            for late, key in ((False, "max_abs"), (True, "late_max")):
                ends = np.abs(self.extreme(name, late=late)).max(axis=0)
                found[f"{key}_{name}"] = np.where(np.isfinite(ends), ends, 0.0) * unit
        return found

    def events(self, room: int) -> dict[str, np.ndarray]:
        """The first events of A1 of each run; knots of tables are none."""
        raw, size = self.raw, len(self.t)
        kinds = self.kinds[raw["event_kinds"]]
        times, codes = np.full((size, room), np.nan), np.full((size, room), -1, np.int8)
        states = np.full((size, room, 4), np.nan)
        for row in range(size if room else 0):
            kept = np.flatnonzero(kinds[row] >= 0)[:room]
            times[row, : kept.size] = raw["event_times"][row, kept] * self.t[row]
            codes[row, : kept.size] = kinds[row, kept]
            states[row, : kept.size] = raw["event_states"][row, kept, :4] * self.scale[row]
        return {"event_times": times, "event_kinds": codes, "event_states": states}


def _of_motion(growth: np.ndarray) -> np.ndarray:
    """ln of the growth of x, y, ẋ, ẏ, from that of six states of which two angles stay."""
    angles = np.exp(np.minimum(-2.0 * growth, np.log(3.0 * (1.0 - 1e-15)))) / 3.0
    return np.asarray(growth + 0.5 * np.log(1.5 * (1.0 - angles)))


def _regime(name: str) -> Regime:
    """The regime of A1 that one of the system's is part of."""
    return next((each for each in Regime if name.startswith(each.name)), Regime.separated)
