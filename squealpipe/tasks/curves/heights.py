"""How high the mass rises in a run from rest, and how that changes with two parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction_laws import COULOMB, FALLING
from squealpipe.laws.tables import is_table
from squealpipe.methods.taylor.loop import STOPPED
from squealpipe.methods.union_boundary import Heights, Vector
from squealpipe.models.switching import VARIANT_RULES
from squealpipe.parameters import NUMBERS_OF_A1, Parameters
from squealpipe.systems.pressed import FRICTION, STATES, Pressed, pressed
from squealpipe.systems.runs import integrate
from squealpipe.text import suggestion

RATIOS = {"kappa": "k3", "lambda_": "length1"}
"""Ratios that may vary → the parameter that they are in units of m = k1 = l_pre = 1."""
VARIED = (
    "alpha1",
    "alpha2",
    *RATIOS,
    *(set(NUMBERS_OF_A1) - {"mass", "k1", "preload", "static_mu"}),
)
"""What may vary; units must not."""
_STEP = 1e-20
"""Of the complex steps that give slopes of the limit of stick."""
_LOG = 0.8
"""Turning points of y in a unit of time, at first; a run that has more is made again."""


class HeightsOfRuns:
    """Maxima of y, over l_pre, of runs from rest that are kept in contact, at any two parameters.

    Args:
        params, angles: what does not vary.
        names: the two parameters that do, of :data:`VARIED`.
        t_end: end of the runs, s.
        model: "A1" or a variant of it that loses contact.
        tol: tolerance.
        workers: processes; None takes all cores.
    """

    def __init__(
        self,
        params: Parameters,
        angles: Mapping[str, float],
        names: Sequence[str],
        *,
        t_end: float,
        model: str = "A1",
        tol: float = 1e-12,
        workers: int | None = None,
    ) -> None:
        for name in names:
            if name not in VARIED:
                raise ValueError(f"{name!r} cannot vary; {suggestion(name, VARIED)}")
        if params.contact_law != LINEAR or is_table(params.friction_law):
            raise ValueError(
                f"contact_law = {params.contact_law!r}, friction_law = {params.friction_law!r}: "
                "maxima of y are followed with the linear contact law and a smooth friction law"
            )
        self.rules, self.tol, self.workers = VARIANT_RULES[model], tol, workers
        self.end = t_end / params.time_unit
        units = _units(params)
        self.fixed = {
            name: float(getattr(params, name)) / units.get(name, 1.0) for name in NUMBERS_OF_A1
        } | dict(angles)
        self.changes = [self._change(params, name, units) for name in names]
        law = params.friction_law
        if law in FALLING and params.static_mu == params.mu:
            law = COULOMB
        damped = params.damping1 + params.damping2 > 0.0
        kind: dict[str, Any] = {
            "damped": damped or not {"damping1", "damping2"}.isdisjoint(names),
            "linear_springs": self.rules.linear_springs,
            "drags": self.rules.drags,
        }
        self.equations = Pressed(law, **kind)
        groups = tuple(tuple(change) for change in self.changes)
        self.system = pressed(law, groups, reverses=self.rules.reverses, **kind)
        self.runs = 0

    @staticmethod
    def _change(params: Parameters, name: str, units: Mapping[str, float]) -> dict[str, float]:
        """Parameters in the runs' units → how much they are of the one that varies."""
        if name == "lambda_":
            return {"length1": 1.0, "length2": params.length2 / params.length1}
        if name == "mu" and params.mu_static is None:
            return {"mu": 1.0, "static_mu": 1.0}
        given = {"mu_static": "static_mu"}.get(name, RATIOS.get(name, name))
        return {given: 1.0 if name in RATIOS else 1.0 / units.get(name, 1.0)}

    def parameters(self, points: Vector) -> dict[str, Vector]:
        """Parameters of runs at values of the two that vary, (runs, 2)."""
        found = {name: np.full(len(points), value) for name, value in self.fixed.items()}
        for column, change in enumerate(self.changes):
            for name, slope in change.items():
                found[name] = points[:, column] * slope
        return found

    def __call__(self, points: Vector) -> list[Heights]:
        """The heights at values of the two parameters, (runs, 2)."""
        size = len(points)
        self.runs += size
        p = self.parameters(points)
        extra = {
            f"change{i}_{n}": np.full(size, w)
            for i, c in enumerate(self.changes)
            for n, w in c.items()
        }
        state = np.zeros((size, len(self.system.states)))
        friction = np.where(p["belt_speed"] > 0.0, 0, 1)
        if self.rules.sticks:
            friction[p["belt_speed"] == 0.0] = 2
        regime, time, rows = 2 * friction, np.zeros(size), np.arange(size)
        found: list[tuple[Any, ...]] = []
        while rows.size:
            values = {n: np.ascontiguousarray(v[rows]) for n, v in (p | extra).items()}
            values |= {
                n: np.ascontiguousarray(state[rows, i]) for i, n in enumerate(self.system.states)
            }
            raw = self._integrate(
                values | {"first_regime": regime[rows] + 0.0}, self.end - time[rows]
            )
            kept = raw["event_kinds"] == self.system.traced.kinds.index("maximum")
            owner, _ = np.nonzero(kept)
            found.append(
                (
                    rows[owner],
                    time[rows[owner]] + raw["event_times"][kept],
                    raw["event_states"][kept],
                )
            )
            state[rows], regime[rows] = raw["final"], raw["ends"][:, 1]
            time[rows] += raw["summary"][:, 2]
            stop = raw["ends"][:, 0] - STOPPED
            rows, stop = rows[stop >= 0], stop[stop >= 0]
            if rows.size:
                part = SimpleNamespace(**{n: v[rows] for n, v in p.items()})
                state[rows], regime[rows] = self._switch(state[rows], regime[rows], stop, part)
        owner, times, states = (np.concatenate(each) for each in zip(*found, strict=True))
        return self._collect(owner, times, states, state, time, SimpleNamespace(**p))

    def _integrate(self, values: dict[str, Vector], ends: Vector) -> dict[str, Vector]:
        room = int(_LOG * ends.max()) + 8
        while True:
            raw = integrate(
                self.system, values, ends, tol=self.tol, log_events=room, workers=self.workers
            )
            most = int(raw["ends"][:, 3].max())
            if most <= room:
                return raw
            room = most

    def _switch(self, state: Vector, regime: Any, stop: Any, p: Any) -> tuple[Vector, Any]:
        """State, slopes and regime after a change of friction."""
        s = SimpleNamespace(**dict(zip(STATES, state.T, strict=False)))
        before, way = regime // 2, regime % 2
        slower, faster, stick = range(3)
        limits = np.array(self.equations.margins(s, p))
        after = np.where(before == slower, faster, slower)
        if self.rules.sticks:
            after = np.where((before != stick) & (limits >= 0.0).all(axis=0), stick, after)
        after = np.where(before == stick, np.where(stop == 1, faster, slower), after)
        rates = []
        for friction in (before, after):
            direction, sticks = (
                np.array([f[i] for f in FRICTION.values()])[friction] for i in (0, 1)
            )
            r = SimpleNamespace(direction=direction, stick=sticks)
            rates.append(np.array(self.equations.accelerations(s, p, r)))
        speed = p.belt_speed
        path = np.array([s.vx, s.vy, rates[0][0], rates[0][1]])
        state = state.copy()
        for i, change in enumerate(self.changes):
            delta = state[:, 4 * (i + 1) : 4 * (i + 2)]
            moved = 1j * _STEP * delta.T
            there = [getattr(s, name) + step for name, step in zip(STATES, moved, strict=True)]
            margin = self._slope_of_margin(there, p, change, stop)
            rate = self._slope_of_margin(
                [getattr(s, n) + 1j * _STEP * v for n, v in zip(STATES, path, strict=True)],
                p,
                {},
                stop,
            )
            with np.errstate(all="ignore"):
                late = np.where(
                    before == stick,
                    -margin / rate,
                    (change.get("belt_speed", 0.0) - delta[:, 2]) / rates[0][0],
                )
            delta[:, 2] += (rates[0][0] - rates[1][0]) * late
        state[:, 2] = np.where(before == stick, state[:, 2], speed)
        return state, 2 * after + way

    def _slope_of_margin(
        self, there: list[Any], p: Any, change: Mapping[str, float], stop: Any
    ) -> Any:
        moved = dict(vars(p)) | {n: getattr(p, n) + 1j * _STEP * w for n, w in change.items()}
        margins = self.equations.margins(
            SimpleNamespace(**dict(zip(STATES, there, strict=True))), SimpleNamespace(**moved)
        )
        return np.where(stop == 1, *np.imag(margins)) / _STEP

    def _collect(
        self, owner: Any, times: Vector, states: Vector, final: Vector, reached: Vector, p: Any
    ) -> list[Heights]:
        """One record of each run: its maxima in order of time, and its end."""
        size = len(final)
        owner = np.concatenate([owner, np.arange(size)])
        times, states = np.concatenate([times, reached]), np.concatenate([states, final])
        order = np.lexsort((times, owner))
        owner, times, states = owner[order], times[order], states[order]
        of = SimpleNamespace(**{n: v[owner] for n, v in vars(p).items()})
        s = SimpleNamespace(**dict(zip(STATES, states.T, strict=False)))
        r = SimpleNamespace(direction=0.0, stick=1.0)
        bend = self.equations.accelerations(s, of, r)[1]
        rates = states[:, [7, 11]]
        drift = -rates / bend[:, None]
        last = np.cumsum(np.bincount(owner, minlength=size)) - 1
        first = np.concatenate([[0], last[:-1] + 1])
        return [
            Heights(
                times[a : b + 1], states[a : b + 1, 1] - 1.0, states[a : b + 1, [5, 9]],
                drift[a : b + 1], float(s.vy[b]), rates[b], float(bend[b]),
            )
            for a, b in zip(first, last, strict=True)
        ]  # fmt: skip


def _units(params: Parameters) -> dict[str, float]:
    """Units m = k1 = l_pre = 1 of the parameters that are no ratios already."""
    speed = params.preload / params.time_unit
    return {
        "mass": params.mass,
        **dict.fromkeys(("k1", "k2", "k3"), params.k1),
        **dict.fromkeys(("preload", "length1", "length2"), params.preload),
        **dict.fromkeys(("belt_speed", "friction_speed"), speed),
        **dict.fromkeys(("damping1", "damping2"), params.k1 * params.time_unit),
    }
