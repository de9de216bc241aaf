"""Shapes of complex modes for pictures, at one value of what was varied."""

from __future__ import annotations

from typing import Any

import numpy as np


def shape_variables(
    structure: Any,
    ways: np.ndarray,
    frictions: list[float],
    own: float,
    numbers: list[int],
) -> dict[str, Any]:
    """Return shapes over (mode, degree_of_freedom) as variables of a dataset of complex modes.

    They are those at the structure's own speed and friction, or at the nearest values that were
    computed. The largest displacement of each is 1, at phase 0: at that instant the real part is
    the shape, and a quarter of a period later the negative imaginary part.

    Args:
        ways: modes along friction at each combination of factors, (belt speed, …).
        own: friction of the structure, as the frictions are counted.
        numbers: of the modes in the dataset.
    """
    slides = [way for way in ways.ravel() if any(mu in way.steps for mu in frictions)]
    way = min(
        slides, key=lambda each: abs(each.solver.belt_speed - structure.belt_speed)
    )
    mu = min((mu for mu in frictions if mu in way.steps), key=lambda mu: abs(mu - own))
    step = way.steps[mu]
    shapes = step.spectrum.shapes
    if structure.modes is not None:
        shapes = structure.modes @ shapes
    size = len(shapes)
    largest = shapes[np.abs(shapes).argmax(axis=0), np.arange(shapes.shape[1])]
    shapes = shapes / np.where(largest == 0.0, 1.0, largest)
    table = np.full((len(numbers), size), np.nan, np.complex64)
    values = step.spectrum.values
    # unstable ones first, then by frequency
    order = np.lexsort((values.imag, -(values.real > 0).astype(int)))
    place_of = {number: index for index, number in enumerate(numbers)}
    # of all shapes together: beyond it, stable modes of the highest frequencies are left out
    most_bytes = 50e6
    for column in order[: int(most_bytes / (8 * size))]:
        place = place_of.get(int(step.numbers[column]))
        if place is not None:
            table[place] = shapes[:, column]
    return {
        "shape_real": table.real,
        "shape_imaginary": table.imag,
        "shape_mu": mu,
        "shape_belt_speed": way.solver.belt_speed,
    }
