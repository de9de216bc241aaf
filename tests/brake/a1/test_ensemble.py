"""Ensembles: bitwise independence of how they are run, units, limits, refusals."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from squealpipe.brake.a1 import ensemble
from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.schema import Outcome
from squealpipe.systems.taylor.simd import FEW
from tests.former import FORMER

RNG = np.random.default_rng(3)
SIZE = 83
MIXED = {
    "k3": RNG.uniform(0.3, 3.0, SIZE),
    "mu": RNG.uniform(0.0, 0.8, SIZE),
    "belt_speed": RNG.choice([0.0, 0.3, 5.0, 100.0, -0.3], SIZE),
    "length1": RNG.uniform(2.0, 30.0, SIZE),
    "preload": RNG.uniform(0.5, 2.0, SIZE),
}
ANGLES = RNG.uniform(0, np.pi, (2, SIZE))
ENDS = RNG.uniform(1.0, 60.0, SIZE)


def _run(order=slice(None), *, tangent=True, **options):
    return run_ensemble(
        {name: values[order] for name, values in MIXED.items()},
        ANGLES[0][order],
        ANGLES[1][order],
        t_end=ENDS[order],
        tangent=tangent,
        log_events=40,
        times=np.linspace(0, 1.0, 7),
        **options,
    )


def assert_identical(first, second, rows=slice(None), but=()):
    assert first._raw.keys() == second._raw.keys()
    for name, values in first._raw.items():
        assert name in but or values.tobytes() == second._raw[name][rows].tobytes(), (
            name
        )


@pytest.fixture(scope="module")
def reference():
    return _run(workers=1)


@pytest.mark.parametrize("workers", [1, 2, 3])
def test_any_number_of_workers_and_order_gives_the_same_bits(reference, workers):
    order = np.random.default_rng(workers).permutation(SIZE)
    assert_identical(_run(order, workers=workers), reference, order)


@pytest.mark.parametrize(
    "rows", [slice(0, 1), slice(1, 2), slice(SIZE - 1, SIZE), slice(7, 14)]
)
def test_runs_alone_or_in_blocks_give_the_same_bits(reference, rows):
    assert_identical(_run(rows, workers=1), reference, rows)


@pytest.mark.parametrize("model", ["A1", "A1-linear-springs"])
@pytest.mark.parametrize("tangent", [False, True])
def test_few_lanes_give_the_same_bits(model, tangent):
    whole = _run(model=model, tangent=tangent, workers=1)
    for size in range(1, FEW + 2):  # one more than there are lanes takes all of them
        rows = slice(7 * size, 8 * size)
        assert_identical(
            _run(rows, model=model, tangent=tangent, workers=1), whole, rows
        )


def test_a_longer_horizon_continues_the_same_run():
    """t_end never shortens a step, so a longer run passes through the same states."""
    times = np.linspace(0, 20, 41)
    short = run_ensemble(FORMER, 0.3, 2.5, t_end=20.0, times=times)
    long = run_ensemble(FORMER, 0.3, 2.5, t_end=100.0, times=times)
    assert short.samples.tobytes() == long.samples.tobytes()


@pytest.mark.parametrize("model", ["A1", "A1-linear-springs", "A4"])
def test_asked_instants_do_not_change_a_run(model):
    """Even one that glides along the surface of contact, held by round-off alone."""
    angles = (
        np.array([0.4, 1.0, 0.0, 1.0]) * np.pi,
        np.array([0.6, 1.0, 0.0, 1.0]) * np.pi,
    )
    above = np.nextafter(1.0, 2.0)
    start = [[0, 0, 0, 0], [-0.2, above, -0.4, 0], [0.2, 1, -0.3, 0], [0, 0, 1, 0]]
    given = {"t_end": 40.0, "model": model, "initial_state": start, "log_events": 100}
    plain = run_ensemble(FORMER.with_(belt_speed=1.0), *angles, **given)
    located = plain.event_times[np.isfinite(plain.event_times)]
    assert located.size > 4
    instants = np.sort(np.append(np.linspace(0, 40, 999), located))
    asked = run_ensemble(FORMER.with_(belt_speed=1.0), *angles, **given, times=instants)
    assert_identical(asked, plain, but=("samples", "sample_regimes", "sample_sums"))


def test_results_have_the_shape_of_the_inputs():
    run = run_ensemble(
        FORMER, np.zeros((3, 1)), np.zeros(4), t_end=1.0, times=[0.0, 1.0]
    )
    assert run.outcome.shape == (3, 4)
    assert run.samples.shape == (3, 4, 2, 4)
    assert run_ensemble(FORMER, 1.0, 1.0, t_end=1.0).time.shape == ()
    for none in ((FORMER, np.zeros(0), 1.0), ({"mu": np.zeros(0)}, 1.0, 1.0)):
        assert run_ensemble(*none, t_end=1.0).outcome.shape == (0,)


def test_t_end_zero_is_the_start():
    run = run_ensemble(
        FORMER, 1.0, 1.0, t_end=0.0, initial_state=(0.1, 0.2, 0.3, 0.4), times=[0.0]
    )
    assert run.outcome == Outcome.converged
    np.testing.assert_array_equal(run.final_state, [0.1, 0.2, 0.3, 0.4])
    np.testing.assert_array_equal(run.samples, [[0.1, 0.2, 0.3, 0.4]])


def test_stops_say_so():
    """Instants beyond them hold NaN and a flag."""
    times, stop = np.linspace(0, 50, 51), {"stop_at_first_separation": True}
    first = run_ensemble(FORMER, np.pi, np.pi, t_end=50.0, times=times, **stop)
    assert first.outcome == Outcome.separated
    assert first.time == first.first_separation_time
    past = times > first.time
    assert past.any()
    np.testing.assert_array_equal(np.isnan(first.samples).all(axis=-1), past)
    np.testing.assert_array_equal(first.sample_regimes == -1, past)
    turned = run_ensemble(
        FORMER, 0.4 * np.pi, 0.6 * np.pi, t_end=600.0, stop_at_turns=5
    )
    assert turned.outcome == Outcome.amplitude_reached
    assert abs(turned.turns) == 5


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"model": "A1-nostick"}, "A1-no-stick"),
        ({"times": [1.0, 0.5]}, "ascend"),
        ({"times": [-1.0, 0.5]}, "0 or later"),
        ({"times": [0.0, 11.0]}, "beyond t_end"),
        ({"times": 3.0}, "sequence"),
        ({"initial_state": (0.0, 1.0)}, "vx"),
        ({"parameters": {"mass": [1.0, -1.0]}}, "mass"),
        ({"parameters": {"mu": -0.1}}, "mu"),
        ({"parameters": {"beltspeed": 1.0}}, "belt_speed"),
        ({"parameters": {"k3": np.nan}}, "k3"),
    ],
)
def test_refusals_name_the_argument(changes, message):
    arguments = {
        "parameters": FORMER,
        "alpha1": 1.0,
        "alpha2": 1.0,
        "t_end": 10.0,
        **changes,
    }
    with pytest.raises(ValueError, match=message):
        run_ensemble(**arguments)


def test_maps_in_blocks_are_the_same():
    alpha1, alpha2 = np.linspace(0, np.pi, 9), np.linspace(0, np.pi, 7)

    def largest(**options):
        return ensemble.run_map(
            FORMER,
            alpha1,
            alpha2,
            lambda run: {"largest": run.max_displacement},
            t_end=20.0,
            **options,
        )["largest"]

    assert largest().shape == (9, 7)
    assert largest().tobytes() == largest(at_once=10).tobytes()


def test_threads_do_not_disturb_each_other(reference):
    with ThreadPoolExecutor(2) as pool:
        for run in pool.map(lambda _: _run(workers=1), range(4)):
            assert_identical(run, reference)


def test_a_motion_said_to_be_large_takes_longer_steps():
    """Two motions that keep contact, against runs with a tolerance of 1e-12."""
    precise, coarse, large = (
        run_ensemble(
            FORMER, [1.2, np.pi / 2], [2.8, np.pi], t_end=50.0, tol=tol, size=size
        )
        for tol, size in ((1e-12, 1.0), (1e-6, 1.0), (1e-6, 30.0))
    )
    assert (large.separations == 0).all()
    assert (large.steps < 0.8 * coarse.steps).all()
    for run, error in ((coarse, 1e-8), (large, 1e-6)):
        assert np.abs(run.final_state - precise.final_state).max() < error
