"""Growth of a perturbation against differences in long double and matrix exponentials."""

import numpy as np
import pytest
from scipy.linalg import expm

from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.assess.sliding import Design, Sliding
from squealpipe.laws.friction_laws import LAWS
from squealpipe.parameters import PHYSICAL, Parameters
from tests.former import FORMER
from tests.oracles.a1_long_double import derivative_along, simulate_reference

T_END = 50.0
HALVES = np.full(4, 0.5)
"""Along which a perturbation starts."""
WORST = {
    # of 1e5 random runs, where collocation in three points was off by 1.5e-3 to 2.5e-3
    "k2": (0.796996256219917, 1.300544558235522, 2.3717194212884602),
    "k3": (1.12905702881331, 0.9396103240379049, 0.48233670032093445),
    "mu": (0.4561553874796027, 0.04796819616443298, 0.49408345058299735),
    "belt_speed": (0.823799361919746, 3.155658864295034, -0.4354716586035202),
    "length1": (26.439748491098534, 18.579466655514274, 17.41320811301354),
    "length2": (2.7532458450213477, 2.3104128639767527, 19.19371213702673),
}
WORST_ANGLES = (
    (2.5002944820448687, 2.25403084815231, 0.5867683983141044),
    (2.556194872908985, 2.9022233599165914, 2.490332548495959),
)


def runs():
    """The worst ones, and random ones: belts of either direction and unequal springs."""
    rng, size = np.random.default_rng(12), 12
    ranges = {"k2": (0.4, 2.5), "k3": (0.2, 4.0), "mu": (0.0, 0.8)}
    ranges |= dict.fromkeys(("length1", "length2"), (2.0, 30.0))
    values = {name: rng.uniform(*each, size) for name, each in ranges.items()}
    values["belt_speed"] = rng.choice([-1.0, 1.0], size) * np.geomspace(
        0.1, 100.0, size
    )
    angles = np.concatenate([WORST_ANGLES, rng.uniform(0, np.pi, (2, size))], axis=1)
    return {
        name: np.concatenate([WORST[name], more]) for name, more in values.items()
    }, angles


def test_growth_is_that_of_the_variational_equations():
    parameters, angles = runs()
    run = run_ensemble(parameters, *angles, t_end=T_END, tangent=True, workers=1)
    compared = 0
    for job in range(run.outcome.size):
        params = FORMER.with_(
            **{name: float(values[job]) for name, values in parameters.items()}
        )
        scene = params, *angles[:, job]
        exact = simulate_reference(*scene, t_end=T_END)
        total = run.separations + run.contacts + run.sticks + run.slips + run.reversals
        assert run.events[job] == total[job] == len(exact.event_times)
        end = derivative_along(
            *scene, HALVES, t_end=T_END, initial_state=np.zeros(4), step=1e-12
        )
        if end is not None and (growth := np.log(np.linalg.norm(end))) < 12.0:
            compared += 1
            assert run.log_growth[job] == pytest.approx(growth, abs=1e-4), job
    assert compared > 12


def test_growth_of_a_motion_that_dies_down_through_events():
    """Started far away, with dashpots: in pieces, each begun along the end of the last."""
    rng, size, compared = np.random.default_rng(2), 40, 0
    parameters = {
        "k2": rng.uniform(0.4, 2.5, size),
        "k3": rng.uniform(0.4, 4.0, size),
        "mu": rng.uniform(0.0, 0.5, size),
        "belt_speed": rng.choice([-1.0, 1.0], size) * np.geomspace(0.3, 50.0, size),
        "damping1": np.exp(rng.uniform(-3.5, -0.5, size)),
        "damping2": np.exp(rng.uniform(-3.5, -0.5, size)),
    }
    angles, starts = (
        rng.uniform(0.0, np.pi, (2, size)),
        rng.normal(scale=2.0, size=(size, 4)),
    )
    run = run_ensemble(
        parameters, *angles, t_end=90.0, initial_state=starts, tangent=True
    )
    for job in np.flatnonzero((run.separations > 0) & (run.log_growth < 0.0)):
        params = Parameters(
            **{name: float(values[job]) for name, values in parameters.items()}
        )
        scene, given = (
            (params, *angles[:, job]),
            {"t_end": 15.0, "initial_state": starts[job]},
        )
        direction, growth = HALVES, 0.0
        for _ in range(6):
            end = derivative_along(*scene, direction, **given)
            if end is None:
                break
            growth += np.log(np.linalg.norm(end))
            direction = end / np.linalg.norm(end)
            given["initial_state"] = simulate_reference(*scene, **given).state
        else:
            compared += 1
            assert run.log_growth[job] == pytest.approx(growth, abs=1e-3), job
    assert compared > 10


def resting_runs(count, seed):
    """Damped runs next to steady sliding, which they reach: all laws, units and belts."""
    rng = np.random.default_rng(seed)
    while count:
        mass, k1, length = np.exp(rng.uniform(-3.0, 3.0, 3))
        unit = np.sqrt(mass / k1)
        mu = rng.uniform(0.0, 0.6)
        params = FORMER.with_(
            mass=mass,
            k1=k1,
            k2=k1 * np.exp(rng.uniform(-2.0, 2.0)),
            k3=k1 * np.exp(rng.uniform(-1.5, 4.0)),
            mu=mu,
            belt_speed=rng.choice([-1, 1])
            * np.exp(rng.uniform(-2.0, 4.0))
            * length
            / unit,
            preload=length,
            length1=length * rng.uniform(1.0, 20.0),
            length2=length * rng.uniform(1.0, 20.0),
            damping1=np.exp(rng.uniform(-4.0, 1.0)) * k1 * unit,
            damping2=np.exp(rng.uniform(-4.0, 1.0)) * k1 * unit,
            friction_law=str(rng.choice(list(LAWS))),
            mu_static=mu + rng.uniform(0.0, 0.6),
            friction_speed=np.exp(rng.uniform(-3.0, 1.0)) * length / unit,
        )
        angles = rng.uniform(0.0, np.pi, 2)
        found = Sliding.of(Design(params, *angles))
        if found is None:
            continue
        scale = np.array([length, length, length / unit, length / unit])
        rest, matrix = found.state, found.jacobian * unit * scale / scale[:, None]
        if np.linalg.eigvals(matrix).real.max() > -1e-3:
            continue
        start = rest + scale * rng.normal(size=4) * 10.0 ** rng.uniform(-14.0, -7.0)
        yield params, angles, start, matrix, np.exp(rng.uniform(2.0, 7.0)), unit
        count -= 1


def test_growth_of_a_motion_that_dies_out_is_that_of_the_linear_system():
    """It was exp(+224) for exp(-30): a perturbation has a rate of its own, where nothing moves."""
    params, angles, starts, matrices, times, units = zip(
        *resting_runs(150, 41), strict=True
    )
    run = run_ensemble(
        {name: [getattr(p, name) for p in params] for name in PHYSICAL},
        *np.transpose(angles),
        t_end=np.array(times) * units,
        initial_state=np.array(starts),
        tangent=True,
    )
    assert not run.events.any()
    for job, (matrix, time) in enumerate(zip(matrices, times, strict=True)):
        growth = np.linalg.norm(expm(matrix * time) @ HALVES)
        if growth > 1e-300:
            assert run.log_growth[job] == pytest.approx(np.log(growth), abs=1e-3), job


def test_growth_of_undamped_steady_sliding():
    place = FORMER.with_(k3=0.75, length1=5.0, length2=5.0), 0.83 * np.pi, 0.83 * np.pi
    found = Sliding.of(Design(*place))
    run = run_ensemble(*place, t_end=200.0, initial_state=found.state, tangent=True)
    growth = np.linalg.norm(expm(200.0 * found.jacobian) @ HALVES)
    assert run.log_growth == pytest.approx(np.log(growth), abs=1e-4)
