"""Ensembles with laws of the user's own: as A1's own loop where the law is one of its formulas."""

import numpy as np
import pytest

from squealpipe import Parameters, simulate
from squealpipe.brake.a1.ensemble import Ensemble, run_ensemble
from squealpipe.brake.a1.motion_system import brake_of, parameters_of_run
from squealpipe.codes import Event
from squealpipe.schema import Outcome
from tests.former import FORMER

STEPWISE = ("steps", "sample_log_growth")
STARTS = np.array(
    [[0, 0, 0, 0], [0.5, 0, 1.0, 0], [0, 1.5, 0, 0.3], [-1.0, 0.2, 0.4, -1.0]]
)


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_a_table_of_one_coefficient_gives_the_ensemble_of_coulombs_law(damping):
    plain = FORMER.with_(belt_speed=0.4, mu=0.35, damping1=damping, damping2=damping)
    table = plain.with_(friction_law="linear 0:0.35 0.3:0.35 1:0.35", mu=DEFAULT_MU)
    t_end = 12.0
    given = {
        "t_end": t_end,
        "t_late": 0.6 * t_end,
        "initial_state": STARTS,
        "tangent": True,
        "log_events": 30,
        "times": np.linspace(0.0, t_end, 5),
        "sums": True,
        "workers": 1,
    }
    ours, other = (run_ensemble(p, 0.9, 2.0, **given) for p in (table, plain))
    for name, member in vars(Ensemble).items():
        if name[0] == "_" or name in STEPWISE or callable(member):
            continue
        mine, theirs = getattr(ours, name), getattr(other, name)
        np.testing.assert_allclose(mine, theirs, rtol=1e-8, atol=1e-8, err_msg=name)
    assert all(
        count.sum() for count in (other.sticks, other.separations, other.contacts)
    )


DEFAULT_MU = Parameters().mu


def test_simulate_takes_the_parameters_of_a_pad_with_measured_laws():
    pad = Parameters(
        mass=0.5,
        k1=1e7,
        k2=1.3e7,
        preload=2e-5,
        length1=0.02,
        length2=0.03,
        belt_speed=0.05,
        friction_law="linear 0:0.55 0.03:0.5 0.05:0.35 0.2:0.2",
        contact_law="linear 0:0 1e-5:20 3e-5:140 5e-5:300",
    )
    run = simulate(pad, 0.1, 1.5, t_end=0.02, initial_state=(3e-5, 0, 0, 0))
    assert int(run.outcome) == 0
    knots = np.array([0.0, 1e-5, 3e-5, 5e-5]), np.array([0.0, 20.0, 140.0, 300.0])
    expected = np.interp(pad.preload - run.y.values, *knots)
    apart = run.regime.values == 3
    np.testing.assert_allclose(
        run.normal_force.values[~apart], expected[~apart], rtol=1e-12
    )
    assert Event.stick in run.event_kind.values
    start = float(run.normalized_contact_force[0])
    assert start == pytest.approx(1.0, rel=1e-15)


def test_a_table_in_si_units_is_carried_by_runs_side_by_side():
    """A step of no length, after an event at the very end of another, is one without a crossing."""
    pad = Parameters(
        mass=0.5,
        k1=1e7,
        k2=1e7,
        k3=7e6,
        belt_speed=2.0,
        preload=2e-5,
        length1=0.02,
        length2=0.02,
        friction_law="linear 0:0.52 0.05:0.47 0.2:0.41 1:0.36 5:0.34",
    )
    angles = np.linspace(0.1, 3.0, 4)
    run = run_ensemble(
        pad, angles[:, None], angles, t_end=25.0 * pad.time_unit, workers=1
    )
    assert (run.outcome == Outcome.converged).all()
    assert run.steps.max() < 100


OWN = """\
def coefficient(speed, p):
    return p.mu * (0.6 + 0.4 / (1.0 + 3.0 * speed))
"""
CONTACT = "linear 0:0 0.5:0.1 1:0.65 2:3"


@pytest.mark.parametrize(
    "laws",
    [
        {"friction_law": "linear 0:0.55 0.4:0.35 1:0.2"},
        {"friction_law": OWN, "mu": np.array([0.3, 0.5, 0.8])},
        {"contact_law": "dashpot", "damping3": np.array([0.1, 0.0, 0.4])},
        pytest.param(
            {"contact_law": CONTACT, "mu": np.array([0.3, 0.5, 0.8])},
            marks=pytest.mark.release,
        ),
        {
            "contact_law": "dashpot",
            "damping3": 0.2,
            "friction_law": "exponential",
            "mu_static": np.array([0.4, 0.3, 0.6]),
        },
        {"contact_law": CONTACT, "friction_law": OWN},
    ],
    ids=["table", "python", "dashpot", "contact table", "falling and dashpot", "both"],
)
def test_numbers_may_vary_under_laws_of_the_users_own(laws):
    """As for uncertain parameters: one ensemble, and one run for each set."""
    given = {
        "k1": np.array([1.0, 2.5, 0.6]),
        "mass": np.array([0.7, 1.0, 1.6]),
        "belt_speed": 0.4,
        **laws,
    }
    start = (0.0, 0.3, 0.5, -0.2)
    many = run_ensemble(given, 0.9, 2.0, t_end=20.0, initial_state=start, workers=1)
    assert (many.outcome == Outcome.converged).all()
    for i in range(3):
        own = {
            name: v[i] if isinstance(v, np.ndarray) else v for name, v in given.items()
        }
        run = run_ensemble(
            Parameters(**own), 0.9, 2.0, t_end=20.0, initial_state=start, workers=1
        )
        np.testing.assert_allclose(
            many.final_state[i], run.final_state, rtol=1e-9, atol=1e-12
        )
        assert many.separations[i] == run.separations


def test_under_a_table_of_contact_the_preload_is_one():
    with pytest.raises(ValueError, match="preload: under a table of contact"):
        run_ensemble(
            {"preload": [1.0, 1.1], "contact_law": CONTACT}, 0.9, 2.0, t_end=1.0
        )


def test_a_law_in_python_reads_speeds_in_si_units():
    """In the engine's units it gives what the system in SI units gives, and a table of it."""
    pad = Parameters(
        mass=0.5,
        k1=1e7,
        k2=1.3e7,
        k3=7e6,
        preload=2e-5,
        length1=0.02,
        length2=0.03,
        belt_speed=0.4,
        mu=0.5,
        friction_law=OWN,
    )
    t_end = 30.0 * pad.time_unit
    times = np.linspace(0.0, t_end, 7)
    run = simulate(
        pad, 1.0, 2.2, t_end=t_end, times=times, initial_state=(0, 0, 0.1, 0)
    )
    whole = brake_of(pad).simulate(
        t_end, times=times, start={"vx": 0.1}, **parameters_of_run(pad, 1.0, 2.2)
    )
    np.testing.assert_allclose(run.x, whole.x, rtol=1e-8, atol=1e-12)
    with pytest.raises(
        ValueError, match=r"friction_speed = 2\.0: the file of a law stands for it"
    ):
        pad.with_(friction_speed=2.0)
