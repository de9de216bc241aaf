"""Lines of a function that is its own mirror image, against those that are followed everywhere."""

import numpy as np
import pytest

from squealpipe.brake.curves.regions import loops_of
from squealpipe.brake.curves.zero_lines import FirstGrid, ZeroLines


def kinked(places):
    """A disc across the diagonal, and beside it two that overlap, so that there are corners."""

    def disc(u, v, r):
        return r - np.hypot(places[:, 0] - u, places[:, 1] - v)

    pairs = [(0.25, 0.3, 0.12), (0.35, 0.3, 0.1)]
    discs = [disc(0.5, 0.5, 0.08), *(disc(*each) for each in pairs)]
    discs += [disc(1.0 - v, 1.0 - u, r) for u, v, r in pairs]
    return np.max(discs, axis=0), np.argmax(discs, axis=0)


def traced(*, mirrored):
    asked = [0]

    def value(places):
        asked[0] += len(places)
        return kinked(places)[0]

    def branch(places, slope):
        """Discs by number; mirror images have one."""
        number = kinked(places + 0.0 * slope)[1]
        return np.where(number > 2, number - 2, number).astype(float)

    lines = ZeroLines(value, branch, FirstGrid(31, 4), jump=0.5, mirrored=mirrored)
    return lines, asked[0]


def test_half_of_the_lines_is_copied():
    """Area in closed form, closed lines, the positive side on the left, half as many places."""
    whole, many = traced(mirrored=False)
    half, few = traced(mirrored=True)
    assert few < 0.6 * many
    distance, (a, b) = 0.1, (0.12, 0.1)
    angles = [
        np.arccos((distance**2 + r**2 - q**2) / (2.0 * distance * r))
        for r, q in ((a, b), (b, a))
    ]
    lens = sum(
        r**2 * (t - 0.5 * np.sin(2.0 * t)) for r, t in zip((a, b), angles, strict=True)
    )
    exact = np.pi * 0.08**2 + 2.0 * (np.pi * (a**2 + b**2) - lens)
    for lines in (whole, half):
        loops = loops_of(lines, positive=True)
        area, error = (sum(loop[k] for loop in loops) for k in (1, 2))
        assert abs(area - exact) <= max(error, 1e-9)
        assert area == pytest.approx(exact, rel=1e-6)
        ends = np.bincount(lines.chords.ravel(), minlength=len(lines.place))
        assert set(ends[ends > 0]) == {2}
    assert half.unresolved == whole.unresolved == 0.0
    image = 1.0 - half.place[:, ::-1]
    apart = np.abs(image[:, None] - half.place[None]).max(axis=2).min(axis=1)
    assert apart.max() < 1e-9
