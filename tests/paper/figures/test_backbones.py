"""Pictures of backbones show what the datasets hold."""

import math
from functools import partial

import numpy as np

from squealpipe.brake.backbones.backbone import backbone
from squealpipe.brake.backbones.doubling import doubled_branch as follow_doubling
from squealpipe.paper.figures.backbones import coupled_backbones, fig10_to_12, fig13
from squealpipe.plotting.style import symbols
from squealpipe.store.provenance import stamped
from tests.former import FORMER

PI = math.pi
BRANCHES = {"F10 mode 2": (0.5 * PI, PI, 2)}


def _branches(alpha1, alpha2, params=None, scene="F10", **limits):
    params = params or FORMER
    options = {"": {"method": "exact"}, "_hbm": {"method": "hbm", "n_harmonics": 8}}
    return {
        f"backbone/{scene}_mode{mode}{form}": stamped(
            partial(
                backbone,
                params,
                alpha1 * PI,
                alpha2 * PI,
                mode=mode,
                **option,
                **limits,
            ),
            config={"parameters": params.as_dict()},
        )
        for mode in (1, 2)
        for form, option in options.items()
    }


def test_contact_is_lost_at_the_line():
    """Largest y reaches l_pre at the linear frequency and falls in frequency above it."""
    branches = _branches(0.5, 1.0)
    figure = fig10_to_12.draw(branches)
    lines = {line.get_label(): line for line in figure.axes[1].get_lines()}
    exact, drawn = branches["backbone/F10_mode2"], lines["largest y"].get_xydata()
    np.testing.assert_allclose(drawn.T, [exact.omega, exact.y_peak])
    preload = lines[r"$l_\mathrm{pre}$, contact is lost"].get_ydata()[0]
    kept = drawn[:, 1] <= preload
    assert kept.any()
    np.testing.assert_allclose(drawn[kept, 0], drawn[0, 0])
    assert (np.diff(drawn[~kept, 0]) < 0).all()


def test_unstable_stretches_are_dotted_what_a4_does_not_cover_is_grey_and_a_reason_is_written():
    figure = coupled_backbones.draw(_branches(0.3, 0.9, y_peak_max=5.0), {})
    dotted = [
        line for line in figure.axes[0].get_lines() if line.get_linestyle() == ":"
    ]
    assert any(
        np.isfinite(np.asarray(line.get_ydata(), float)).any() for line in dotted
    )
    figure = fig13.draw(_branches(5 / 6, 5 / 6, FORMER.with_(belt_speed=0.2)))
    assert "mass overtakes the belt" in figure.axes[0].get_legend_handles_labels()[1]
    figure = fig10_to_12.draw(_branches(0.4, 0.6))
    assert "singular static state" in figure.axes[0].texts[0].get_text()


def test_symbols_are_set_as_symbols():
    text = "N_h = 8, l_pre, tol 1e-08, DOP853, 1e-10"
    assert (
        symbols(text)
        == r"$N_\mathrm{h}$ = 8, $l_\mathrm{pre}$, tol 10⁻⁸, DOP853, 10⁻¹⁰"
    )


def test_doubled_branches_are_drawn_at_twice_their_frequency():
    """A scene with a doubling has an inset, one without has none."""
    scenes = {"one": 4.5, "none": 3.0}
    backbones, doubled = {}, {}
    for name, peak in scenes.items():
        backbones |= _branches(0.3, 0.9, scene=name, y_peak_max=peak)
        for number in (1, 2):
            given = {"mode": 1, "doubling": number, "y_peak_max": peak}
            found = follow_doubling(FORMER, 0.3 * PI, 0.9 * PI, **given)
            doubled[f"doubled_branch/{name}_{number}"] = found
    first, _, second, _ = coupled_backbones.draw(backbones, doubled).axes
    (inset,) = first.child_axes
    branch = doubled["doubled_branch/one_1"]
    starts = [line.get_xdata()[0] for line in inset.lines]
    assert any(np.isclose(start, 2.0 * float(branch.omega[0])) for start in starts)
    assert second.child_axes == []
