"""``squealpipe.plot`` draws systems and what no study holds; other datasets see the tiny study."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import squealpipe
from squealpipe.plotting import picture
from squealpipe.plotting.quantities import counts
from squealpipe.systems.impact_oscillator import impact_oscillator
from squealpipe.systems.mode_coupling import mode_coupling
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
    squealpipe.plot(dataset).figure.savefig(tmp_path / "own.png")
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
