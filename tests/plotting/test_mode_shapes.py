"""Mode shapes: against an eigenproblem assembled here, as pictures, and for ParaView."""

import json
from dataclasses import replace

import meshio
import numpy as np
import pytest
import scipy.linalg as la
from matplotlib.figure import Figure

from squealpipe import convert, load, plot, save
from squealpipe.cli import run
from squealpipe.plotting import modes as picture
from squealpipe.plotting.mode_shapes import (
    figure_of_mode,
    figure_of_modes,
    shape_of,
    title_of,
    unstable_modes,
)
from squealpipe.structures import elastic_pad
from squealpipe.structures.meshes.datasets import mesh_of
from tests.structures.test_squealing import two_pads


@pytest.fixture(scope="module")
def pad():
    return elastic_pad(elements=(8, 3), contacts=3, mu=0.6)


@pytest.fixture(scope="module")
def modes(pad):
    return pad.complex_modes(mu=[0.2, 0.6], frequency_max=50e3, critical=False)


def test_shapes_are_those_of_an_eigenproblem_assembled_here(pad, modes):
    friction = pad.normals + 0.6 * pad.tangentials
    stiffness = pad.stiffness.toarray() + friction @ (pad.stiffnesses * pad.normals).T
    squares, vectors = la.eig(-stiffness, pad.mass.toarray())
    assert float(modes.shape_mu) == 0.6
    at = modes.sel(mu=0.6)
    for place in range(modes.sizes["mode"]):
        value = float(at.growth_rate[place]) + 2j * np.pi * float(at.frequency[place])
        nearest = vectors[:, np.abs(squares - value**2).argmin()]
        shape = shape_of(modes, int(modes.mode[place]))
        largest = np.abs(shape).argmax()
        assert shape[largest] == pytest.approx(1.0, abs=1e-6)
        assert shape == pytest.approx(nearest / nearest[largest], abs=2e-4)


def test_a_reduced_structure_has_the_shapes_of_the_whole(pad):
    kept = pad.reduce(n_modes=40).complex_modes(frequency_max=12e3, critical=False)
    whole = pad.complex_modes(frequency_max=12e3, critical=False)
    one, other = shape_of(kept, 1), shape_of(whole, 1)
    assert one.shape == other.shape == (pad.size,)
    assert np.abs(one - other).max() < 0.02


def test_a_vtu_file_opens_with_points_cells_and_both_phases(pad, modes, tmp_path):
    (path,) = convert(modes, tmp_path / "modes.vtu")
    grid = meshio.read(path)
    assert grid.points == pytest.approx(pad.mesh.nodes)
    assert [cell.type for cell in grid.cells] == ["quad"]
    assert grid.cells[0].data.tolist() == pad.mesh.facets.tolist()
    for number in modes.mode.values.tolist():
        shape = shape_of(modes, number)
        moved = pad.mesh.displacements(shape)
        real, imaginary = (
            grid.point_data[f"mode_{number}_{part}"] for part in ("real", "imaginary")
        )
        assert real + 1j * imaginary == pytest.approx(moved, abs=1e-6)
        amplitude = np.sqrt((np.abs(moved) ** 2).sum(axis=1))
        assert grid.point_data[f"mode_{number}_amplitude"] == pytest.approx(amplitude)


def test_without_a_mesh_there_are_arrows_and_no_vtu(tmp_path):
    alone = two_pads().complex_modes()
    axes = Figure().add_subplot()
    plot(alone, axes, mode=2)
    shape = shape_of(alone, 2)
    quiver = axes.collections[0]
    assert pytest.approx(shape.real) == quiver.V
    assert [each.get_text() for each in axes.get_xticklabels()] == ["1", "2", "3", "4"]
    with pytest.raises(ValueError, match=r"no mesh.*--mode"):
        convert(alone, tmp_path / "modes.vtu")


def test_a_mode_is_drawn_deformed_over_the_grey_mesh_at_rest(modes):
    axes = Figure().add_subplot()
    number = unstable_modes(modes, 1)[0]
    plot(modes, axes, mode=number)
    assert axes.get_title().startswith(f"mode {number}: ")
    rest, deformed = axes.collections[:2]
    mesh = mesh_of(modes)
    corners = np.concatenate([path.vertices[:4] for path in rest.get_paths()])
    moved = (
        np.concatenate([path.vertices[:4] for path in deformed.get_paths()]) - corners
    )
    expected = mesh.displacements(shape_of(modes, number).real)[:, :2]
    expected = np.concatenate([expected[row] for row in mesh.facets])
    scale = (moved * expected).sum() / (expected**2).sum()
    assert scale > 0
    assert moved == pytest.approx(scale * expected, abs=1e-9)
    assert len(set(deformed.get_array().tolist())) > 10
    panels = figure_of_modes(modes).axes
    assert panels[0].get_title().startswith(f"mode {number}: ")


@pytest.mark.usefixtures("real_pictures")
def test_the_commands_draw_and_convert_modes(modes, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    save(modes, "modes.nc")
    assert load("modes.nc").shape_real.dtype == np.float32
    assert run(["plot", "modes.nc", "--mode", "2"]) == 0
    assert run(["convert", "modes.nc", "-o", "modes.vtu"]) == 0
    assert (tmp_path / "modes.png").stat().st_size > 5000
    capsys.readouterr()
    assert run(["plot", "modes.nc", "--mode", "99", "--force"]) == 2
    assert "mode = 99: the dataset has modes 1 to" in capsys.readouterr().err


@pytest.fixture(scope="module")
def of_lining(pad):
    """Modes over the friction of a contact, where each has its own."""
    own = pad.with_(contacts=[replace(each, mu=0.6) for each in pad.contacts])
    name = own.contacts[1].name
    limits = {"frequency_max": 50e3}
    return own.complex_modes(mu={name: [0.0, 0.3, 0.6]}, **limits), own.complex_modes(
        **limits, critical=False
    )


def test_titles_say_which_friction_and_a_bar_what_the_colours_mean(of_lining):
    over, own = of_lining
    mode = int(own.mode[0])
    made = figure_of_mode(own, mode)
    assert made.get_suptitle().endswith("1/s at mu = 0.6")
    numbers = json.loads(own.attrs["parameters"])
    numbers["contacts"]["p1"]["mu"] = 0.5
    several = own.assign_attrs(parameters=json.dumps(numbers))
    assert title_of(several, mode).endswith("1/s at the friction of each contact")
    assert made.axes[-1].get_ylabel() == "amplitude over the largest"
    assert title_of(over, int(over.mode[0])).endswith("at mu of p2 = 0.6")


def test_modes_that_decay_fast_stay_in_the_picture_of_one_friction(modes):
    """Stable modes below the axis were cut off without a word."""
    one = modes.isel(mu=1)
    growth = np.linspace(-1e4, 100.0, one.sizes["mode"])
    one = one.assign(
        growth_rate=("mode", growth), unstable=("mode", growth > 0.0), mu=0.6
    )
    axes = picture.figure(one).axes[0]
    lowest, _ = axes.get_ylim()
    assert lowest > -1e3
    drawn = [line for line in axes.lines if line.get_marker() != "None"]
    heights = np.concatenate([line.get_ydata() for line in drawn])
    assert (heights >= lowest).sum() == one.sizes["mode"]
    assert drawn[-1].get_label().startswith("stable, below")


def test_growth_over_friction_is_zero_at_the_mark_of_its_onset(pad, of_lining):
    frequency, _ = picture.figure(of_lining[0]).axes
    assert frequency.get_xlabel() == "coefficient of friction of p2"
    over = pad.complex_modes(mu=[0.0, 0.3, 0.6, 0.9], frequency_max=80e3)
    _, growth = picture.figure(over).axes
    onsets = over.critical_mu.values[np.isfinite(over.critical_mu.values)]
    assert onsets.size
    for onset in onsets:
        through = [
            line
            for line in growth.lines
            if len(line.get_xdata()) > 1 and onset in np.asarray(line.get_xdata())
        ]
        assert through
        for line in through:
            at = np.asarray(line.get_xdata()) == onset
            assert np.asarray(line.get_ydata())[at] == [0.0]
