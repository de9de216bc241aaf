"""Work–precision of harmonic balance on A4, judged by exact orbits of equal peak."""

import math
import statistics
import time
import timeit
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from squealpipe.benchmark.schema import Role, work_precision_schema
from squealpipe.brake.a4.orbits import find_orbit
from squealpipe.brake.a4.system import ScaledSystem, scaled_system
from squealpipe.brake.balance.harmonic_balance import (
    CosineBalance,
    contact_of,
    cosines_of,
)
from squealpipe.brake.balance.sampled_balance import SampledBalance, SampledSolution
from squealpipe.brake.orbits.orbit_shape import sample
from squealpipe.brake.orbits.orbits import Orbit, solve_orbit
from squealpipe.parameters import Parameters
from squealpipe.schema import Outcome, build

CORRECTED, AS_PRINTED = "paper, Eq. (34) corrected", "paper, Eq. (34) as printed"
PAPER_SIGMA = 1e3

Method = Callable[[Orbit, Orbit], tuple[Callable[[], Any], Callable[[Any], float]]]
"""(exact orbit, one before it) → what is timed, and the error of its result."""


def work_precision(
    params: Parameters,
    *,
    harmonics: Sequence[int],
    sigmas: Sequence[float],
    oversampling: Sequence[int],
    repeats: int,
) -> xr.Dataset:
    """Dataset ``work_precision``: medians over the peaks of the coupled scene.

    Args:
        oversampling: N over 2 N_h; 1 is the fewest samples that keep the columns independent.
    """
    # angles at which mode 1 moves in x and y and loses contact
    scene = scaled_system(params, 0.3 * math.pi, 0.9 * math.pi)
    # y_peak over l_pre; none close to the period doubling at 3.9
    # the start of a solution is the orbit at a peak lower by 0.02, as along a backbone
    solutions = [
        [find_orbit(scene, 1, peak - d)[0] for d in (0.0, 0.02)]
        for peak in (1.25, 1.75, 2.25, 2.75, 3.5)
    ]
    pairs = [(orbit, start) for orbit, start in solutions if orbit and start]
    rows = []
    for *names, method in _methods(scene, harmonics, sigmas, oversampling):
        errors, seconds = [], []
        for orbit, start in pairs:
            run, error_of = method(orbit, start)
            result, spent = timed(run, repeats)
            errors.append(error_of(result))
            seconds.append(spent)
        fine = np.isfinite(errors)
        error = float(np.median(np.array(errors)[fine])) if fine.any() else math.nan
        outcome = (
            Outcome.converged if fine.any() and fine.all() else Outcome.no_convergence
        )
        rows.append((*names, error, statistics.median(seconds or [0.0]), outcome))
    columns = dict(
        zip(work_precision_schema.variables, zip(*rows, strict=True), strict=True)
    )
    return build(work_precision_schema, columns, {"run": np.arange(len(rows))})


def _methods(
    scene: ScaledSystem,
    harmonics: Sequence[int],
    sigmas: Sequence[float],
    oversampling: Sequence[int],
) -> Iterator[tuple[str, str, Role, Method]]:
    """Closed forms over N_h, sampled forces over N_h and N, smoothed ones over σ; orbits; paper."""
    default = 16
    for count in sorted({*harmonics, default}):
        role = Role.our_setting if count == default else Role.ours
        closed = partial(_cosines, scene, count, None, None)
        yield "cosines, closed-form contact", f"N_h {count}", role, closed
        for factor in oversampling:
            samples = 2 * count + 2 if factor == 1 else 2 * count * factor
            name = f"cosines, {'2 N_h + 2' if factor == 1 else f'{2 * factor} N_h'} samples"
            sampled = partial(_cosines, scene, count, samples, None)
            yield name, f"N_h {count}, N {samples}", Role.ours, sampled
    most = max(harmonics)
    for sigma in sigmas:
        samples = int(2 ** math.ceil(math.log2(max(16 * most, 8 * min(sigma, 1000.0)))))
        smooth = partial(_cosines, scene, most, samples, sigma)
        yield (
            "cosines, tanh",
            f"N_h {most}, N {samples}, sigma {sigma:g}",
            Role.ours,
            smooth,
        )
    name = "exact orbit (shooting)"
    yield name, "with monodromy", Role.our_setting, partial(_shooting, scene)
    # the paper's pseudo-inverse costs the cube of the number of harmonics
    for count in (harmonic for harmonic in harmonics if harmonic <= 16):
        setting = f"N_h {count}, N {4 * count + 2}, sigma {PAPER_SIGMA:g}"
        for name, printed in ((CORRECTED, False), (AS_PRINTED, True)):
            yield (
                name,
                setting,
                Role.public,
                partial(_paper, scene, count, as_printed=printed),
            )


def _cosines(
    scene: ScaledSystem,
    count: int,
    samples: int | None,
    sigma: float | None,
    orbit: Orbit,
    start: Orbit,
) -> Any:
    balance = CosineBalance(scene.system, contact_of(count, samples, sigma))
    guess, peak = orbit_series(scene, start, count), float(orbit.point[1])

    def error_of(found: Any) -> float:
        return math.nan if found is None else abs(found[0][-1] / orbit.omega - 1.0)

    return partial(balance.solve, guess, balance.peak_row, peak), error_of


def _paper(
    scene: ScaledSystem, count: int, _: Orbit, start: Orbit, *, as_printed: bool
) -> Any:
    """The paper's balance; its peak is not prescribed: ω is judged by its own exact orbit."""
    z = orbit_series(scene, start, count)
    balance = SampledBalance(
        scene.system, count, 4 * count + 2, PAPER_SIGMA, as_printed=as_printed
    )
    eta = balance.start_from_cosines(z[: count + 1], z[count + 1 : -1], float(z[-1]))

    def error_of(found: SampledSolution) -> float:
        exact, _ = find_orbit(scene, 1, max(balance.peak(found), 1.0 + 1e-6))
        return (
            abs(found.omega / exact.omega - 1.0)
            if found.converged and exact
            else math.nan
        )

    return partial(balance.solve, eta, max_iterations=25), error_of


def _shooting(scene: ScaledSystem, orbit: Orbit, start: Orbit) -> Any:
    """Exact orbits themselves: their error is the velocity that is left after half a period."""
    guess = start.point.copy()
    guess[1] = orbit.point[1]
    return partial(
        solve_orbit, scene.system, guess
    ), lambda f: f.residual if f else math.nan


def orbit_series(
    scene: ScaledSystem, orbit: Orbit, n_harmonics: int
) -> NDArray[np.float64]:
    """Unknowns of the cosine balance that describe an exact orbit."""
    theta = np.linspace(0.0, math.pi, 512 + 1)
    cosines = cosines_of(sample(scene.system.rows, orbit.point, theta)[:, :2])
    kept = cosines[: n_harmonics + 1]
    return np.concatenate([kept[:, 0], kept[:, 1], [orbit.omega]])


def timed(run: Callable[[], Any], repeats: int) -> tuple[Any, float]:
    """The result of a run and the median wall time of ``repeats`` runs, s.

    The median drops what the first run compiles or allocates, from three repeats on; of two runs,
    as many as long ones get, the shorter counts.
    """
    started = time.perf_counter()
    result = run()
    first = time.perf_counter() - started
    # s: a shorter run is called several times between two readings of the clock
    calls = 1 if first > 2e-3 else 5
    # s: a longer run is called twice at most: it scatters little, and all cores wait
    others = (min(repeats, 2) if first > 0.1 else repeats) - 1
    spent = [each / calls for each in timeit.repeat(run, number=calls, repeat=others)]
    return result, statistics.median_low([first, *spent])
