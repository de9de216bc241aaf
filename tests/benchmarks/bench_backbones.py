"""Speed and accuracy of the backbones, beside pyHarm in the form that runs A4.

pyHarm takes symmetric forces alone; multiplied by the S of A4's first integral, the model is of
that form: S m w'' + (S K + g k3 e e') w − g k3 e max(w_y − gap, 0) = 0 about the equilibrium.
It follows forced phase resonance, so it needs a little damping. Prints times a point, errors of
ω against the exact orbit of equal peak, and ratios; the ratios compare between machines.
"""

from __future__ import annotations

import contextlib
import io
import logging
import math
import time

import numpy as np

from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.methods.balance.harmonic_balance import CosineBalance, contact_of, cosines_of
from squealpipe.methods.continuation import ContinuationSettings
from squealpipe.methods.orbits.orbit_shape import sample
from squealpipe.models.a4 import first_integral
from squealpipe.parameters import Parameters
from squealpipe.solvers.a4.exact_branches import exact_branch
from squealpipe.solvers.a4.harmonic_branches import coupled_branch, linear_series
from squealpipe.solvers.a4.orbits import find_orbit, linear_orbit
from squealpipe.solvers.a4.system import scaled_system
from squealpipe.tasks.backbones.atlas import orbit_atlas

PARAMS = Parameters()
ANGLES = 0.3 * math.pi, 0.9 * math.pi
MODE = 1
LARGEST_PEAK = 3.5
PEER_DAMPING = 1e-3
"""With less, the peer's step control gives up soon after the loss of contact."""
PEER_SETTINGS = ((16, 1024), (32, 1024))
ATLAS_POINTS = 181


def best(work, repeats=5):
    """(smallest CPU time of several, s; the last result)."""
    times, result = [], None
    for _ in range(repeats):
        started = time.process_time()
        result = work()
        times.append(time.process_time() - started)
    return min(times), result


def exact_orbits(scene):
    """Time a point with monodromy, and the largest residual."""
    work = lambda: exact_branch(scene, MODE, LARGEST_PEAK, 3.0)  # noqa: E731
    work()
    seconds, (orbits, _, _) = best(work)
    return seconds / len(orbits), max(orbit.residual for orbit in orbits)


def harmonic_balance(scene, n_harmonics):
    """Time a point along the branch; errors of ω at equal peak and at equal first harmonic."""
    balance = CosineBalance(scene.system, contact_of(n_harmonics, 1.0, None, None))
    start = linear_series(scene, MODE, n_harmonics, linear_orbit(scene, MODE, 1.0).point)
    settings = ContinuationSettings()
    work = lambda: coupled_branch(  # noqa: E731
        scene, balance, MODE, start, LARGEST_PEAK, settings
    )
    seconds, (found, _) = best(work)
    at_peak, at_first = [], []
    for z in found:
        orbit, _ = find_orbit(scene, MODE, float(balance.peak_row @ z))
        states = sample(scene.system.rows, orbit.point, np.linspace(0, math.pi, 2**14 + 1))
        y = cosines_of(states[:, 1])
        at_peak.append(abs(z[-1] - orbit.omega))
        same, _ = balance.solve(z, balance.first_harmonic_row, float(y[1]))
        at_first.append(abs(same[-1] - orbit.omega))
    unit = scene.frequency
    return seconds / len(found), np.array(at_peak) * unit, np.array(at_first) * unit


def pyharm_branch(n_harmonics, n_time):
    """(seconds a point, errors of ω at equal peak) of pyHarm's nonlinear-mode backbone."""
    from pyHarm.Maestro import Maestro

    stiffness = linear_stiffness(PARAMS, geometry(*ANGLES))
    s11, s12, s22, push = first_integral(stiffness, PARAMS.mu)
    symmetric = np.array([[s11, s12], [s12, s22]])
    springs = np.array([[stiffness.k11, stiffness.k12], [stiffness.k12, stiffness.k22]])
    contact = symmetric @ springs + push * PARAMS.k3 * np.diag([0.0, 1.0])
    scene = scaled_system(PARAMS, *ANGLES)
    gap = (1.0 - scene.rest[1]) * PARAMS.preload
    study = {
        "system": {"type": "Base", "nh": n_harmonics, "nti": n_time},
        "substructures": {
            "mass": {
                "matrix": {
                    "M": PARAMS.mass * symmetric,
                    "C": PEER_DAMPING * PARAMS.mass * symmetric,
                    "K": contact,
                },
                "ndofs": 2,
            }
        },
        "connectors": {
            "belt": {
                "type": "PenaltyUnilateralGap",
                "connect": {"mass": [0]},
                "dirs": [1],
                "k": -push * PARAMS.k3,
                "g": gap,
            }
        },
        "analysis": {
            "backbone": {
                "study": "nlm_backbone",
                "mode_target": MODE - 1,
                "solver": "NewtonRaphson",
                "solver_options": {"max_iter": 20},
                "amp_min": 0.1 * PEER_DAMPING,
                "df0": 0.02 * PEER_DAMPING,
                "df_min": 1e-3 * PEER_DAMPING,
                "df_max": 0.03 * PEER_DAMPING,
                "amp_max": 2.0,
                "max_steps": 60,
                "verbose": False,
                "purge_jacobians": False,
            }
        },
    }
    with contextlib.redirect_stdout(io.StringIO()):
        maestro = Maestro(study)
        started = time.process_time()
        maestro.operate()
        seconds = time.process_time() - started
    accepted = [entry for entry in maestro.nls["backbone"].SolList if entry.flag_accepted]
    explicit = maestro.system.expl_dofs
    cosines_y = np.flatnonzero((explicit.dof_num == 1) & (explicit.cs == "c"))
    sines_y = np.flatnonzero((explicit.dof_num == 1) & (explicit.cs == "s"))
    theta, order = np.linspace(0, 2 * math.pi, 4097), explicit.harm.values
    table_c = np.cos(np.outer(theta, order[cosines_y]))
    table_s = np.sin(np.outer(theta, order[sines_y]))
    errors = []
    for entry in accepted:
        x = entry.x
        y = table_c @ x[cosines_y] + table_s @ x[sines_y]
        peak = float(y.max()) / PARAMS.preload + scene.rest[1]
        if 1.05 < peak < LARGEST_PEAK:
            orbit, _ = find_orbit(scene, MODE, peak)
            errors.append(abs(x[-1] - orbit.omega * scene.frequency))
    return seconds / max(len(maestro.nls["backbone"].SolList), 1), np.array(errors)


def main():
    """Print a table."""
    logging.disable(logging.CRITICAL)
    scene = scaled_system(PARAMS, *ANGLES)
    seconds, residual = exact_orbits(scene)
    print(f"exact orbits             {1e3 * seconds:8.3f} ms a point, residual {residual:.1e}")
    ours = {}
    for count in (8, 16, 32, 64):
        seconds, at_peak, at_first = harmonic_balance(scene, count)
        ours[count] = seconds, float(np.median(at_peak))
        print(
            f"harmonic balance N_h {count:3} {1e3 * seconds:8.3f} ms a point, error of omega at "
            f"equal peak {np.median(at_peak):.1e} (largest {at_peak.max():.1e}), at equal first "
            f"harmonic {np.median(at_first):.1e} ({at_first.max():.1e})"
        )
    try:
        import pyHarm  # noqa: F401
    except ImportError:
        print("pyHarm is not installed here: pip install -r requirements-peers.lock")
    else:
        for count, samples in PEER_SETTINGS:
            pyharm_branch(count, samples)  # compiled code of the peer is not counted
            runs = [pyharm_branch(count, samples) for _ in range(3)]
            seconds, errors = min(run[0] for run in runs), runs[-1][1]
            if not errors.size:
                print(f"pyHarm N_h {count}, N {samples}: no point beyond the loss of contact")
                continue
            error = float(np.median(errors))
            equal = min((c for c in ours if ours[c][1] <= error), default=64)
            print(
                f"pyHarm N_h {count:3} N {samples:5}   {1e3 * seconds:8.3f} ms a point, error of "
                f"omega {error:.1e} ({len(errors)} points); ours at N_h {equal} is "
                f"{seconds / ours[equal][0]:.0f} times as fast and no less accurate"
            )
    angles = np.linspace(0.0, math.pi, ATLAS_POINTS)
    orbit_atlas(PARAMS, angles[:2], angles[:2])
    seconds, atlas = best(lambda: orbit_atlas(PARAMS, angles, angles), repeats=1)
    held = float((atlas.outcome == 0).mean())
    print(
        f"atlas {ATLAS_POINTS} x {ATLAS_POINTS} x 2     {seconds:8.1f} s, {100 * held:.1f} % held"
    )


if __name__ == "__main__":
    main()
