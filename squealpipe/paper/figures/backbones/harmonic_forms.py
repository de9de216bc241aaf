"""The paper's own form of harmonic balance against the exact orbits."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squealpipe.brake.schema.backbones import Form
from squealpipe.plotting import style
from squealpipe.plotting.origin import scene_name
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=("harmonic_forms",),
    caption=(
        "The paper's harmonic balance, Eqs. (28) to (36), started at the exact orbits. (a) "
        "Frequencies found with Eq. (34) corrected (K₁₂a + K₂₂b) and as printed (K₁₁a + K₁₂b), "
        "beside the exact ones. (b) There is no phase condition: spread of the largest y over the "
        "phases of the start, against the samples N; circled where Γ lacks full rank."
    ),
    alt="Frequencies found by two forms against exact ones, and spread of y over the samples.",
)
def draw(forms: xr.Dataset) -> Figure:
    """Two panels from dataset ``harmonic_forms``."""
    figure, axes = style.new_figure(style.PAGE, 3.2, ncols=2, width_ratios=[1.3, 1])
    _frequencies(axes[0, 0], forms)
    _spread(axes[0, 1], forms)
    title = style.symbols(f"phase dependence, N_h = {int(forms.n_harmonics)}")
    style.panel_letters(axes[0], ("frequency found", title))
    return figure


def _frequencies(panel: Axes, forms: xr.Dataset) -> None:
    places = np.arange(forms.sizes["scene"])
    panel.plot(
        places,
        forms.omega_exact,
        "_",
        color=style.Colour.grey,
        ms=22,
        mew=2,
        label="exact",
    )
    for form, colour, marker, name in (
        (Form.mended, style.Colour.blue, "x", "Eq. (34) corrected"),
        (Form.as_printed, style.Colour.red, "o", "Eq. (34) as printed"),
    ):
        omega = forms.omega.sel(form=form).values
        panel.plot(places, omega, marker, mfc="none", color=colour, label=name)
    names = [
        scene_name(forms, name).replace(", ", ",\n")
        for name in forms.scene.values.tolist()
    ]
    panel.set_xticks(places, names)
    panel.set(ylabel="ω (rad/s)", ylim=(-0.05, None))
    panel.margins(x=0.12)
    panel.legend(
        loc="upper center", bbox_to_anchor=(0.5, -0.27), ncols=3, handlelength=3.2
    )


def _spread(panel: Axes, forms: xr.Dataset) -> None:
    panel.plot(
        forms.samples,
        forms.phase_spread_y,
        marker="s",
        color=style.Colour.orange,
        markersize=4,
    )
    lacking = forms.phase_spread_y.where(forms.fourier_rank < forms.fourier_columns)
    look = {
        "ms": 9,
        "mfc": "none",
        "color": style.Colour.red,
        "label": "Γ lacks full rank",
    }
    panel.loglog(forms.samples, lacking, "o", **look)
    panel.set(xlabel="samples $N$", ylabel="spread of the largest y (m)")
    panel.set_xticks(
        forms.samples.values[[0, 3, 4, 5]], forms.samples.values[[0, 3, 4, 5]]
    )
    panel.xaxis.minorticks_off()
    # over more than this, powers of ten label the axis well enough
    if np.ptp(np.log10(panel.get_ylim())) > 1.5:
        panel.yaxis.minorticks_off()
    panel.legend(loc="lower left")
