"""What an answer to a hard scene is worth: right, flagged or silently wrong, from its error."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.comparison import FAILURE_ATLAS, Reliability, Role

BASE = Parameters(k3=0.75, mu=0.3, belt_speed=100.0, length1=5.0, length2=5.0)
"""Parameters at which the scenes are hard, whatever the study's are."""


@dataclass(frozen=True)
class Answer:
    """What a method said.

    Attributes:
        value: its answer; NaN or empty where it gave none.
        flag: its warning, empty where it gave none.
    """

    value: np.ndarray | float
    flag: str = ""


@dataclass(frozen=True)
class Method:
    """A method of the atlas: its name and whose it is."""

    name: str
    role: Role = Role.public


@dataclass(frozen=True)
class HardScene:
    """A scene with its true answer and what to ask each method.

    Attributes:
        name: of the scene.
        truth: the answer; NaN where there is none, so that only a warning is right.
        tolerance: largest error that counts as right.
        answers: method name → how to get its answer; methods left out cannot be asked.
    """

    name: str
    truth: np.ndarray | float
    tolerance: float
    answers: Mapping[str, Callable[[], Answer]]


def error_of(answer: Answer, truth: np.ndarray | float) -> float:
    """Largest difference; infinite without an answer.

    Where nothing is true, any finite answer is infinitely wrong and none is right.
    """
    value, expected = np.atleast_1d(answer.value), np.atleast_1d(truth)
    if not np.isfinite(expected).all():
        return math.inf if np.isfinite(value).all() else 0.0
    if value.shape != expected.shape or not np.isfinite(value).all():
        return math.inf
    return float(np.abs(value - expected).max())


def verdict_of(error: float, tolerance: float, flag: str, truth: np.ndarray | float) -> Reliability:
    """Right within the tolerance, else flagged or silently wrong."""
    if not np.isfinite(truth).all():
        return Reliability.flagged if flag else Reliability.silently_wrong
    if error <= tolerance:
        return Reliability.right
    return Reliability.flagged if flag else Reliability.silently_wrong


def failure_atlas(scenes: Sequence[HardScene], methods: Sequence[Method]) -> xr.Dataset:
    """Dataset ``failure_atlas``: every method that can be asked on every scene.

    Args:
        scenes: with their true answers.
        methods: the columns; ours first.
    """
    shape = (len(scenes), len(methods))
    verdict = np.zeros(shape, dtype=int)
    error = np.full(shape, np.nan)
    messages = np.full(shape, "", dtype="U64")
    for row, scene in enumerate(scenes):
        for column, method in enumerate(methods):
            if method.name not in scene.answers:
                continue
            answer = scene.answers[method.name]()
            error[row, column] = error_of(answer, scene.truth)
            verdict[row, column] = verdict_of(
                error[row, column], scene.tolerance, answer.flag, scene.truth
            )
            messages[row, column] = answer.flag[:64]
    return build(
        FAILURE_ATLAS,
        {
            "verdict": verdict,
            "error": error,
            "flagged": messages != "",
            "message": messages,
            "tolerance": [scene.tolerance for scene in scenes],
            "role": [method.role for method in methods],
        },
        {
            "scene": [scene.name for scene in scenes],
            "solver": [method.name for method in methods],
        },
    )
