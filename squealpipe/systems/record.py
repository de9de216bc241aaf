"""The record of one run with all its events."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from squealpipe.systems.integrate import RunOptions, integrate
from squealpipe.systems.tracing import TracedSystem as System

FIRST_LOG = 256
"""Events kept at first; a run that has more is made again with room for all."""
_default_options = RunOptions()


@dataclass(frozen=True)
class RunRecord:
    """One run with its events.

    Attributes:
        regimes: numbers, in ``system.joint``, of the first ones and of those after each event.
        times, kinds, states, entered: of the events, the states after them, the regimes entered.
        final: state at the end.
        path, path_regimes: at the asked instants; the regimes of each component.
        outcome, reached, steps: how and when it ended, and after how many steps.
        n_events: how many there were, also where no room was asked for.
    """

    regimes: np.ndarray
    times: np.ndarray
    kinds: np.ndarray
    states: np.ndarray
    entered: np.ndarray
    final: np.ndarray
    path: np.ndarray
    path_regimes: np.ndarray
    outcome: int
    reached: float
    steps: int
    n_events: int


def single_run(
    system: System,
    values: Mapping[str, float],
    t_end: float,
    options: RunOptions = _default_options,
    *,
    tol: float,
    room: int = FIRST_LOG,
) -> RunRecord:
    """Run a system once from states and parameters; ``room`` is that for events at first."""
    arrays = {name: np.array([value]) for name, value in values.items()}
    while True:
        raw = integrate(
            system,
            arrays,
            np.array([t_end]),
            replace(options, log_events=room),
            tol=tol,
        )
        count = int(raw["n_events"][0])
        if count <= room or not room:
            break
        room = count
    events = {
        key: raw[f"event_{key}"][0, :count]
        for key in ("times", "kinds", "states", "regimes")
    }
    return RunRecord(
        regimes=system.joint.along(
            raw["first_regimes"][0].tolist(), events["regimes"].tolist()
        ),
        times=events["times"],
        kinds=events["kinds"],
        states=events["states"],
        entered=events["regimes"],
        final=raw["final"][0],
        path=raw["samples"][0],
        path_regimes=raw["sample_regimes"][0],
        outcome=int(raw["outcome"][0]),
        reached=float(raw["reached"][0]),
        steps=int(raw["steps"][0]),
        n_events=count,
    )
