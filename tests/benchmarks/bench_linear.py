"""Speed of the linear maps and of the inference, beside numeric eigenvalues of every cell.

Prints seconds (smallest of three) and ratios; the ratios are what to compare between machines.
"""

import time

import numpy as np

from squealpipe import natural_frequencies, quasi_static_map, stability_map
from squealpipe.brake.models.a4 import contact_matrix
from squealpipe.laws.springs import geometry, linear_stiffness
from squealpipe.paper.inference.inference import infer_parameters
from squealpipe.parameters import Parameters

POINTS = 1441
SAMPLES = 20_480
PARAMS = Parameters()
ANGLES = np.linspace(0.0, np.pi, POINTS)


def best(work, repeats=3):
    """Smallest wall time, s."""
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return min(times)


def numeric_eigenvalues():
    """All cells by LAPACK, one stack of 2 × 2 matrices."""
    stiffness = linear_stiffness(PARAMS, geometry(ANGLES[:, None], ANGLES[None, :]))
    entries = np.broadcast_arrays(*contact_matrix(stiffness, PARAMS.k3, PARAMS.mu))
    matrices = np.stack(entries, axis=-1).reshape(POINTS, POINTS, 2, 2)
    return np.linalg.eigvals(matrices)


def main():
    """Print a table."""
    numeric = best(numeric_eigenvalues, repeats=1)
    print(f"{'numeric eigenvalues':24} {numeric:8.3f} s")
    for task in (quasi_static_map, stability_map, natural_frequencies):
        seconds = best(lambda task=task: task(PARAMS, ANGLES, ANGLES))
        print(
            f"{task.__name__:24} {seconds:8.3f} s  {seconds / numeric:6.2f} of numeric"
        )
    infer_parameters(PARAMS, samples=64)
    seconds = best(lambda: infer_parameters(PARAMS, samples=SAMPLES), repeats=1)
    print(
        f"{'infer_parameters':24} {seconds:8.3f} s  {1e6 * seconds / SAMPLES:6.0f} µs a sample"
    )


if __name__ == "__main__":
    main()
