"""What methods say of squeal, against an integrator apart and what is known without one."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import mmwrite

from squealpipe import load, plot, save, squeal_ladder
from squealpipe.benchmark.schema import Reliability, Role
from squealpipe.cli import run
from squealpipe.plotting import picture
from squealpipe.structures import elastic_pad
from squealpipe.structures.schema.squeal_ladder import NO_MODE, PushAnswer
from squealpipe.structures.spectrum import Limits, Solver
from squealpipe.structures.squeal.plant import Plant
from squealpipe.structures.squeal.smoothed import Smoothed
from squealpipe.study.report.squeal_ladder import lines
from tests.oracles.structure_answers import Motion
from tests.structures.test_squealing import two_modes

GALLERY = Path(__file__).parents[2] / "docs/gallery"
WIDTHS = ((2.0, 0.0), (0.3, 0.3), (0.03, 0.03))


@pytest.fixture(scope="module")
def ladder():
    return squeal_ladder(two_modes(1.0), widths=WIDTHS, repeats=1, t_end=0.05)


def row_of(ladder, method, setting=None):
    fits = ladder.method.values == method
    if setting is not None:
        fits &= ladder.setting.values == setting
    return ladder.isel(run=int(np.flatnonzero(fits)[0]))


def row(ladder, method, setting=None):
    return row_of(ladder, method, setting).isel(mode=0)


@pytest.mark.release
def test_the_finest_run_is_that_of_an_integrator_apart(ladder):
    structure = two_modes(1.0)
    plant = Plant(structure)
    start = plant.pushed(plant.unstable[0], 0.01)
    end = float(ladder.t_end)
    # the last window is a quarter of it
    apart = Motion(structure, start)
    apart.run(0.75 * end)
    late = apart.run(0.25 * end, 1e-6)
    finest = row(ladder, "exact events")
    assert int(finest.role) == Role.our_setting
    allowed = 2.0 * float(ladder.separation_uncertainty) + 1e-3
    assert finest.separated_fraction.values == pytest.approx(
        late["open"] / (0.25 * end), abs=allowed
    )
    assert finest.stick_fraction.values == pytest.approx(
        late["stick"] / (0.25 * end), abs=1e-3
    )
    assert finest.peak_force.values == pytest.approx(late["peak"] / 2e3, rel=2e-3)
    contact = structure.contacts[0]
    velocities = late["samples"][:, 2:]
    along = np.hypot(velocities[:, 0] * contact.tangential[0], velocities[:, 1])
    assert float(finest.velocity_rms) == pytest.approx(
        np.sqrt((along**2).mean()), rel=0.03
    )
    assert int(finest.answer) == PushAnswer.right
    assert float(finest.cpu_time) > 0


def test_smoothing_that_takes_away_the_friction_says_quiet_without_a_word(ladder):
    """At a width of twice the belt's speed friction is μ tanh(½), below the onset of flutter."""
    wide = row(ladder, "friction smoothed", "2")
    assert np.tanh(0.5) < 0.75  # Hoffmann's onset
    assert int(wide.answer) == PushAnswer.quiet_instead
    assert int(wide.verdict) == Reliability.silently_wrong
    assert int(wide.rings_near) == NO_MODE
    assert float(wide.velocity_error) == float(wide.frequency_error) == 1.0
    assert wide.separated_fraction.values == [0.0]
    assert wide.stick_fraction.values == [1.0], "slower than that width all along"
    # at rest the structure stands still: all of it is the belt's speed
    assert wide.creep.values == pytest.approx([1.0], abs=1e-3)


def test_errors_of_smoothing_vanish_with_its_width(ladder):
    method = "friction and contact smoothed"
    wide, narrow = row(ladder, method, "0.3, 0.3"), row(ladder, method, "0.03, 0.03")
    assert int(narrow.answer) == PushAnswer.right
    for name in ("velocity", "separation"):
        floor = 2.0 * float(ladder[f"{name}_uncertainty"])
        wrong, less = float(wide[f"{name}_error"]), float(narrow[f"{name}_error"])
        assert less <= max(0.3 * wrong, floor) < wrong
    assert narrow.creep.isnull() | (narrow.creep < 0.03)
    assert float(wide.cpu_time) > 10 * float(row(ladder, "exact events").cpu_time)


def test_complex_modes_name_the_mode_but_neither_level_nor_contact_loss(ladder):
    modes = row(ladder, "complex modes")
    structure = two_modes(1.0)
    known = Solver(structure, Limits(), structure.belt_speed).at(structure.mu)
    grows = known.values[known.values.real.argmax()]
    assert float(modes.frequency) == pytest.approx(grows.imag / (2 * np.pi), rel=1e-12)
    assert int(modes.answer) == PushAnswer.right
    assert np.isnan(modes.velocity_error)
    assert np.isnan(modes.separated_fraction).all()
    finest = row(ladder, "exact events")
    assert float(modes.frequency_error) == pytest.approx(
        float(modes.frequency / finest.frequency) - 1, rel=1e-12
    )


def test_between_its_corners_the_smoothed_structure_is_the_exact_one():
    """Sliding fast in contact, tanh is 1 and rates are A x + b of the integrator apart."""
    structure = two_modes(1.0)
    plant = Plant(structure)
    model = Smoothed(plant, 0.01, np.zeros(1))
    state = plant.pushed(plant.unstable[0], 0.01)
    apart = Motion(structure, state)
    rates = apart.flow(apart.side)[0] @ np.append(state, 1.0)
    assert model.rates(0.0, state) == pytest.approx(rates[:-1], rel=1e-12)
    # open: no force at all, and of a rounded corner s²/(4 |p|) far from it
    rounded = Smoothed(plant, 0.01, np.array([2.0]))
    assert model.forces(np.array([-50.0])) == 0.0
    assert rounded.forces(np.array([-50.0])) == pytest.approx(4.0 / 200.0, rel=1e-3)
    assert rounded.forces(np.array([0.0])) == pytest.approx(1.0)


def test_where_nothing_grows_all_methods_say_quiet():
    calm = squeal_ladder(two_modes(0.3), widths=((0.1, 0.1),), repeats=1, t_end=0.02)
    assert (calm.answer == PushAnswer.right).all()
    assert (calm.verdict == Reliability.right).all()
    assert calm.frequency.isnull().all()
    assert all("dies out, rightly" in line for line in lines(calm)[2:])


def test_words_picture_and_file_agree(ladder, tmp_path):
    text = "\n".join(lines(ladder))
    assert "Finest: exact events in 2 modes." in text
    wide = "friction smoothed, 2: mode 1 dies out, which is wrong; level off by 100 %"
    assert wide in text
    save(ladder, tmp_path / "ladder.nc")
    back = load(tmp_path / "ladder.nc")
    assert back.drop_attrs().identical(ladder.drop_attrs())
    assert plot(back).has_data()
    panels = picture(back).axes
    assert len(panels) == 4
    assert all(panel.has_data() for panel in panels)
    with pytest.raises(ValueError, match="n_modes"):
        squeal_ladder(elastic_pad(elements=(8, 2)), n_modes=(2,))


@pytest.mark.release
def test_the_command_tells_each_method(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    structure = two_modes(1.0)
    for name in ("mass", "stiffness"):
        mmwrite(tmp_path / f"{name}.mtx", getattr(structure, name), precision=17)
    contact = structure.contacts[0]
    (tmp_path / "contacts.csv").write_text(
        "name,normal,tangential,stiffness,preload\n"
        f"c,2:-1,1:1,{contact.stiffness!r},2e3\n"
    )
    (tmp_path / "pad.yaml").write_text(
        "mass: mass.mtx\nstiffness: stiffness.mtx\ncontacts: contacts.csv\n"
        "modal_damping: 0.02\nmu: 1.0\nbelt_speed: -2.0\n"
    )
    # all default widths agree on the mode
    assert run(["ladder", "pad.yaml", "--repeats", "1", "--t-end", "70ms"]) == 0
    said = capsys.readouterr().out
    assert "mode 1 rings at 2.081 kHz" in said
    assert (tmp_path / "ladder.png").exists()
    assert load("ladder.nc").attrs["schema"] == "squeal_ladder"


def test_the_page_of_the_gallery_says_what_its_file_holds():
    """Numbers of its text, against the recorded ladder of the pad."""
    ladder = load(GALLERY / "squeal_ladder/pad_1.nc")
    text = (GALLERY / "what_a_verdict_on_squeal_costs.py").read_text("utf-8")
    text = " ".join(text.replace("# ", "").split())
    modes = row_of(ladder, "complex modes", "12")
    assert f"{float(modes.cpu_time):.2f} s" in text
    assert (modes.answer == PushAnswer.right).all()
    fine = row_of(ladder, "exact events", "20 modes")
    finest = row_of(ladder, "exact events", "32 modes")
    assert int(finest.role) == Role.our_setting
    smoothed = row_of(ladder, "friction smoothed", "0.1")
    level = f"within {100 * float(fine.velocity_error):.0f} %"
    assert f"{level} in {float(fine.cpu_time):.1f} s" in text
    assert 50 < float(smoothed.cpu_time / fine.cpu_time) < 500, (
        "a hundred times as long"
    )
    assert f"still {100 * float(smoothed.velocity_error):.0f} % too quiet" in text
    assert smoothed.velocity_rms[1] < finest.velocity_rms[1]
    assert smoothed.stick_fraction.max() > 3 * finest.stick_fraction.max()
    twelve = row_of(ladder, "exact events", "12 modes")
    upper = int(ladder.mode[1])
    assert twelve.rings_near.values.tolist() == [upper, upper]
    both = row_of(ladder, "friction and contact smoothed", "0.3, 0.3")
    assert both.rings_near.values.tolist() == [upper, upper]
    assert finest.rings_near.values.tolist() == ladder.mode.values.tolist()
