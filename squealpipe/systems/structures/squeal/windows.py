"""Windows of runs from many states at once, and the statistics of each.

Instants at which a motion is looked at are drawn at random, one in each of many equal parts of the
window, so that none of its statistics depends on a step that is in time with its period.
"""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from squealpipe.methods.spectrum import amplitude_spectrum, strongest_lines
from squealpipe.schema import Outcome
from squealpipe.systems.integrate import LARGEST, RunOptions, integrate
from squealpipe.systems.structures.squeal.plant import Plant
from squealpipe.vibration.settling import WindowLevels

SAMPLES = 2048
"""Instants of a window."""
PADDING = 4
"""Lines of a spectrum beside those of its samples."""
BLOCKS = 64
"""Parts of a window whose kinetic energy is kept."""


@dataclass(frozen=True)
class Running:
    """How windows are run.

    Attributes:
        tol: tolerance of the Taylor integrator.
        seed: that the instants at which a motion is looked at follow from.
        workers: processes; None takes all cores.
    """

    tol: float
    seed: int = 0
    workers: int | None = None

    def turn(self, number: int) -> Self:
        """Likewise, with instants of their own."""
        return replace(self, seed=self.seed + number)


@dataclass(frozen=True)
class Rows:
    """Statistics of one window of some runs, rows first.

    Attributes:
        final, regimes: state and regime of each component at the end.
        modal: rms velocity of each mode at rest, √J.
        speed: rms speed of vibration of each contact, m/s.
        peak_speed: the largest of the samples.
        separated, stuck: shares of the time, of each contact.
        landings: returns to contact, of each.
        force: largest force of each, N.
        events: all of them.
        steps: of the integrator.
        kinetic: mean kinetic energy of each block, J.
        block_ends: of each block from the window's begin, s.
        finished: whether the run reached the end of its window.
        length: of the window, s.
    """

    final: np.ndarray
    regimes: np.ndarray
    modal: np.ndarray
    speed: np.ndarray
    peak_speed: np.ndarray
    separated: np.ndarray
    stuck: np.ndarray
    landings: np.ndarray
    force: np.ndarray
    events: np.ndarray
    steps: np.ndarray
    kinetic: np.ndarray
    block_ends: np.ndarray
    finished: np.ndarray
    length: np.ndarray

    def at(self, rows: Any) -> Self:
        """Some of the runs, or one."""
        return type(self)(**{name: value[rows] for name, value in vars(self).items()})

    @property
    def total(self) -> np.ndarray:
        """rms of the velocities of all modes, √J."""
        return np.asarray(np.sqrt((self.modal**2).sum(-1)))

    @property
    def levels(self) -> WindowLevels:
        """Statistics by which the window of one run is compared."""
        return WindowLevels(self.modal, self.separated, self.stuck, self.force)

    def mean(self) -> Self:
        """Merge runs of one motion into one: means, and the largest of largest values."""
        values = {
            name: value.mean(axis=0, dtype=float)
            if name in ("modal", "speed", "separated", "stuck", "landings")
            else value.max(axis=0)
            if name in ("force", "peak_speed")
            else value[0]
            for name, value in vars(self).items()
        }
        return type(self)(**values)


def still(plant: Plant, regimes: np.ndarray) -> Rows:
    """The window of steady sliding, where nothing of the push is left.

    Args:
        regimes: of each component there.
    """
    contacts = np.zeros(len(plant.contacts))
    return Rows(
        final=plant.sliding,
        regimes=regimes,
        modal=np.zeros(plant.size),
        speed=contacts,
        peak_speed=np.zeros(()),
        separated=contacts,
        stuck=contacts,
        landings=contacts,
        force=plant.spectrum.state.force,
        events=np.zeros((), int),
        steps=np.zeros((), int),
        kinetic=np.zeros(BLOCKS),
        block_ends=np.arange(1, BLOCKS + 1) / BLOCKS,
        finished=np.array(True),
        length=np.ones(()),
    )


def run(
    plant: Plant,
    states: np.ndarray,
    times: np.ndarray,
    how: Running,
    frictions: np.ndarray | None = None,
    **options: Any,
) -> dict[str, np.ndarray]:
    """Raw results from some states, sampled at instants whose last one ends the run.

    Args:
        times: (instants,) or (runs, instants), s.
        frictions: of each run; None: that of the structure.
        options: of :class:`squealpipe.systems.integrate.RunOptions`.
    """
    system, size = plant.system, len(states)
    values = {name: states[:, i] for i, name in enumerate(system.states)}
    values |= {name: np.full(size, value) for name, value in system.parameters.items()}
    if frictions is not None:
        values["mu"] = frictions
    ends = np.broadcast_to(np.atleast_2d(times)[:, -1], (size,)).copy()
    return integrate(
        system,
        values,
        ends,
        RunOptions(
            times=times,
            tracked=[f"{LARGEST}{name}_normal_force" for name in plant.contacts],
            **options,
        ),
        tol=how.tol,
        workers=how.workers,
    )


def run_window(
    plant: Plant,
    states: np.ndarray,
    length: float,
    how: Running,
    regimes: np.ndarray | None = None,
    frictions: np.ndarray | None = None,
) -> Rows:
    """Run for a length of time, s.

    Args:
        regimes: of each component in which each run starts; None: what fits.
        frictions: of each run; None: that of the structure.
    """
    part = np.random.default_rng(how.seed).random(SAMPLES)
    times = length * (np.arange(SAMPLES) + part) / SAMPLES
    times = np.append(times, length)
    options = {} if regimes is None else {"regime": regimes}
    raw = run(plant, states, times, how, frictions, **options)
    return statistics_of(plant, raw, length)


def statistics_of(plant: Plant, raw: dict[str, np.ndarray], length: float) -> Rows:
    """Statistics of windows by the raw results of their runs, whose last sample is their end."""
    size = len(raw["final"])
    samples = raw["samples"][:, :-1]
    modal = plant.modal_velocities(samples)
    speed = plant.contact_speeds(samples)
    kinetic = 0.5 * (modal**2).sum(-1)
    shares = raw["durations"] / length
    separated, stuck = (
        np.stack([shares[:, places].sum(1) for places in _regimes(plant, word)], 1)
        for word in ("separated", "stick")
    )
    kinds = plant.system.traced.kinds
    landings = np.stack(
        [raw["counts"][:, kinds.index(f"{name}_contact")] for name in plant.contacts], 1
    )
    with np.errstate(invalid="ignore"):
        return Rows(
            final=raw["final"],
            regimes=raw["sample_regimes"][:, -1].copy(),  # as a start of the next
            modal=np.sqrt((modal**2).mean(1)),
            speed=np.sqrt((speed**2).mean(1)),
            peak_speed=speed.max(axis=(1, 2)),
            separated=separated,
            stuck=stuck,
            landings=landings,
            force=raw["extremes"][..., 1],
            events=raw["counts"].sum(1),
            steps=raw["steps"],
            kinetic=np.stack(
                [part.mean(1) for part in np.array_split(kinetic, BLOCKS, axis=1)], 1
            ),
            block_ends=np.tile(length * np.arange(1, BLOCKS + 1) / BLOCKS, (size, 1)),
            finished=raw["outcome"] == Outcome.converged,
            length=np.full(size, length),
        )


def _regimes(plant: Plant, word: str) -> list[list[int]]:
    """Of each contact, the numbers of its regimes of a kind."""
    # by owner: of contacts p and p_stick, the second one's regimes begin like the first one's
    owners = plant.system.traced.component_of.tolist()
    numbered = list(enumerate(zip(plant.system.regimes, owners, strict=True)))
    return [
        [
            i
            for i, (name, owner) in numbered
            if owner == place and name.startswith(f"{contact}_{word}")
        ]
        for place, contact in enumerate(plant.contacts)
    ]


def strongest_line(modal: np.ndarray, step: float) -> float:
    """The strongest line of the kinetic energy by modal velocities (instants, n), Hz, or NaN."""
    omega, amplitude = amplitude_spectrum(modal.T, step, padding=PADDING)
    power = np.sqrt((amplitude**2).sum(axis=0))
    places, _ = strongest_lines(omega, power, 1, 2.0 * np.pi / (step * len(modal)))
    return float(places[0] / (2.0 * np.pi)) if places.size else np.nan
