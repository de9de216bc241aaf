"""Films and sounds of structures: drawn displacements in pixels, frequencies of the datasets."""

import numpy as np
import pytest
from scipy.ndimage import center_of_mass, label

from squealpipe import load, plot, squealing_modes
from squealpipe.cli import run
from squealpipe.codes import Regime
from squealpipe.plotting.animation import film_of, phases
from squealpipe.plotting.sound import SAMPLING_RATE, sound
from squealpipe.schema import Outcome, build
from squealpipe.store import save
from squealpipe.structures import elastic_pad
from squealpipe.structures.meshes.datasets import mesh_variables
from squealpipe.structures.schema.structure_run import structure_run_schema
from squealpipe.structures.squeal.settled_run import squealing_run
from tests.plotting.test_sound import heard, strongest
from tests.structures.test_squealing import two_modes, two_pads


@pytest.fixture(scope="module")
def swaying():
    """A pad whose shape sways at 500 Hz along x and half as far along y, its contacts in turn."""
    pad = elastic_pad(elements=(6, 2), contacts=2)
    time = np.arange(2001) / 20e3
    q = (
        np.stack([np.sin(1000 * np.pi * time), np.cos(1000 * np.pi * time)], axis=1)
        * 1e-6
    )
    v = np.gradient(q, time, axis=0)
    direction = pad.mesh.degree_of_freedom[:, 1]
    shapes = np.stack([1.0 * (direction == 1), 0.5 * (direction == 2)], axis=1)
    both = np.ones((2001, 2))
    regime = np.where(q > 0, Regime.separated, Regime.slip_slower)
    of_mesh, coordinates = mesh_variables(pad)
    return build(
        structure_run_schema,
        {
            "displacement": q,
            "velocity": v,
            "mode_shape": shapes,
            "contact_displacement_along": q[:, :1] * both,
            "contact_displacement_across": q[:, 1:] * both,
            "contact_velocity_along": v[:, :1] * both,
            "contact_velocity_across": v[:, 1:] * both,
            "normal_force": 400.0 * (q < 0),
            "regime": regime,
            "preload": [400.0, 400.0],
            "attractor": 0,
            "dominant_frequency": 500.0,
            "outcome": Outcome.converged,
            **of_mesh,
        },
        {"time": time, "contact": ["p1", "p2"], **coordinates},
    )


def marks_in(pixels):
    """Middles of the two contacts by their colours, from the left, pixels from the lower left."""
    part = pixels[: pixels.shape[0] * 3 // 4, : pixels.shape[1] * 57 // 100].astype(int)
    red = (part[..., 0] > 180) & (part[..., 2] < 90)
    blue = (part[..., 2] > 140) & (part[..., 0] < 60)
    spots, count = label(red | blue, np.ones((3, 3)))
    middles = center_of_mass(np.ones_like(spots), spots, range(1, count + 1))
    sizes = np.bincount(spots.ravel())[1:]
    middles = np.array(middles)[np.argsort(-sizes)[:2]]
    middles = middles[np.argsort(middles[:, 1])]
    return np.stack([middles[:, 1], pixels.shape[0] - 1 - middles[:, 0]], axis=1)


def test_the_mesh_is_drawn_where_the_dataset_says(swaying):
    made = film_of(swaying, seconds=0.56, dpi=200)
    frames = list(made.frames())
    assert len(frames) == 14
    body = made.scene.drawn
    axes = body.marks.axes
    per_metre = axes.bbox.width / np.diff(axes.get_xlim())[0]
    chosen = [0, 3, 7]
    moved = swaying.displacement.values[body.frames[chosen]] * [1.0, 0.5]
    expected = body.scale * per_metre * (moved - moved.mean(axis=0))
    assert np.abs(expected).max() > 12.0
    seen = np.array([marks_in(frames[k]) for k in chosen])
    for contact in (0, 1):
        place = seen[:, contact] - seen[:, contact].mean(axis=0)
        assert np.abs(place - expected).max() < 1.5
    # all facets move alike here
    body.show(3)
    vertices = np.concatenate([path.vertices for path in body.facets.drawn.get_paths()])
    body.show(0)
    before = np.concatenate([path.vertices for path in body.facets.drawn.get_paths()])
    step = body.scale * (moved[1] - moved[0])
    assert vertices - before == pytest.approx(np.tile(step, (len(before), 1)), rel=1e-6)


def test_a_node_or_a_contact_is_heard(swaying):
    along = sound(swaying)
    assert along.component.endswith("along x")
    assert along.frequency == pytest.approx(500.0, abs=0.1)
    assert sound(swaying, at="7.2").component == "of node 7 along y"
    assert sound(swaying, at="p2").component == "of contact p2 along the belt"
    with pytest.raises(ValueError, match=r"no node that moves, and no contact: p1, p2"):
        sound(swaying, at="999")


def test_open_contacts_are_hollow(swaying):
    body = film_of(swaying, seconds=1.0).scene.drawn
    for place in range(25):
        body.show(place)
        hollow = (body.marks.get_facecolor()[:, :3] == 1.0).all(axis=1)
        regimes = swaying.regime.values[body.frames[place]]
        assert hollow.tolist() == (regimes == Regime.separated).tolist()


def test_a_strip_of_a_structure_has_eight_phases(swaying):
    figure = phases(swaying)
    assert len(figure.axes) == 8
    assert figure.axes[4].get_title() == "1 ms"


@pytest.mark.parametrize(
    "made", [pytest.param(lambda: two_modes(1.0), marks=pytest.mark.release), two_pads]
)
def test_the_frequency_of_the_answer_is_heard(made):
    structure = made()
    answer = squealing_modes(structure, samples=1, workers=1)
    motion = squealing_run(structure, answer)
    assert motion.sizes["time"] == 16001
    heard_ = sound(motion)
    line = strongest(heard(heard_.wav(3.0)), SAMPLING_RATE)
    told = float(motion.dominant_frequency)
    # of a torus a velocity may ring louder at another of its lines than the energy does
    velocity = motion.velocity.values @ motion.mode_shape.values.T
    lines = [strongest(each, 1.0 / float(motion.time[1])) for each in velocity.T]
    assert min(abs(told - each) for each in lines) < 3e-3 * told
    assert min(abs(line - each) for each in lines) < 2e-3 * line
    if structure.size == 2:
        assert line == pytest.approx(told, rel=1e-3)


def test_the_run_goes_on_where_the_answer_has_settled():
    structure = two_modes(1.0)
    answer = squealing_modes(structure, samples=1, workers=1)
    motion = squealing_run(structure, answer, periods=200)
    one = answer.isel(attractor=int(motion.attractor))
    share = (motion.regime == Regime.separated).mean("time").values
    assert share == pytest.approx(one.separated_fraction.values, abs=5e-3)
    ways = [motion[f"contact_velocity_{way}"].values for way in ("along", "across")]
    rms = np.sqrt(sum((way**2).mean(axis=0) for way in ways))
    assert rms == pytest.approx(one.contact_velocity_rms.values, rel=5e-3)
    with pytest.raises(ValueError, match="attractor = 7"):
        squealing_run(structure, answer, attractor=7)


def test_a_quiet_structure_has_no_run():
    structure = two_modes(0.1)
    answer = squealing_modes(structure, samples=1, workers=1)
    with pytest.raises(ValueError, match="no motion of the structure lasts"):
        squealing_run(structure, answer)


@pytest.mark.release
def test_the_commands_write_run_sound_and_film_of_a_structure_in_files(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    from scipy.io import mmwrite

    structure = two_pads()
    for name, matrix in (("m", structure.mass), ("k", structure.stiffness)):
        mmwrite(f"{name}.mtx", matrix.tocoo())
    (tmp_path / "pad.yaml").write_text(
        "mass: m.mtx\nstiffness: k.mtx\nmodal_damping: 0.01\nmu: 0.5\nbelt_speed: 2.0\n"
        "contacts: contacts.csv\n"
    )
    (tmp_path / "contacts.csv").write_text(
        "name,normal,tangential,stiffness,preload\n"
        "inner,2:1,1:1,3e7,2e3\nouter,4:1,3:1,5e7,2e3\n"
    )
    assert run(["squeal", "pad.yaml", "--samples", "1", "--run", "run.nc"]) == 1
    assert "wrote run.nc" in capsys.readouterr().out
    assert load("run.nc").attrs["schema"] == "structure_run"
    assert run(["listen", "run.nc"]) == 0
    assert run(["animate", "run.nc", "--seconds", "0.5", "-o", "run.gif"]) == 0
    assert "Force and path are those of contact" in capsys.readouterr().out


def test_a_run_is_drawn_by_its_forces(swaying):
    axes = plot(swaying)
    assert [line.get_label() for line in axes.get_lines()] == ["p1", "p2"]
    assert axes.get_lines()[0].get_ydata().max() == 400.0


def test_a_stored_run_is_read_back(swaying, tmp_path):
    stored = load(save(swaying, tmp_path / "run.nc"))
    assert sound(stored).frequency == pytest.approx(500.0, abs=0.1)
