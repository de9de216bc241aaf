"""Fig. 1: the mechanism."""

import numpy as np
from matplotlib.figure import Figure

from squealpipe.plotting.mechanism import draw_mechanism
from squealpipe.plotting.style import COLUMN, new_figure
from squealpipe.study.figures.declared import report_figure


@report_figure(
    reads=(),
    caption=(
        "The model: a particle of mass m on two inclined springs k₁ and k₂, pressed through the "
        "contact spring k₃ on a belt that moves at V. The foot of k₃ slides along with the mass, "
        "and k₃ can only push: it is compressed by l_pre at the start, and contact is lost where y "
        "= l_pre."
    ),
    alt=(
        "A round mass on two slanted springs and a vertical contact spring that stands on a belt; "
        "beside it the height at which contact is lost."
    ),
)
def draw() -> Figure:
    """The mechanism at a general pair of angles, with the paper's symbols."""
    figure, axes = new_figure(COLUMN, 2.9)
    draw_mechanism(axes[0, 0], 0.3 * np.pi, 0.2 * np.pi, labels=True)
    return figure
