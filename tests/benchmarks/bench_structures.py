"""Cost of structures: runs of a settled pad beside scipy, complex modes beside sparse factors.

Prints CPU times and ratios; the ratios are what to compare between machines. The public brake is
measured where its matrices are (``SQUEALPIPE_BRAKE_MATRICES``), a finer pad elsewhere.
"""

import resource
import time

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from squealpipe import Structure
from squealpipe.benchmark.machine import processor
from squealpipe.structures import elastic_pad
from squealpipe.structures.pencil import Pencil
from squealpipe.systems.integrate import RunOptions, integrate
from tests.oracles.elastic_block import elastic_block
from tests.structures.test_large import by_scipy
from tests.structures.test_motion import names, twelve_modes
from tests.structures.test_truth import BRAKE, brake
from tests.systems.linear.test_loop import many_contacts

ROUNDS = 3
"""Of ours and scipy's in turn; the median of the ratios counts."""


def cpu_time(work):
    """What work returns, and its CPU time, s."""
    started = time.process_time()
    result = work()
    return result, time.process_time() - started


def runs():
    """20 ms of the settled pad of twelve modes, in an ensemble."""
    pad, t_end = twelve_modes(), 20e-3
    system = pad.system()
    settled = system.simulate(t_end, times=[0.0, t_end])
    start = {name: float(settled[name][-1]) for name in names(12)}
    speeds = pad.belt_speed + 1e-9 * np.arange(8)
    given = {"start": start, "belt_speed": speeds, "workers": 1}
    system.ensemble(1e-4, **given)  # compiled
    runs = [cpu_time(lambda: system.ensemble(t_end, **given)) for _ in range(ROUNDS)]
    each = np.median([seconds for _, seconds in runs]) / len(speeds)
    ensemble, _ = runs[0]
    counts = [name for name in ensemble if str(name).startswith("count_")]
    events = sum(int(ensemble[name].sum()) for name in counts) / len(speeds)
    print(
        f"\n20 ms of the settled pad of 12 modes and 4 contacts, {processor()}, one core"
    )
    print(
        f"  a run of an ensemble, 1e-12 {1e3 * each:8.1f} ms, {events:.0f} events, "
        f"{events / each:.0f} a second"
    )


def steps():
    """Print the cost of a step of random structures that hammer, as in docs/performance.md."""
    print("\nA step of random structures with full matrices, one core")
    print("| modes | contacts | µs per step | events per step | memory |")
    sizes = (12, 4), (32, 16), (60, 40), (120, 100), (200, 200), (512, 512)
    for modes, contacts in sizes:
        structure, q, v = many_contacts(contacts, modes)
        system = structure.system()
        given = {name: np.array([value]) for name, value in system.parameters.items()}
        states = zip(system.states, [*q, *v], strict=True)
        given |= {name: np.array([value]) for name, value in states}
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        rounds = [
            cpu_time(
                lambda system=system, given=given, count=count: integrate(
                    system,
                    given,
                    np.array([1e4]),
                    RunOptions(most_steps=count),
                    tol=1e-12,
                )
            )
            for count in (1, *ROUNDS * [max(100, 4_000_000 // modes**2)])
        ]
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        raw, seconds = min(rounds[1:], key=lambda each: each[1])
        count = int(raw["steps"][0])
        print(
            f"| {modes} | {contacts} | {1e6 * seconds / count:.1f} | "
            f"{raw['n_events'][0] / count:.2f} | {(most - before) / 1e3:.0f} MB |"
        )


def modes():
    """Complex modes in a band at one friction, beside one complex sparse factorization."""
    if (BRAKE / "BMLL00.mat").is_file():
        mass, damping, stiffness = brake(4 * np.pi)
        structure, top = Structure(mass, stiffness, damping), 42000 / (2 * np.pi)
    else:
        structure, top = elastic_pad(elements=(96, 24)).with_(mu=0.5), 60e3
    factorizations = []
    factorized = Pencil.factorized

    def counted(pencil, s):
        factorizations.append(s)
        return factorized(pencil, s)

    Pencil.factorized = counted
    try:
        found, seconds = cpu_time(
            lambda: structure.complex_modes(
                mu=[structure.mu] if structure.contacts else None, frequency_max=top
            )
        )
    finally:
        Pencil.factorized = factorized
    shifted = sp.csc_array(
        structure.mass * (1j * top) ** 2
        + structure.damping * (1j * top)
        + structure.stiffness,
        dtype=complex,
    )
    _, single = cpu_time(lambda: splu(shifted, permc_spec="MMD_AT_PLUS_A"))
    print(
        f"\nComplex modes of {structure.size} degrees of freedom up to {top:.0f} Hz, one core"
    )
    print(
        f"  {found.sizes['mode']} modes {seconds:8.1f} s, {len(factorizations)} factorizations, "
        f"{seconds / single:.0f} times one"
    )


def large():
    """Complex modes of blocks with many contacts at one friction, beside SciPy's eigensolver."""
    print(
        "\nLowest complex modes at one friction, without critical frictions, one core"
    )
    for elements, contacts, number in (((27, 16, 3), 49, 20), ((70, 17, 4), 126, 40)):
        block = elastic_block(elements, contacts, mu=0.5)
        modes, seconds = cpu_time(
            lambda block=block, number=number: block.complex_modes(
                n_modes=number, critical=False
            )
        )
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        closed = modes.normal_force.values > 0
        theirs, public = cpu_time(
            lambda block=block, closed=closed, number=number: by_scipy(
                block, closed, 0.5, number
            )
        )
        apart = np.abs(theirs.imag / (2 * np.pi) - modes.frequency.values).max()
        print(
            f"  {block.size} degrees of freedom, {contacts} contacts, {number} modes: "
            f"{seconds:.1f} s, {most:.2f} GB; SuperLU and ARPACK {public:.1f} s; "
            f"{apart:.1e} Hz apart"
        )


def main():
    """Print all."""
    large()
    runs()
    steps()
    modes()


if __name__ == "__main__":
    main()
