"""Designs of a structure as they are run: their plants, starts, and what these settle to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Any, Self

import numpy as np

from squealpipe.laws.friction_laws import COULOMB
from squealpipe.structures.coordinates import Coordinates, StaticSpace
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.modes import free_degrees
from squealpipe.structures.sliding import NoSlidingError
from squealpipe.structures.squeal.plant import PUSH_OF_A_MODE, Plant, damped_beyond
from squealpipe.structures.squeal.settling import so_far
from squealpipe.structures.squeal.settling import start_at as start_of_plant
from squealpipe.structures.squeal.windows import Running, followed_windows, run_windows
from squealpipe.structures.subspace import projected, subspace, with_answers
from squealpipe.systems.progress import partial_answer
from squealpipe.vibration.schema import Mechanism
from squealpipe.vibration.settled_runs import Horizon, Quietness, SettledRun, Start
from squealpipe.vibration.settled_runs import settle as settle_runs
from squealpipe.vibration.settling import Settling, settling_of_verdicts
from squealpipe.vibration.windows import joined

MOST_PERIODS = 20_000.0
"""Periods after which a motion that has not settled is undetermined."""


@dataclass(frozen=True, eq=False)
class Design:
    """A structure, and what is run of it.

    A large structure is changed in coordinates that hold its lowest modes at rest, twice as many as
    are run, and what forces at its contacts do statically: there the modes of what is changed are
    nearly those of the whole, and cost a thousandth.

    Attributes:
        whole: the structure, of a large one in these coordinates.
        n_modes: modes in which it is run; None: as it is.
        band: end of the band in which modes count, rad/s.
        damping_beyond: damping ratio that coordinates beyond the band have been given.
        directions: static responses of each contact among these: 0 none, 1 the normal one, 2 both.
        origin: large structure of all degrees of freedom; None where that is ``whole``.
        coordinates: (n of the origin, n of the whole), amplitudes → displacements.
        reduction: the structure as it was reduced to be run; None where it is not reduced.
        running: the structure that is run, where it is known.
        obstacle: reason why runs would tell nothing about the structure; None if there is none.
    """

    whole: ContactStructure
    n_modes: int | None = None
    origin: ContactStructure | None = None
    coordinates: np.ndarray | None = None
    reduction: ContactStructure | None = None
    running: ContactStructure | None = None
    obstacle: str | None = None
    directions: int = 0
    band: float = np.inf
    damping_beyond: float = 0.0

    @classmethod
    def of(cls, structure: ContactStructure) -> Self:
        """Return the design of a structure, reduced where it has to be.

        Raises:
            NoSlidingError: there is no steady sliding.
            ValueError: it has no contacts, or is too large.
        """
        plant = Plant(structure)
        running = plant.structure
        if running.reduced_from is None:
            return cls(running, obstacle=plant.obstacle)
        origin = running.reduced_from.whole
        number = min(2 * running.size, free_degrees(origin))
        coordinates = subspace(origin, [], number)
        return cls(
            _projected(origin, coordinates),
            running.size,
            origin,
            coordinates,
            running,
            obstacle=plant.obstacle,
            directions=running.reduced_from.directions,
            band=plant.band,
            damping_beyond=plant.damping_beyond,
        )

    @property
    def given(self) -> ContactStructure:
        """Structure of all degrees of freedom."""
        return self.whole if self.origin is None else self.origin

    @cached_property
    def plant(self) -> Plant | None:
        """The structure about its steady sliding; None where there is none."""
        try:
            return Plant(self.structure, is_ready=True, band=self.band)
        except NoSlidingError:
            return None

    @cached_property
    def structure(self) -> ContactStructure:
        """The structure that is run."""
        if self.running is not None:
            return self.running
        if self.n_modes is None:
            return self.whole
        space = StaticSpace(self.whole, self.n_modes)
        kept = Coordinates(space, self.n_modes, self.directions)
        reduced = damped_beyond(kept.reduced, self.band, self.damping_beyond)
        reduced.modes = kept.modes
        return reduced

    def changed(self, whole: ContactStructure) -> Design:
        """Return the design of another whole structure, in as many modes of its own."""
        return replace(self, whole=whole, running=None)

    def modified(
        self, change: Callable[[ContactStructure], ContactStructure]
    ) -> Design:
        """Return the design of the structure of all degrees of freedom with a change of it."""
        if self.origin is None or self.coordinates is None:
            return self.changed(change(self.whole))
        return self.changed(_projected(change(self.origin), self.coordinates))

    def ready_for(
        self, change: Callable[[ContactStructure], ContactStructure]
    ) -> Design:
        """Return the design in coordinates that also hold the effect of a change on its modes."""
        if self.origin is None or self.coordinates is None:
            return self
        other = change(self.origin)
        forces = np.hstack(
            [
                (getattr(other, name) - getattr(self.origin, name)) @ self.coordinates
                for name in ("mass", "given_stiffness")
            ]
        )
        if not forces.any():
            return self
        coordinates = with_answers(self.origin, self.coordinates, forces)
        return replace(
            self,
            whole=_projected(self.origin, coordinates),
            coordinates=coordinates,
            running=None,
        )

    def slid(self, **changes: Any) -> Design:
        """Return the design with another friction or belt speed, in the same modes at rest."""
        running = self.structure.with_(**changes)
        running.modes = self.structure.modes
        return replace(self, whole=self.whole.with_(**changes), running=running)

    @property
    def margin(self) -> float:
        """Growth of small motions beyond their error, 1/s; infinite without sliding."""
        if self.plant is None:
            return np.inf
        spectrum = self.plant.spectrum
        return float((spectrum.values.real - spectrum.growth_errors).max())

    def to_whole(self, state: np.ndarray) -> np.ndarray:
        """Return displacements and velocities of the whole, (2 n,), of a state that is run."""
        modes, n = self.structure.modes, self.structure.size
        if modes is None:
            return state[: 2 * n]
        q, v = state[:n], state[n : 2 * n]
        return np.concatenate([modes @ q, modes @ v])

    def from_whole(self, state: np.ndarray) -> np.ndarray:
        """Return the state that is run next to one of the whole."""
        modes = self.structure.modes
        if modes is None:
            return state
        both = np.stack(np.split(state, 2), axis=1)
        # coordinates that a change has added are the last ones
        both = np.pad(both, ((0, max(len(modes) - len(both), 0)), (0, 0)))
        both = np.linalg.lstsq(modes, both[: len(modes)])[0]
        return np.asarray(both.T.ravel())

    @property
    def mechanism(self) -> Mechanism:
        """Reason why steady sliding is unstable."""
        if self.plant is None:
            return Mechanism.no_sliding_state
        if not self.plant.unstable.size:
            return Mechanism.none
        drag = np.abs(self.plant.spectrum.state.drag)
        contacts = [
            replace(contact, mu=float(mu), friction_law=COULOMB, mu_static=None)
            for contact, mu in zip(self.structure.contacts, drag, strict=True)
        ]
        level = Plant(self.structure.with_(contacts=contacts), is_ready=True)
        if not level.unstable.size:
            return Mechanism.falling_friction
        leading = self.plant.spectrum.values[self.plant.unstable[0]]
        # a pair that is about to split has a frequency of the size of its error
        oscillates = abs(leading.imag) > 1e-4 * abs(leading)
        return Mechanism.flutter if oscillates else Mechanism.divergence


def pushed(design: Design) -> Start | None:
    """Return steady sliding, pushed along the mode that grows fastest; None without sliding.

    Of several that grow alike, as without damping, the slowest.
    """
    plant = design.plant
    if plant is None:
        return None
    return _start(design, plant, plant.pushed(_fastest(plant), PUSH_OF_A_MODE))


def _fastest(plant: Plant) -> int:
    """Return the place of the mode that grows fastest; of several alike the slowest one's."""
    values = plant.spectrum.values
    slack = 1e-9 * np.abs(values).max() + plant.spectrum.growth_errors.max()
    leading = np.flatnonzero(values.real >= values.real.max() - slack)
    return int(leading[np.argmin(np.abs(values[leading]))])


def start_at(design: Design, state: np.ndarray) -> Start | None:
    """Return another start, at a state that is run; None without steady sliding."""
    plant = design.plant
    return None if plant is None else _start(design, plant, state)


def _start(design: Design, plant: Plant, state: np.ndarray) -> Start:
    start = replace(start_of_plant(plant, state), subject=design)
    if not plant.spectrum.pencil.is_undamped:
        return start
    own = start.distance(state) / Quietness.stays_small * 2.0
    return replace(start, speed=max(start.speed, own))


def _projected(
    structure: ContactStructure, coordinates: np.ndarray
) -> ContactStructure:
    """Return a structure in some coordinates, with its damping of modes."""
    return projected(structure, None, coordinates).with_(
        mass=coordinates.T @ (structure.mass @ coordinates),
        modal_damping=structure.modal_damping[: coordinates.shape[1]]
        if structure.modal_damping.ndim
        else structure.modal_damping,
    )


@dataclass
class Structures:
    """Structures as the search for other motions sees them, and how they are run.

    Attributes:
        tol: tolerance of the runs.
        samples: random starts of each design.
        seed: of them.
        workers: processes.
    """

    tol: float
    samples: int
    seed: int
    workers: int | None = 1

    def is_quiet_linearly(self, subject: Design) -> bool:
        """Tell whether steady sliding exists, and small motions about it do not grow."""
        return subject.margin <= 0.0

    def push(self, subject: Design) -> Start | None:
        """Return steady sliding, pushed; None where no contact would switch as that dies out."""
        plant = subject.plant
        assert plant is not None  # noqa: S101 (it is quiet linearly)
        if plant.push_switches_nothing(_fastest(plant)):
            return None
        return pushed(subject)

    def fading(self, subject: Design) -> float:
        """Return ln of the decay of small motions within the longest run; NaN where they grow."""
        if subject.plant is None or subject.margin > 0.0:
            return np.nan
        return subject.plant.rate * MOST_PERIODS / subject.plant.slowest

    def starts(
        self, subject: Design, number: int, motions: Sequence[np.ndarray]
    ) -> list[Start]:
        """Return one kind of starts: motions, at rest under the load at once, or random ones.

        Args:
            motions: states of the whole structure.
        """
        plant = subject.plant
        if plant is None:
            return []
        states = [plant.with_stretches(np.zeros(2 * plant.size))]
        if number == 0:
            states = [
                plant.with_stretches(subject.from_whole(state)) for state in motions
            ]
        elif number == 2:
            states = list(plant.random_states(self.samples, self.seed))
        return [_start(subject, plant, state) for state in states]

    def settle(
        self, starts: Sequence[Start], rules: Settling = settling_of_verdicts
    ) -> list[SettledRun]:
        """Run starts until they have settled by the rules; their last states are of the whole."""
        if not starts:
            return []
        return [
            replace(run, last=_of_whole(start.subject, run.last))
            for start, run in zip(starts, self.settled(starts, rules), strict=True)
        ]

    def settled(
        self,
        starts: Sequence[Start],
        rules: Settling = settling_of_verdicts,
        *,
        is_told: bool = False,
    ) -> list[SettledRun]:
        """Run starts until they have settled by the rules.

        Args:
            is_told: whether a line after each window tells what has settled.
        """
        advance = _Advance(starts, Running(self.tol, self.seed, self.workers), rules)
        horizon = Horizon.of(starts, MOST_PERIODS)

        def told(settled: dict[int, SettledRun], elapsed: np.ndarray) -> None:
            plant, done = starts[0].subject.plant, [*settled.values()]
            partial_answer(
                partial(so_far, plant, done, len(starts), float(elapsed.max()))
            )

        return settle_runs(
            starts, advance, horizon, rules, told=told if is_told else None
        )


def _of_whole(design: Design, last: Any) -> Any:
    return replace(last, final=design.to_whole(last.final))


@dataclass
class _Advance:
    """Run starts of several designs on, those of one design together.

    Attributes:
        perturbations: of each start, where one is followed, (states,).
    """

    starts: Sequence[Start]
    how: Running
    rules: Settling
    perturbations: dict[int, np.ndarray] = field(default_factory=dict)

    def __call__(
        self,
        rows: list[int],
        states: np.ndarray,
        regimes: np.ndarray | None,
        seconds: np.ndarray,
        turn: int,
    ) -> Any:
        designs: dict[int, list[int]] = {}
        for place, row in enumerate(rows):
            designs.setdefault(id(self.starts[row].subject), []).append(place)
        parts = []
        for places in designs.values():
            plant = self.starts[rows[places[0]]].subject.plant
            begun = None if regimes is None else regimes[places]
            given = plant, states[places], seconds[places], self.how.turn(turn), begun
            if not self.rules.follows_perturbation:
                parts.append((places, run_windows(*given)))
                continue
            beside = [self.perturbations.get(rows[place]) for place in places]
            windows, left = followed_windows(*given, beside, self.rules)
            for place, perturbation in zip(places, left, strict=True):
                self.perturbations[rows[place]] = perturbation
            parts.append((places, windows))
        return joined(parts)
