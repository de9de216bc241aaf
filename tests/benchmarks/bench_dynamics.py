"""Speed of ensembles and maps, beside single runs of scipy.

Prints medians and ratios; the ratios are what to compare between machines. What runs in this
process alone is timed by its CPU time, so that others at work on the machine disturb less.
"""

import resource
import statistics
import subprocess
import sys
import time

import numpy as np

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.dynamics.refinement import refine_validity_map
from squealpipe.brake.dynamics.runs import validity_map
from squealpipe.parameters import Parameters
from tests.oracles.a1_scipy import simulate_scipy

BASELINE = Parameters()
COLD = """
import time
import numpy as np
from squealpipe.parameters import Parameters
from squealpipe.brake.dynamics.runs import validity_map
angles = np.linspace(0, np.pi, 181)
validity_map(Parameters(), angles, angles, workers=1)
print(time.process_time())
"""


def median(work, repeats=5, clock=time.process_time):
    """Median time of a few repeats, s."""
    times = []
    for _ in range(repeats):
        started = clock()
        work()
        times.append(clock() - started)
    return statistics.median(times)


def main():
    """Print the tables."""
    angles = np.linspace(0, np.pi, 24)
    pairs = np.random.default_rng(0).uniform(0, np.pi, (5, 2))
    public = statistics.median(
        median(
            lambda pair=pair: simulate_scipy(BASELINE, *pair, t_end=200.0, tol=1e-12),
            repeats=1,
        )
        for pair in pairs
    )
    print(
        "\nEnsembles, T = 200, 24 × 24 angles, all events and outputs, 1e-12, one core"
    )
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
    for workers, kind, clock in (
        (1, "CPU", time.process_time),
        (None, "wall", time.perf_counter),
    ):
        seconds = median(
            lambda w=workers: validity_map(BASELINE, angles, angles, workers=w),
            clock=clock,
        )
        print(f"  validity map 181 × 181, workers = {workers}: {seconds:.2f} s {kind}")
    cold = [
        float(
            subprocess.run(
                [sys.executable, "-c", COLD], capture_output=True, check=True
            ).stdout
        )
        for _ in range(3)
    ]
    print(
        f"  the same from a cold process, imports included: {statistics.median(cold):.2f} s CPU"
    )
    started = time.perf_counter()
    refined = refine_validity_map(BASELINE, resolution=1441, coarse=91)
    seconds = time.perf_counter() - started
    share = float(refined.computed.mean())
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"  refined map 1441 × 1441: {seconds:.2f} s, {share:.1%} of the runs, {memory:.0f} MiB"
    )


if __name__ == "__main__":
    main()
