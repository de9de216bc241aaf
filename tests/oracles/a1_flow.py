"""A1 as a flow with derivative: its automaton under :mod:`tests.oracles.event_flow`."""

from functools import cache

import numpy as np
from scipy.optimize import minimize_scalar

from squealpipe.codes import Event, Regime
from squealpipe.laws.friction_laws import coefficient
from squealpipe.laws.springs import fixed_ends
from squealpipe.models.a1_automaton import A1Automaton, EventKind
from squealpipe.models.damped import is_undamped
from tests.oracles.a1_long_double import (
    PARAMETERS,
    SURFACES,
    VARIED,
    regime_values,
    symbolic_automaton,
)
from tests.oracles.event_flow import Switched, Touch, compile_flow, sample_path, turning_points

ULP = 2.0**-52
_PIVOT = 1e-3
"""A distance from a pivot over the spring's length at which a cycle counts as meeting it."""
_TANGENT, _BEFORE = 1e-4, 1e-3
"""Share of the friction limit, or of the speeds, within which an event is at a tangent, the share
of the period before it."""
_TOUCHES: dict[tuple[tuple[int, ...], tuple[int, ...]], Touch] = {
    ((Event.separation, Event.contact), ()): Touch.graze,
    ((Event.contact, Event.separation), ()): Touch.graze,
    ((Event.stick, Event.slip), ()): Touch.touch,
    ((Event.reversal, Event.reversal), ()): Touch.touch,
    ((Event.slip, Event.stick), ()): Touch.split,
    ((Event.stick, Event.slip), (Event.reversal,)): Touch.passing,
    ((Event.reversal,), ()): Touch.meeting,
}
"""Events that stand in place of others → what has happened."""


@cache
def _compiled(law):
    return compile_flow(*symbolic_automaton(law), len(PARAMETERS), VARIED)


class A1Flow:
    """A1 at given parameters and angles, for :mod:`tests.oracles.event_flow`.

    Args:
        params: physical parameters.
        alpha1, alpha2: angles, rad.
        follow: name of a parameter or angle that derivatives are taken by.
        unit: of that parameter.
    """

    def __init__(self, params, alpha1, alpha2, *, follow=None, unit=1.0):
        self.params = params
        self.a1 = A1Automaton(params, alpha1, alpha2)
        self.has_families = is_undamped(params)
        self.jumps = params.static_mu != float(coefficient(0.0, params))
        self.integrator, self._slopes, self._gradients = _compiled(params.friction_law)
        self._values = {regime: regime_values(self.a1, regime) for regime in Regime}
        behind = [*(unit * self._changes(follow)), 0.0]
        self._behind = np.array([[*self._values[regime], *behind] for regime in Regime])

    def _changes(self, follow):
        """Change of :data:`PARAMETERS` with one parameter or angle."""
        g = self.a1.geometry
        changes: dict[str | None, dict[str, float]] = {
            None: {},
            "alpha1": {"c1": -g.s1, "s1": g.c1},
            "alpha2": {"c2": -g.s2, "s2": g.c2},
            "mu": {"mu": 1.0, "static_mu": float(self.params.mu_static is None)},
            "mu_static": {"static_mu": 1.0},
        }
        change = changes.get(follow, {str(follow): 1.0})
        return np.array([change.get(name, 0.0) for name in PARAMETERS[:VARIED]])

    def parameters(self, regime):
        """Values of the symbolic parameters in a regime."""
        return self._values[Regime(regime)]

    def start(self, state):
        """The regime of a state, and the state off any surface."""
        regime = self.a1.start(state)
        return regime, self.a1.leave(regime, state, ULP)

    def switch(self, surface, regime, state):
        """What follows when a surface is met."""
        kind = SURFACES[surface]
        if kind == EventKind.separation and regime == Regime.separated:
            kind = EventKind.contact
        after, on_surface = self.a1.switch(kind, regime, state)
        gradient = None
        if kind in {EventKind.belt_speed, EventKind.release}:
            values = self._gradients(on_surface, pars=self._behind[regime])
            gradient = values.reshape(-1, len(state) + 1)[surface]
        return Switched(
            int(_event(kind, after)), after, self.a1.leave(after, on_surface, ULP), gradient
        )

    def velocity(self, regime, state):
        """The field of a regime."""
        return np.array(self.a1.field(regime)(0.0, state))

    def slopes(self, regimes, states):
        """Derivatives of ẍ and ÿ by state and parameter, (2, 5, n), at states (4, n)."""
        values = self._slopes(states, pars=np.ascontiguousarray(self._behind[regimes].T))
        return np.asarray(values).reshape(2, 5, -1)

    def jacobian(self, regime, state):
        """∂f/∂z of a regime, (4, 4)."""
        slopes = self.slopes(np.array([regime]), state[:, None])
        return np.vstack([np.eye(2, 4, 2), slopes[:, :4, 0]])

    def holds(self, regime):
        """Whether a regime fixes a component of the state: stick."""
        return regime == Regime.stick

    def touch_of(self, extra, missing):
        """What has happened where the kinds ``extra`` stand in place of ``missing``."""
        return _TOUCHES.get((extra, missing))

    def clearance(self, touch, passage):
        """How far a motion that was kept is from a touch; infinite where none is near.

        In m for contact, m/s for belt speed, N for the limit of stick.
        """
        p, segments = self.params, passage.segments
        distances: list[float] = []
        if touch == Touch.graze:
            distances = [abs(point.value - p.preload) for point in turning_points(segments, 1)]
        elif touch == Touch.touch:
            distances = [
                abs(point.value - p.belt_speed)
                for point in turning_points(segments, 2)
                if _is_inside(point, segments[point.segment])
            ]
        elif touch == Touch.split:
            distances = [self._least_margin(part) for part in segments if self.holds(part.regime)]
        else:
            for kind, state in zip(passage.event_kinds, passage.event_states, strict=True):
                if touch == Touch.passing and kind == Event.reversal:
                    distances.append(abs(self.a1.pull(state)) - self.a1.grip(state))
                elif touch == Touch.meeting and kind in {Event.separation, Event.contact}:
                    distances.append(abs(self.a1.lag(state)))
        return min(distances, default=np.inf)

    def unit_of(self, touch):
        """The unit of a clearance: l_pre, l_pre √(k1/m) or μs k3 l_pre."""
        p = self.params
        if touch in {Touch.split, Touch.passing}:
            return max(p.static_mu * p.k3 * p.preload, 1e-300)
        return p.preload if touch == Touch.graze else p.preload / p.time_unit

    def overlap(self, touch, passage, first):
        """How far a motion is beyond a touch whose first event has the index ``first``.

        A depth over :meth:`unit_of`, or the time between the events over √(m/k1) (squared where it
        grows as a root).
        """
        times = np.array(passage.event_times) / self.params.time_unit
        if touch == Touch.meeting:
            places = [i for i in (first - 1, first + 1) if 0 <= i < len(times)]
            return min((abs(float(times[i] - times[first])) for i in places), default=np.inf)
        between = passage.segments[first + 1]
        duration = float(times[first + 1] - times[first])
        if touch == Touch.passing:
            return duration
        if touch == Touch.split or self.holds(between.regime):
            return duration * duration
        graze = touch == Touch.graze
        surface = self.params.preload if graze else self.params.belt_speed
        depths = [
            abs(point.value - surface) for point in turning_points([between], 1 if graze else 2)
        ]
        return max(depths) / self.unit_of(touch) if depths else duration * duration

    def is_singular(self, passage):
        """Whether a motion that was kept comes next to a pivot, where d = 0."""
        p, ends = self.params, fixed_ends(self.params, self.a1.geometry)
        for part in passage.segments:
            place = part.coefficients[:, :2, 0]
            for length, pivot in ((p.length1, ends[:2]), (p.length2, ends[2:])):
                if (np.hypot(*(place - np.array(pivot)).T) < _PIVOT * length).any():
                    return True
        return False

    def is_tangent(self, passage):
        """Whether a motion that was kept touches stick, or a release from it, at a tangent."""
        p, parts = self.params, passage.segments
        duration = parts[-1].times[-1]
        places = np.concatenate([part.coefficients[:, :, 0] for part in parts])
        speed = _TANGENT * float(np.ptp(places[:, 2]))
        force = _TANGENT * p.static_mu * p.k3 * p.preload
        if self.clearance(Touch.touch, passage) < speed:
            return True
        if min(self.clearance(touch, passage) for touch in (Touch.split, Touch.passing)) < force:
            return True
        for kind, part in zip(passage.event_kinds, parts, strict=False):
            before = float(part.times[-1] - _BEFORE * duration)
            if before <= part.times[0] or part.regime == Regime.separated:
                continue
            if kind == Event.slip:
                depth, limit = self._margin(part, before), force
            elif kind in {Event.stick, Event.reversal}:
                end = sample_path([part], part.times[-1:])[0]
                depth, limit = self.velocity(part.regime, end)[2], 10.0 * speed / p.time_unit
            else:
                continue
            if abs(depth) < limit:
                return True
        return False

    def _least_margin(self, segment):
        """Smallest μs N − |x-force| of a stick away from its end, N; infinite where it falls."""
        inside = np.linspace(segment.times[0], segment.times[-1], 8 * len(segment.times) + 1)
        path = sample_path([segment], inside)
        margin = np.array([self.a1.grip(z) - abs(self.a1.pull(z)) for z in path])
        low = np.flatnonzero((margin[1:-1] < margin[:-2]) & (margin[1:-1] <= margin[2:])) + 1
        least = np.inf
        for place in low:
            found = minimize_scalar(
                lambda time: self._margin(segment, float(time)),
                bounds=(inside[place - 1], inside[place + 1]), method="bounded",
                options={"xatol": 1e-12},
            )  # fmt: skip
            least = min(least, float(found.fun))
        return least

    def _margin(self, segment, time):
        state = sample_path([segment], np.array([time]))[0]
        return self.a1.grip(state) - abs(self.a1.pull(state))


def _is_inside(point, part):
    """Whether a turning point is in slip and not its first instant, after a stick."""
    late = point.time - part.times[0] > 1e-6 * (part.times[-1] - part.times[0])
    return late and part.regime in {Regime.slip_slower, Regime.slip_faster}


def _event(kind, after):
    if kind == EventKind.separation:
        return Event.separation
    if kind == EventKind.contact:
        return Event.contact
    if kind == EventKind.release:
        return Event.slip
    return Event.stick if after == Regime.stick else Event.reversal
