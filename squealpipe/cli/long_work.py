"""Estimates of the memory and time of a big map, before it is begun."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from math import prod, sqrt
from typing import TYPE_CHECKING, Any

from squealpipe.cli.console import say
from squealpipe.systems.inputs.words import duration

if TYPE_CHECKING:
    from squealpipe.parameters import Parameters

MANY_CELLS = 250_000
"""A map of at least so many cells says beforehand what it takes."""


def say_what_it_takes(
    function: str, params: Parameters, angles: Sequence[Any], options: Mapping[str, Any]
) -> None:
    """Say how long a map of many cells takes, measured on a few of them.

    Raises:
        ValueError: it does not fit into the memory of this machine.
    """
    if len(angles) != 2 or not all(hasattr(angle, "__len__") for angle in angles):
        return
    sizes = [len(angle) for angle in angles]
    cells = prod(sizes)
    if cells < MANY_CELLS:
        return
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    # arrays of the size of the result that are in memory at once, about
    copies = 3
    needed = cells * bytes_per_cell(function) * copies
    # the rest of the machine's memory is left to others
    share_of_memory = 0.8
    if needed > share_of_memory * memory:
        side = int(sqrt(share_of_memory * memory / bytes_per_cell(function) / copies))
        raise ValueError(
            f"{sizes[0]} × {sizes[1]} = {cells:,} cells would take about {needed / 1e9:.0f} GB, "
            f"this machine has {memory / 1e9:.0f}; up to about {side} × {side} fit: take fewer "
            "angles"
        )
    import squealpipe

    # a map of 12 × 12 angles tells the time of the whole well enough
    few = [list(angle)[:: max(1, len(angle) // 12)] for angle in angles]
    task = getattr(squealpipe, function)
    task(params, few[0][:2], few[1][:2], **options)  # what is compiled first
    started = time.perf_counter()
    task(params, *few, **options)
    each = (time.perf_counter() - started) / (len(few[0]) * len(few[1]))
    say(
        f"{cells:,} cells: at most about {duration(each * cells)} and {needed / 1e9:.1f} GB of "
        "memory; Ctrl-C ends it"
    )


def bytes_per_cell(function: str) -> int:
    """Size of what a map has in each cell."""
    from squealpipe.schema import find

    return sum(
        entry.stored.itemsize * 4 ** (len(entry.dims) - 2)
        for entry in find(function).variables.values()
        if {"alpha1", "alpha2"} <= {*entry.dims}
    )
