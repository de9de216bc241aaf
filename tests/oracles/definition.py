"""Runs of a system by scipy's DOP853, from the definition of its field, surfaces and resets."""

from types import SimpleNamespace

import numpy as np
from scipy.integrate import solve_ivp


class Definition:
    """A system's functions on floats; what a regime is entered beyond fires at once, by name."""

    def __init__(self, system, parameters, **options):
        self.system, self.options = system, {"rtol": 1e-12, "atol": 1e-12} | options
        self.p = SimpleNamespace(**{**system.parameters, **parameters})

    def at(self, t, state, regime):
        named = dict(zip(self.system.states, state, strict=True))
        constants = SimpleNamespace(**self.system.regimes[regime])
        return t, SimpleNamespace(**named), self.p, constants

    def rates(self, t, state, regime):
        field = self.system.field
        field = field[regime] if isinstance(field, dict) else field
        rates = field(*self.at(t, state, regime))
        return [rates[name] for name in self.system.states]

    def run(self, state, regime, t_end, most=np.inf):
        """(time, kind) of the events, so many at most, and the last state."""
        t, state, events = 0.0, np.array(state, float), []
        while t < t_end and len(events) < most:
            watched = [
                each
                for each in sorted(self.system.switches, key=lambda each: each.name)
                if regime in _several(each.leaves)
            ]
            hit = [e for e in watched if e.when(*self.at(t, state, regime)) < -1e-10]
            if not hit:
                leg = solve_ivp(
                    self.rates,
                    (t, t_end),
                    state,
                    "DOP853",
                    args=(regime,),
                    events=[self._event(each) for each in watched] or None,
                    **self.options,
                )
                t, state = leg.t[-1], leg.y[:, -1]
                if leg.status != 1:
                    break
                met = zip(watched, leg.t_events, strict=True)
                hit = [each for each, times in met if len(times)]
            kind, regime, state = self._switched(hit[0], t, state, regime)
            events.append((t, kind))
        return events, state

    def _event(self, switch):
        def height(t, state, regime):
            return switch.when(*self.at(t, state, regime))

        height.terminal, height.direction = True, -1.0
        return height

    def _switched(self, switch, t, state, regime):
        """The name of the event, the regime and the state behind it."""
        before = self.at(t, state, regime)
        reset = switch.reset(*before) if switch.reset else {}
        names = zip(self.system.states, state, strict=True)
        after = np.array([reset.get(name, value) for name, value in names], float)
        for target in switch.to if isinstance(switch.to, list) else [switch.to]:
            parts = (target, None) if isinstance(target, str) else target
            name, condition, kind = (*parts, switch.name)[:3]
            if condition is None or condition(*before) >= 0.0:
                return kind, name, after
        raise AssertionError("no target")


def _several(names):
    return (names,) if isinstance(names, str) else names
