"""Speed and accuracy of the event-driven engine beside other integrators, in one run.

Prints medians and ratios; the ratios are what to compare between machines.
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
from squealpipe.methods import taylor_compiler
from squealpipe.methods.hybrid import Guard
from squealpipe.models import switching
from squealpipe.models.a1_automaton import A1Automaton
from squealpipe.parameters import Parameters
from squealpipe.tasks.a1_system import PARAMETER_INDEX, lane_system
from squealpipe.tasks.dynamics import simulate, validity_map
from squealpipe.tasks.ensemble import run_ensemble
from squealpipe.tasks.peers import simulate_scipy
from squealpipe.tasks.reference import simulate_reference
from squealpipe.tasks.refinement import refine_validity_map

PAIRS = 8
T_END = 50.0
BASELINE = Parameters()
SUNDIALS = ("Adams", "BDF") if importlib.util.find_spec("sksundae") else ()
"""Methods of the optional peer scikit-sundae; ``make bench`` installs it."""
COLD = """
import time; started = time.perf_counter()
import numpy as np
from squealpipe.parameters import Parameters
from squealpipe.tasks.dynamics import validity_map
angles = np.linspace(0, np.pi, 181)
validity_map(Parameters(), angles, angles)
print(time.perf_counter() - started)
"""


def median(work: Callable[[], object], repeats: int = 5) -> float:
    """Median wall time, s."""
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return statistics.median(times)


class ScalarLoop:
    """heyoka's scalar integrator, one run after another, events handled in Python."""

    def __init__(self, tol: float) -> None:
        taylor_compiler.set_up()
        system = lane_system(linear_springs=False, tangent=False)
        self.integrator = heyoka.taylor_adaptive(
            list(system.equations),
            np.zeros(4),
            tol=tol,
            t_events=[heyoka.t_event(event, cooldown=0.0) for event in system.events],
        )

    def run(self, params: Parameters, alpha1: float, alpha2: float, t_end: float) -> np.ndarray:
        """The state at t_end from rest; parameters in units of m = k1 = l_pre = 1."""
        rules = switching.VARIANT_RULES["A1"]
        p = switching.ScaledParameters(
            1.0, 1.0, params.k2, params.k3, params.mu, params.belt_speed, 1.0,
            params.length1, params.length2,
        )  # fmt: skip
        g = Geometry(np.cos(alpha1), np.sin(alpha1), np.cos(alpha2), np.sin(alpha2))
        ta = self.integrator
        ta.time = 0.0
        regime, y, vx = switching.start(0.0, 0.0, 0.0, 0.0, p, g, rules)
        ta.state[:] = 0.0, y, vx, 0.0
        values = dict(zip(("k2", "k3", "mu", "belt_speed"), p[2:6], strict=True))
        values |= {"length1": p.length1, "length2": p.length2, **g._asdict()}
        for name, value in values.items():
            ta.pars[PARAMETER_INDEX[name]] = value
        while True:
            slips = regime in (switching.SLOWER, switching.FASTER)
            ta.pars[10:] = (
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
            started = time.perf_counter()
            states = [
                np.asarray(simulate_scipy(params, *a, t_end=T_END, method=method, tol=tol).state)
                for a in angles
            ]
            seconds = (time.perf_counter() - started) / PAIRS
            rows.append((f"scipy {method} {tol:g}", seconds, states))
        for method in SUNDIALS:
            started = time.perf_counter()
            states = [simulate_sundials(params, *a, method=method, tol=1e-10) for a in angles]
            seconds = (time.perf_counter() - started) / PAIRS
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
    print("\nEnsembles, T = 200, 24 × 24 angles, all events and outputs, 1e-12, one core")
    for tangent in (False, True):
        seconds = median(
            lambda t=tangent: run_ensemble(
                BASELINE, angles[:, None], angles, t_end=200.0, tangent=t, workers=1
            )
        )
        label = "with predictability horizon" if tangent else "outputs of hammering_map"
        print(f"  {label:30} {1e6 * seconds / 576:7.1f} µs a trajectory")
    angles = np.linspace(0, np.pi, 181)
    for workers in (1, None):
        seconds = median(lambda w=workers: validity_map(BASELINE, angles, angles, workers=w))
        print(f"  validity map 181 × 181, workers = {workers}: {seconds:.2f} s")
    cold = [
        float(subprocess.run([sys.executable, "-c", COLD], capture_output=True, check=True).stdout)
        for _ in range(3)
    ]
    print(f"  the same from a cold process, imports included: {statistics.median(cold):.2f} s")
    started = time.perf_counter()
    refined = refine_validity_map(BASELINE, resolution=1441, coarse=91)
    seconds = time.perf_counter() - started
    share = float(refined.computed.mean())
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"  refined map 1441 × 1441: {seconds:.2f} s, {share:.1%} of the runs, {memory:.0f} MiB")


if __name__ == "__main__":
    main()
