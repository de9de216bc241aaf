"""The answer of a dataset ``squeal_ladder`` in words: the finest run, then each method."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from squealpipe.benchmark.schema import Role
from squealpipe.structures.schema.squeal_ladder import PushAnswer
from squealpipe.systems.datasets.outcomes import Outcome
from squealpipe.systems.inputs.units import engineering
from squealpipe.systems.inputs.words import number


def lines(ladder: xr.Dataset) -> list[str]:
    """Return the answer of the finest run, that of each method beside it, and their cost, as
    sentences.
    """
    finest = int(np.flatnonzero(ladder.role.values == Role.our_setting)[0])
    truth = ladder.isel(run=finest)
    told = [f"Finest: exact events in {truth.setting.item()}."]
    told += [f"A push along {line}." for line in _pushes(truth)]
    for index in range(ladder.sizes["run"]):
        if index != finest:
            told.append(method_line(ladder.isel(run=index)))
    return told


def _pushes(one: xr.Dataset) -> Iterator[str]:
    for index in range(one.sizes["mode"]):
        end = one.isel(mode=index)
        yield f"mode {int(end.mode)} {rings(end)}"


def rings(end: xr.Dataset) -> str:
    """Describe the vibration after a push."""
    if int(end.outcome) == Outcome.no_convergence:
        return "is not followed to the end"
    is_quiet = bool(np.isnan(end.frequency))
    at = "" if is_quiet else f" at {engineering(float(end.frequency), 'Hz', 4)}"
    if int(end.outcome) != Outcome.converged:
        loudest = at and f", where it is loudest{at}"
        return f"has not settled by the end of its run{loudest}"
    return "dies out" if is_quiet else f"rings{at}"


def method_line(one: xr.Dataset) -> str:
    """Return a method's answer to each push, its error and its cost in one sentence."""
    parts = []
    words_of = {
        PushAnswer.right: "rightly",
        PushAnswer.other_mode: "which is another mode",
        PushAnswer.quiet_instead: "which is wrong",
        PushAnswer.rings_instead: "which is wrong",
        PushAnswer.not_known: "of which the finest run says nothing",
    }
    for index in range(one.sizes["mode"]):
        end = one.isel(mode=index)
        answer = PushAnswer(int(end.answer))
        said = f"mode {int(end.mode)} {rings(end)}"
        if answer in words_of:
            said += f", {words_of[answer]}"
        elif answer is PushAnswer.no_such_mode:
            said = f"it has no mode {int(end.mode)}"
        parts.append(said)
    level = float(one.velocity_error)
    off = "" if np.isnan(level) else f"; level off by {number(100 * level, 2)} %"
    return (
        f"{one.method.item()}, {one.setting.item()}: {'; '.join(parts)}{off}; "
        f"{number(float(one.cpu_time), 2)} s"
    )
