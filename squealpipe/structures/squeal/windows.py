"""Windows of runs from many states at once, and the statistics of each.

Instants at which a motion is looked at are drawn at random, one in each of many equal parts of the
window, so that none of its statistics depends on a step that is in time with its period.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Self

import numpy as np

from squealpipe.codes import Regime
from squealpipe.schema import Outcome
from squealpipe.structures.motion_system import regime_codes
from squealpipe.structures.squeal.plant import PUSH_OF_A_MODE, Plant
from squealpipe.systems.integrate import LARGEST, RunOptions, integrate
from squealpipe.systems.progress import stop_is_asked
from squealpipe.vibration.settling import Settling, late_growth, tapered
from squealpipe.vibration.windows import Windows

BLOCKS = 64
"""Parts of a window whose kinetic energy is kept."""


@dataclass(frozen=True)
class Running:
    """Settings of the windows' runs.

    Attributes:
        tol: tolerance of the Taylor integrator.
        seed: that the instants at which a motion is looked at follow from.
        workers: processes; None takes all cores where there are many runs.
        cost: CPU time of one second of motion, s, by which long calls are cut into pieces; 0: it is
            not known, and none is cut.
    """

    tol: float
    seed: int = 0
    workers: int | None = None
    cost: float = 0.0

    def turn(self, number: int) -> Self:
        """Likewise, with instants of their own."""
        return replace(self, seed=self.seed + number)


@dataclass(frozen=True, kw_only=True)
class StructureWindows(Windows):
    """Windows of a structure; velocities are those of the modes at rest, √J.

    Attributes:
        speed: rms speed of vibration of each contact, m/s.
        peak_speed: the largest of the samples.
        landings: returns to contact, of each.
        events: all of them.
        steps: of the integrator.
        kinetic: mean kinetic energy of each block, J.
        block_ends: of each block from the window's begin, s.
    """

    speed: np.ndarray
    peak_speed: np.ndarray
    landings: np.ndarray
    events: np.ndarray
    steps: np.ndarray
    kinetic: np.ndarray
    block_ends: np.ndarray


def still(plant: Plant) -> StructureWindows:
    """Return the window of steady sliding, where nothing of the push is left."""
    contacts = np.zeros(len(plant.contacts))
    return StructureWindows(
        final=plant.sliding,
        regimes=plant.regimes_at_rest,
        velocities=np.zeros(plant.size),
        largest_velocity=np.zeros(()),
        speed=contacts,
        peak_speed=np.zeros(()),
        separated=contacts,
        stuck=contacts,
        separations=contacts,
        landings=contacts,
        forces=plant.sliding_forces,
        switched=np.array(False),
        events=np.zeros((), int),
        steps=np.zeros((), int),
        kinetic=np.zeros(BLOCKS),
        block_ends=np.arange(1, BLOCKS + 1) / BLOCKS,
        finished=np.array(True),
        length=np.ones(()),
        growth=np.array(np.nan),
        late_growth=np.array(np.nan),
        fades=np.array(False),
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


def run_windows(
    plant: Plant,
    states: np.ndarray,
    lengths: np.ndarray | float,
    how: Running,
    regimes: np.ndarray | None = None,
    frictions: np.ndarray | None = None,
) -> StructureWindows:
    """Run states on, each for its length of time, s.

    Args:
        lengths: (runs,), or one for all.
        regimes: of each component in which each run starts; None: what fits.
        frictions: of each run; None: that of the structure.
    """
    count = len(states)
    lengths = np.broadcast_to(np.asarray(lengths, float), (count,))
    # instants of a window
    samples = 2048
    part = np.random.default_rng(how.seed).random(samples)
    times = np.append((np.arange(samples) + part) / samples, 1.0)
    pieces = _pieces(count * samples * 2 * plant.size, how.cost * lengths.sum(), how)
    parts: list[StructureWindows] = []
    for number, instants in enumerate(np.split(times[:-1], pieces)):
        inside = np.append(instants - number / pieces, 1.0 / pieces)
        options = {} if regimes is None else {"regime": regimes}
        raw = run(plant, states, lengths[:, None] * inside, how, frictions, **options)
        parts.append(
            statistics_of(plant, raw, lengths / pieces, blocks=BLOCKS // pieces)
        )
        states, regimes = parts[-1].final, parts[-1].regimes
        if stop_is_asked():
            break
    return merged(parts)


def _pieces(numbers: int, seconds: float, how: Running) -> int:
    """Return into how many pieces, a power of two, a call is cut.

    Args:
        numbers: how many it would store.
        seconds: CPU time that it takes.
    """
    most_numbers = 2**26  # half a gigabyte
    # an interrupt is heard, and progress shown, after so many seconds
    longest = 5.0
    needed = max(numbers / most_numbers, seconds / (how.workers or 1) / longest, 1.0)
    return int(min(2 ** np.ceil(np.log2(needed)), BLOCKS))


def merged(parts: Sequence[StructureWindows]) -> StructureWindows:
    """Return one window of several of one motion, which ends as the last of them does."""
    if len(parts) == 1:
        return parts[0]
    last = parts[-1]
    values = {
        name: np.stack([getattr(part, name) for part in parts])
        for name in vars(last)
        if name not in ("kinetic", "block_ends")
    }
    lengths = values["length"]
    shares = lengths / lengths.sum(axis=0)

    def mean(values: np.ndarray) -> Any:
        extra = (1,) * (values.ndim - shares.ndim)
        return (values * shares.reshape(*shares.shape, *extra)).sum(axis=0)

    ways: dict[str, Callable[[np.ndarray], Any]] = {
        **dict.fromkeys(("velocities", "speed"), lambda v: np.sqrt(mean(v**2))),
        **dict.fromkeys(("separated", "stuck"), mean),
        "switched": partial(np.any, axis=0),
        "finished": partial(np.all, axis=0),
        **dict.fromkeys(
            ("separations", "landings", "events", "steps", "length"),
            partial(np.sum, axis=0),
        ),
        **dict.fromkeys(
            ("forces", "peak_speed", "largest_velocity"), partial(np.max, axis=0)
        ),
    }
    joined = {name: way(values[name]) for name, way in ways.items()}
    begins = np.cumsum(lengths, axis=0) - lengths
    ends = [
        part.block_ends + begin[..., None]
        for part, begin in zip(parts, begins, strict=True)
    ]
    return replace(
        last,
        kinetic=np.concatenate([part.kinetic for part in parts], axis=-1),
        block_ends=np.concatenate(ends, axis=-1),
        **joined,
    )


@np.errstate(over="ignore", invalid="ignore", divide="ignore")
def followed_windows(
    plant: Plant,
    states: np.ndarray,
    lengths: np.ndarray,
    how: Running,
    regimes: np.ndarray | None,
    beside: Sequence[np.ndarray | None],
    rules: Settling,
) -> tuple[StructureWindows, np.ndarray]:
    """Run states on beside neighbours, for the growth of a small perturbation.

    Means are tapered over uniform instants, so that two windows of a cycle agree closely.

    Args:
        beside: direction of each perturbation, (states,); None: at random.
        rules: which say how many instants are looked at.

    Returns:
        The windows, and the perturbations at their end.
    """
    count = len(states)
    rng = np.random.default_rng(how.seed)
    off = np.array(
        [
            rng.standard_normal(states.shape[1]) if each is None else each
            for each in beside
        ]
    )
    # of a state that is drawn the parts have sizes of their own
    drawn = np.array([each is None for each in beside])
    spread = (
        np.sqrt(((states - plant.sliding) ** 2).mean(axis=0))
        + np.abs(plant.sliding).max() * 1e-6
    )
    off[drawn] *= spread
    extent = plant.sizes(states - plant.sliding)
    extent = np.maximum(extent, PUSH_OF_A_MODE * np.sqrt(plant.energy))
    # size of a perturbation, over the motion's; ten times as much is seen beside small motions
    distance = 1e-8
    off *= (distance * extent / plant.sizes(off))[:, None]
    instants = np.arange(1, rules.samples + 1) / rules.samples
    both = np.concatenate([states, states + off])
    spans = np.tile(lengths, 2)
    options = {} if regimes is None else {"regime": np.tile(regimes, (2, 1))}
    raw = run(plant, both, spans[:, None] * instants, how, sums=True, **options)
    ran = {name: value[:count] for name, value in raw.items()}
    windows = statistics_of(plant, ran, lengths)
    away = raw["samples"][count:] - raw["samples"][:count]
    sizes = plant.sizes(away) + np.finfo(float).tiny
    growth = np.log(sizes / plant.sizes(off)[:, None])
    samples = ran["samples"]
    square = plant.modal_velocities(samples) ** 2
    steps = np.diff(ran["sample_durations"], axis=1, prepend=0.0)
    shares = steps * (rules.samples / lengths[:, None, None])
    separated, stuck = (
        np.stack(
            [shares[..., places].sum(-1) for places in _regimes(plant, regime)], -1
        )
        for regime in (Regime.separated, Regime.stick)
    )
    ended = np.array_split(growth, 16, axis=1)[-1].mean(axis=1)
    measured = replace(
        windows,
        velocities=np.sqrt(tapered(np.moveaxis(square, 1, 0))),
        separated=tapered(np.moveaxis(separated, 1, 0)),
        stuck=tapered(np.moveaxis(stuck, 1, 0)),
        growth=ended,
        late_growth=late_growth(growth.T),
    )
    return measured, away[:, -1]


@np.errstate(over="ignore", invalid="ignore")  # what grows without bound overflows
def statistics_of(
    plant: Plant,
    raw: dict[str, np.ndarray],
    lengths: np.ndarray | float,
    blocks: int = BLOCKS,
) -> StructureWindows:
    """Statistics of windows by the raw results of their runs, whose last sample is their end."""
    size = len(raw["final"])
    lengths = np.broadcast_to(np.asarray(lengths, float), (size,))
    samples = raw["samples"][:, :-1]
    modal = plant.modal_velocities(samples)
    speed = plant.contact_speeds(samples)
    square = (modal**2).sum(-1)
    shares = raw["durations"] / lengths[:, None]
    separated, stuck = (
        np.stack([shares[:, places].sum(1) for places in _regimes(plant, regime)], 1)
        for regime in (Regime.separated, Regime.stick)
    )
    kinds = plant.system.traced.kinds
    landings, separations = (
        np.stack(
            [raw["counts"][:, kinds.index(f"{name}_{e}")] for name in plant.contacts], 1
        )
        for e in ("contact", "separation")
    )
    events, regimes = raw["counts"].sum(1), raw["sample_regimes"][:, -1].copy()
    moved = (regimes != plant.regimes_at_rest).any(axis=1)
    return StructureWindows(
        final=raw["final"],
        regimes=regimes,
        velocities=np.sqrt((modal**2).mean(1)),
        largest_velocity=np.sqrt(square.max(axis=1)),
        speed=np.sqrt((speed**2).mean(1)),
        peak_speed=speed.max(axis=(1, 2)),
        separated=separated,
        stuck=stuck,
        separations=separations,
        landings=landings,
        forces=raw["extremes"][..., 1],
        switched=(events > 0) | moved,
        events=events,
        steps=raw["steps"],
        kinetic=np.stack(
            [0.5 * part.mean(1) for part in np.array_split(square, blocks, axis=1)],
            axis=1,
        ),
        block_ends=lengths[:, None] * np.arange(1, blocks + 1) / blocks,
        finished=raw["outcome"] == Outcome.converged,
        length=lengths,
        fades=np.zeros(size, bool),
        growth=np.full(size, np.nan),
        late_growth=np.full(size, np.nan),
    )


def _regimes(plant: Plant, regime: Regime) -> list[np.ndarray]:
    """Return, for each contact, the numbers of its regimes of a kind."""
    codes = regime_codes(plant.system, plant.contacts, plant.belt)
    owners = np.asarray(plant.system.traced.component_of)
    return [
        np.flatnonzero((codes == regime) & (owners == index))
        for index in range(len(plant.contacts))
    ]
