"""Pictures against stored ones, with a tolerance that fonts' hinting stays within.

When a change is meant, look at it and renew the baselines:
python -m pytest tests/paper/figures --mpl-generate-path=tests/paper/figures/baseline
"""

import numpy as np
import pytest
import xarray as xr
from PIL import Image

from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.linear.maps import stability_map
from squealpipe.paper.figures.model import fig01
from squealpipe.plotting import picture
from squealpipe.plotting.mechanism import draw_mechanism
from squealpipe.plotting.style import new_figure, save_figure
from tests.former import FORMER

PARAMS = FORMER
compared = pytest.mark.mpl_image_compare(
    baseline_dir="baseline", style="default", tolerance=2, savefig_kwargs={"dpi": 60}
)


@compared
def test_fig01():
    return fig01.draw()


@compared
def test_schematics_of_the_papers_arrangements():
    figure, axes = new_figure(7.0, 1.6, ncols=4)
    for axis, pair in zip(
        axes[0], ((0.5, 1), (1, 0.5), (0.75, 0.75), (0.4, 0.6)), strict=True
    ):
        draw_mechanism(axis, pair[0] * np.pi, pair[1] * np.pi)
    return figure


@compared
def test_run():
    times = np.linspace(0, 40, 801)
    motion = simulate(PARAMS, 5 * np.pi / 6, 5 * np.pi / 6, t_end=40.0, times=times)
    return picture(motion)


@compared
def test_angle_map_of_categories():
    angles = np.linspace(0, np.pi, 61)
    return picture(stability_map(PARAMS, angles, angles))


@compared
def test_branch_with_unstable_part():
    peak = np.linspace(0.7, 6, 40)
    points = {
        "omega": 0.55 + 0.15 / np.maximum(peak, 1.0),
        "y_peak": peak,
        "x_amplitude": 0.55 * peak - 0.35,
        "stability_index": np.where((peak > 3.9) & (peak < 5.8), -2.1, 1.0),
    }
    attributes = {"schema": "backbone", "parameters": '{"preload": 1.0}'}
    orbits = {name: ("point", values) for name, values in points.items()}
    return picture(xr.Dataset(orbits, attrs=attributes))


def test_all_files_of_a_figure_have_the_layout_of_the_first(tmp_path):
    def drawn():
        figure, axes = new_figure(3.5, 2.5, ncols=2)
        mappable = axes[0, 0].imshow(np.eye(3))
        figure.colorbar(mappable, ax=axes[0, 0], label="a long label")
        axes[0, 1].set_ylabel("another one")
        return figure

    def layout(figure):
        return [axis.get_position().bounds for axis in figure.axes]

    both, first, plain = drawn(), drawn(), drawn()
    unset = layout(plain)
    save_figure(both, [tmp_path / "both.png", tmp_path / "both.svg"])
    save_figure(first, [tmp_path / "first.png"])
    assert layout(both) == layout(first) != unset
    assert (tmp_path / "both.png").read_bytes() == (tmp_path / "first.png").read_bytes()
    assert "another one" in (tmp_path / "both.svg").read_text(encoding="utf-8")


def test_a_png_holds_the_pixels_that_matplotlib_writes(tmp_path):
    figure, axes = new_figure(2.0, 1.5)
    axes[0, 0].imshow(np.random.default_rng(1).random((9, 7)), cmap="viridis")
    save_figure(figure, [tmp_path / "ours.png"], dpi=130)
    figure.savefig(tmp_path / "theirs.png", dpi=130)
    with Image.open(tmp_path / "ours.png") as checked:
        checked.verify()
    with (
        Image.open(tmp_path / "ours.png") as ours,
        Image.open(tmp_path / "theirs.png") as theirs,
    ):
        assert (ours.mode, ours.info["Software"]) == ("RGB", "squealpipe")
        assert ours.info["dpi"] == theirs.info["dpi"]
        np.testing.assert_array_equal(ours, theirs.convert("RGB"))


def test_texts_of_another_look_are_laid_out_anew(tmp_path):
    """A picture is that of Matplotlib, which lays out each text anew."""
    looks = (
        {"fontsize": 9},
        {"fontweight": "bold"},
        {"rotation": 30, "ha": "left"},
        {"rotation": 30, "ha": "left", "rotation_mode": "anchor"},
        {"ha": "left"},
        {"va": "top"},
        {"multialignment": "right"},
        {"linespacing": 2.0},
        {"parse_math": False},
        {"wrap": True},
        {"wrap": True},  # lines break according to the place
        {"rotation": 30, "transform_rotates_text": True},
    )

    def drawn():
        figure, axes = new_figure(6.0, 4.0)
        axes[0, 0].set(xlim=(-1, 7), ylim=(0, 4), xlabel=r"$10^{-3}$ \$ 2")
        for place, look in enumerate(({}, *looks, {})):
            at = 2.0 * (place % 4), 0.5 + place // 4
            words = "$x_1$ = $10^{-3}$\nlong" + 9 * " words" * look.get("wrap", False)
            axes[0, 0].text(*at, words, **{"ha": "center", "va": "center", **look})
        return figure

    for name, save in (("ours", save_figure), ("plain", save_figure.__wrapped__)):
        files = [tmp_path / f"{name}.png", tmp_path / f"{name}.svg"]
        save(drawn(), files, dpi=72)  # of an SVG, too
    for ending in ("png", "svg"):
        ours, plain = (tmp_path / f"{name}.{ending}" for name in ("ours", "plain"))
        assert ours.read_bytes() == plain.read_bytes()
