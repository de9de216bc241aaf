"""Speed and accuracy of the event-driven engine beside other integrators, in one run.

Prints medians and ratios; the ratios are what to compare between machines. What runs in this
process alone is timed by its CPU time, so that others at work on the machine disturb less.
"""

from __future__ import annotations

import importlib.util
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import heyoka
import numpy as np
import xarray as xr

from squealpipe.laws.springs import Geometry
from squealpipe.methods.hybrid import Guard
from squealpipe.methods.taylor import taylor_compiler
from squealpipe.methods.taylor.series import HybridSystem
from squealpipe.methods.taylor.symbols import in_order
from squealpipe.models import switching
from squealpipe.models.a1_automaton import A1Automaton
from squealpipe.parameters import Parameters
from squealpipe.solvers.a1.ensemble import run_ensemble
from squealpipe.solvers.a1.peers import simulate_scipy
from squealpipe.solvers.a1.reference import simulate_reference
from squealpipe.solvers.a1.system import PARAMETERS, REGIME, lane_system
from squealpipe.tasks.dynamics.refinement import refine_validity_map
from squealpipe.tasks.dynamics.runs import simulate, validity_map

PAIRS = 8
T_END = 50.0
BASELINE = Parameters()
SUNDIALS = ("Adams", "BDF") if importlib.util.find_spec("sksundae") else ()
"""Methods of the optional peer scikit-sundae; ``make bench`` installs it."""
COLD = """
import time
import numpy as np
from squealpipe.parameters import Parameters
from squealpipe.tasks.dynamics.runs import validity_map
angles = np.linspace(0, np.pi, 181)
validity_map(Parameters(), angles, angles, workers=1)
print(time.process_time())
"""


def median(
    work: Callable[[], object], repeats: int = 5, clock: Callable[[], float] = time.process_time
) -> float:
    """Median time of a few repeats, s."""
    times = []
    for _ in range(repeats):
        started = clock()
        work()
        times.append(clock() - started)
    return statistics.median(times)


def as_heyoka(system: HybridSystem) -> tuple[list[Any], list[Any]]:
    """Equations and events of a system as heyoka's expressions."""
    names = [variable.arguments[0] for variable in system.variables]
    value: dict[int, Any] = {}
    for node in in_order([*system.rates, *system.events]):
        given = [value.get(id(each), each) for each in node.arguments]
        if node.kind == "variable":
            value[id(node)] = heyoka.make_vars(*given)
        elif node.kind == "parameter":
            value[id(node)] = heyoka.par[system.parameters.index(given[0])]
        elif node.kind == "number":
            value[id(node)] = given[0]
        elif node.kind == "+":
            value[id(node)] = given[0] + given[1]
        elif node.kind == "*":
            value[id(node)] = given[0] * given[1]
        elif node.kind == "joined":
            c1, a1, b1, c2, a2, b2 = given
            value[id(node)] = c1 * (a1 * b1) + c2 * (a2 * b2)
        else:
            value[id(node)] = given[0] ** given[1]
    rates = [value[id(rate)] for rate in system.rates]
    return list(zip(heyoka.make_vars(*names), rates, strict=True)), [
        value[id(event)] for event in system.events
    ]


class ScalarLoop:
    """heyoka's scalar integrator, one run after another, events handled in Python."""

    def __init__(self, tol: float) -> None:
        taylor_compiler.set_up()
        equations, events = as_heyoka(lane_system(linear_springs=False))
        self.integrator = heyoka.taylor_adaptive(
            equations,
            np.zeros(4),
            tol=tol,
            t_events=[heyoka.t_event(event, cooldown=0.0) for event in events],
        )

    def run(self, params: Parameters, alpha1: float, alpha2: float, t_end: float) -> np.ndarray:
        """The state at t_end from rest; parameters in units of m = k1 = l_pre = 1."""
        rules = switching.VARIANT_RULES["A1"]
        p = switching.ScaledParameters.of(params)
        g = Geometry(np.cos(alpha1), np.sin(alpha1), np.cos(alpha2), np.sin(alpha2))
        ta = self.integrator
        ta.time = 0.0
        regime, y, vx = switching.start(0.0, 0.0, 0.0, 0.0, p, g, rules)
        ta.state[:] = 0.0, y, vx, 0.0
        values = dict(zip(("k2", "k3", "mu", "belt_speed"), p[2:6], strict=True))
        values |= {"length1": p.length1, "length2": p.length2, **g._asdict()}
        for name, value in values.items():
            ta.pars[PARAMETERS.index(name)] = value
        while True:
            slips = regime in (switching.SLOWER, switching.FASTER)
            ta.pars[PARAMETERS.index(REGIME[0]) :] = (
                regime != switching.SEPARATED,
                (1.0 if regime == switching.SLOWER else -1.0) if slips else 0.0,
                regime == switching.STICK,
                1.0,
                -1.0,
                1.0 * slips,
                -p.belt_speed if slips else 1.0 * (regime != switching.STICK),
            )
            ta.propagate_until(t_end)
            if ta.time >= t_end:
                return ta.state.copy()
            change = switching.switch(*ta.state, regime, 1.0, p, g, rules)
            regime = change.regime
            ta.state[1], ta.state[2] = change.y, change.vx


def cvode(field: Any, guards: list[Guard], *, method: str, tol: float) -> Any:
    """SUNDIALS CVODE for one regime, stopping at its guards; needs scikit-sundae."""
    from sksundae.cvode import CVODE

    def rhs(t: float, z: np.ndarray, rate: np.ndarray) -> None:
        rate[:] = field(t, z)

    def events(_: float, z: np.ndarray, values: np.ndarray) -> None:
        values[:] = [guard.value(z) for guard in guards]

    events.terminal = [True] * len(guards)  # type: ignore[attr-defined]
    events.direction = [guard.direction for guard in guards]  # type: ignore[attr-defined]
    return CVODE(
        rhs, method=method, rtol=tol, atol=tol, eventsfn=events, num_events=len(guards),
        max_num_steps=100_000,
    )  # fmt: skip


def simulate_sundials(
    params: Parameters, alpha1: float, alpha2: float, *, method: str, tol: float
) -> np.ndarray:
    """The state at T_END by CVODE, restarted at each event."""
    a1 = A1Automaton(params, alpha1, alpha2)
    reached, state = 0.0, np.zeros(4)
    regime = a1.start(state)
    while reached < T_END:
        guards = [Guard(*guard) for guard in a1.guards(regime)]
        solver = cvode(a1.field(regime), guards, method=method, tol=tol)
        solution = solver.solve(np.array([reached, T_END]), state)
        if not solution.success:
            raise RuntimeError(solution.message)
        reached, state = float(solution.t[-1]), np.array(solution.y[-1])
        if solution.i_events is not None and len(solution.i_events):
            hit = int(np.flatnonzero(solution.i_events[-1])[0])
            regime, state = a1.switch(guards[hit].kind, regime, state)
            state = a1.leave(regime, state, float(np.finfo(float).eps))
    return state


def one_by_one(params: Parameters, angles: np.ndarray) -> list[xr.Dataset]:
    """Single runs, each with its own dataset."""
    return [simulate(params, *pair, t_end=T_END, times=[T_END]) for pair in angles]


def compare_integrators() -> None:
    """Milliseconds a run and largest error against long double, over random angles."""
    rng = np.random.default_rng(0)
    for speed in (100.0, 0.3):
        params = BASELINE.with_(belt_speed=speed)
        angles = rng.uniform(0, np.pi, (PAIRS, 2))
        exact = [
            np.asarray(simulate_reference(params, *a, t_end=T_END).state, float) for a in angles
        ]
        many = np.tile(angles, (72, 1))
        loop = ScalarLoop(1e-12)
        rows: list[tuple[str, float, list[np.ndarray]]] = []
        run = run_ensemble(params, *many.T, t_end=T_END, workers=1)
        seconds = median(lambda p=params, m=many: run_ensemble(p, *m.T, t_end=T_END, workers=1))
        rows.append(("ensemble 1e-12", seconds / len(many), list(run.final_state[:PAIRS])))
        ends = one_by_one(params, angles)
        states = [np.array([e.x[0], e.y[0], e.vx[0], e.vy[0]]) for e in ends]
        rows.append(
            (
                "simulate, one run",
                median(lambda p=params, s=angles: one_by_one(p, s)) / PAIRS,
                states,
            )
        )
        states = [loop.run(params, *a, T_END) for a in angles]
        seconds = (
            median(lambda f=loop.run, s=angles, p=params: [f(p, *a, T_END) for a in s]) / PAIRS
        )
        rows.append(("heyoka scalar loop 1e-12", seconds, states))
        methods = [("DOP853", 1e-12), ("DOP853", 1e-10), ("RK45", 1e-10), ("LSODA", 1e-10)]
        for method, tol in methods:
            started = time.process_time()
            states = [
                np.asarray(simulate_scipy(params, *a, t_end=T_END, method=method, tol=tol).state)
                for a in angles
            ]
            seconds = (time.process_time() - started) / PAIRS
            rows.append((f"scipy {method} {tol:g}", seconds, states))
        for method in SUNDIALS:
            started = time.process_time()
            states = [simulate_sundials(params, *a, method=method, tol=1e-10) for a in angles]
            seconds = (time.process_time() - started) / PAIRS
            rows.append((f"CVODE {method} 1e-10", seconds, states))
        print(f"\nA1, V = {speed:g}, t = {T_END:g}, {PAIRS} random angle pairs, one core")
        for name, seconds, states in rows:
            errors = [np.abs(s - e).max() for s, e in zip(states, exact, strict=True)]
            print(
                f"  {name:26} {1e3 * seconds:9.3f} ms a run  {seconds / rows[0][1]:8.1f} × ours"
                f"  error: median {np.median(errors):.1e}, largest {max(errors):.1e}"
            )


def main() -> None:
    """Print the tables."""
    compare_integrators()
    angles = np.linspace(0, np.pi, 24)
    pairs = np.random.default_rng(0).uniform(0, np.pi, (5, 2))
    public = statistics.median(
        median(lambda pair=pair: simulate_scipy(BASELINE, *pair, t_end=200.0, tol=1e-12), repeats=1)
        for pair in pairs
    )
    print("\nEnsembles, T = 200, 24 × 24 angles, all events and outputs, 1e-12, one core")
    print(f"  scipy DOP853 1e-12, 5 random pairs {1e6 * public:7.0f} µs a trajectory")
    for tangent in (False, True):
        seconds = median(
            lambda t=tangent: run_ensemble(
                BASELINE, angles[:, None], angles, t_end=200.0, tangent=t, workers=1
            )
        )
        label = "with predictability horizon" if tangent else "outputs of hammering_map"
        each = seconds / 576
        print(
            f"  {label:30} {1e6 * each:7.1f} µs a trajectory, DOP853 over ours {public / each:.0f}"
        )
    angles = np.linspace(0, np.pi, 181)
    for workers, kind, clock in ((1, "CPU", time.process_time), (None, "wall", time.perf_counter)):
        seconds = median(
            lambda w=workers: validity_map(BASELINE, angles, angles, workers=w), clock=clock
        )
        print(f"  validity map 181 × 181, workers = {workers}: {seconds:.2f} s {kind}")
    cold = [
        float(subprocess.run([sys.executable, "-c", COLD], capture_output=True, check=True).stdout)
        for _ in range(3)
    ]
    print(f"  the same from a cold process, imports included: {statistics.median(cold):.2f} s CPU")
    started = time.perf_counter()
    refined = refine_validity_map(BASELINE, resolution=1441, coarse=91)
    seconds = time.perf_counter() - started
    share = float(refined.computed.mean())
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"  refined map 1441 × 1441: {seconds:.2f} s, {share:.1%} of the runs, {memory:.0f} MiB")


if __name__ == "__main__":
    main()
