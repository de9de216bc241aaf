"""``squealpipe.plot`` draws systems and what no study holds; other datasets see the tiny study."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

import squealpipe
from squealpipe.codes import Event, Regime
from squealpipe.plotting import picture
from squealpipe.plotting.quantities import counts
from squealpipe.plotting.style import new_figure
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator
from squealpipe.systems.shipped.mode_coupling import mode_coupling
from tests.former import FORMER

ANGLES = np.linspace(0.1, 3.0, 7)
SCENE = 0.4 * np.pi, 0.6 * np.pi


impacts, STARTS = impact_oscillator, np.linspace(-1, 1, 5)
AT = {"amplitude": 2.3, "omega": 2.0}
ORBIT = (FORMER, 0.3 * np.pi, 0.9 * np.pi)


def a1_curve():
    """Of the scene on a slow belt, where its cycle grazes."""
    slow = FORMER.with_(belt_speed=1.0)
    branch = squealpipe.cycle_branch(
        slow, *SCENE, parameter="belt_speed", to=1.1, n_points=12
    )
    pair = "belt_speed", "mu"
    return squealpipe.cycle_curve(
        slow, *SCENE, label="grazing", parameters=pair, start=branch, n_points=5
    )


def system_curve():
    cycle = impacts.limit_cycle(omega=1.9, amplitude=2.2)
    branch = impacts.cycle_branch("amplitude", 4.0, start=cycle)
    return impacts.cycle_curve("fold", ("omega", "amplitude"), start=branch, n_points=9)


DATASETS = {
    "hammering": lambda: squealpipe.hammering_map(FORMER, ANGLES, ANGLES, t_end=20.0),
    "backbone": lambda: squealpipe.backbone(*ORBIT, mode=1),
    "periodic orbit": lambda: squealpipe.periodic_orbit(*ORBIT, mode=1, y_peak=2.0),
    "basin, one start": lambda: squealpipe.basin_map(
        FORMER, *SCENE, vx=STARTS, t_end=20.0
    ),
    "basin, two starts": lambda: squealpipe.basin_map(
        FORMER, *SCENE, vx=STARTS, vy=STARTS[1:], t_end=20.0
    ),
    "system run": lambda: impacts.simulate(30.0),
    "system over one": lambda: impacts.ensemble(
        60.0, amplitude=np.linspace(0.5, 3.0, 40)
    ),
    "system over two": lambda: impacts.ensemble(
        30.0, amplitude=np.linspace(0.5, 3.0, 9), omega=np.linspace(1.5, 2.5, 8)
    ),
    "system cycle": lambda: impacts.limit_cycle(**AT),
    "system branch": lambda: impacts.cycle_branch(
        "amplitude", 2.0, start=impacts.limit_cycle(**AT), n_points=20
    ),
    "cycle curve": a1_curve,
    "system curve": system_curve,
    "system basin": lambda: mode_coupling.basin(
        60.0, start={"x": np.linspace(-2, 2, 6)}
    ),
}


@pytest.mark.parametrize("name", DATASETS)
def test_a_picture_for_every_dataset(name, tmp_path):
    dataset = DATASETS[name]()
    _, ax = plt.subplots()
    assert squealpipe.plot(dataset, ax=ax) is ax
    assert ax.has_data()
    assert ax.get_xlabel()
    assert ax.get_ylabel()
    plt.close("all")
    assert squealpipe.plot(dataset).has_data()
    picture(dataset).savefig(tmp_path / "command.png", dpi=150)
    plt.close("all")


def test_labels_that_still_change_are_marked():
    dataset = DATASETS["hammering"]()
    dataset.motion_changed[:] = False
    dataset.motion_changed[1, 4] = True
    _, ax = plt.subplots()
    (dots,) = squealpipe.plot(dataset, ax=ax).lines
    assert dots.get_xydata().tolist() == [[ANGLES[1], ANGLES[4]]]
    assert counts(dataset)[-1] == "1 of 49 cells: another kind in the last quarter"
    plt.close("all")


def test_a_short_loss_of_contact_is_seen_in_a_long_run():
    # one hop in 20,000 s, far narrower than a pixel and between two samples
    damped = FORMER.with_(damping1=0.05, damping2=0.05)
    hop = {"t_end": 2e4, "initial_state": (0.0, 0.0, 0.0, 0.56)}
    run = squealpipe.simulate(damped, 0.5 * np.pi, np.pi, **hop)
    assert list(run.event_kind.values) == [Event.separation, Event.contact]
    assert not (run.regime == Regime.separated).any()
    figure, axes = new_figure(5.0, 3.0)
    squealpipe.plot(run, ax=axes[0, 0]).set_xlim(-2e4, 2e4)  # beside the axis
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].astype(int)
    red = np.array([0xD5, 0x5E, 0x00])
    columns = (np.abs(pixels - red).sum(axis=-1) < 100).any(axis=0)
    assert 1 <= columns.sum() <= 3
    first = axes[0, 0].transData.transform((float(run.event_time[0]), 0.0))[0]
    assert np.flatnonzero(columns)[0] == pytest.approx(first, abs=2)


def test_a_long_run_shows_its_last_periods():
    # K = diag(k, k): y oscillates with √(1 + κ)
    kept = FORMER.with_(length1=1e3, length2=1e3)
    short, long = (
        squealpipe.simulate(kept, 0.5 * np.pi, np.pi, t_end=end)
        for end in (30.0, 900.0)
    )
    assert len(picture(short).axes) == 4
    panels = picture(long).axes
    assert len(panels) == 6
    period = 2.0 * np.pi / np.sqrt(1.0 + FORMER.kappa)
    for panel in (panels[1], panels[3]):
        first, last = panel.get_xlim()
        assert last == pytest.approx(900.0, rel=1e-3)
        assert last - first == pytest.approx(12 * period, rel=1e-2)
