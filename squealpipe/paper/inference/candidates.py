"""Parameter sets that the paper's statements are measured at, and their motions."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import SimpleNamespace
from typing import Any, Self

import numpy as np

from squealpipe.brake.a1.ensemble import Ensemble, run_ensemble
from squealpipe.brake.models.contact_system import ContactSystem, contact_system
from squealpipe.paper.inference.unstable_cells import (
    INSIDE,
    Unstable,
    joined,
    unstable_along_edges,
    unstable_cells,
)
from squealpipe.paper.schema.growth import GrowthRule, growth_fails, growth_margin
from squealpipe.parameters import SCENES, TABLE, Parameters, Scene, direction_of
from squealpipe.reading import reading_of
from squealpipe.schema import Outcome


@dataclass(frozen=True)
class StatementMargin:
    """Margin by which one statement holds, and how the runs behind it ended, both (size,)."""

    margin: np.ndarray
    outcome: np.ndarray


@dataclass(frozen=True)
class Candidates:
    """Parameter sets, one an entry of each array, and the motions computed for them.

    Attributes:
        fields: names of ``Parameters`` → 1-D arrays of one length.
        initial_state: (x, y, ẋ, ẏ) of the scenes' runs, (4,) or one for each set, m and m/s.
        exact: whether margins are wanted. Else they may be bounds of the right sign, and motions
            end as soon as the sign is known.
        sampled: whether the starts are a random sample. What is chance then shows in the share of
            it that meets a statement, and none is judged from several starts.
        paired: whether the second half of the sets are the first half from starts beside theirs.
        known_maps: A1's model and the values of a set → where on an angle map contact is lost,
            filled by runs for all readings; of sets with equal springs and the paper's friction
            only. None: each reading runs its own maps.
    """

    fields: Mapping[str, np.ndarray]
    tol: float
    workers: int | None = None
    initial_state: Any = (0.0, 0.0, 0.0, 0.0)
    model: str = "A1"
    exact: bool = True
    sampled: bool = False
    paired: bool = False
    known_maps: dict[tuple[Any, ...], np.ndarray] | None = None

    @classmethod
    def of(cls, *params: Parameters, tol: float, workers: int | None = 1) -> Self:
        """Candidates one by one, which have the same parameters beyond the paper's model."""
        fields = {
            name: np.array([each.as_dict()[name] for each in params])
            for name in params[0].as_dict()
        }
        return cls(fields, tol, workers)

    def read(self, name: str) -> Self:
        """Return the same sets in one reading of the sign of friction."""
        reading = reading_of(name)
        fields = {
            **self.fields,
            "belt_speed": reading.direction * self.fields["belt_speed"],
        }
        return replace(self, fields=fields, model=reading.a1_model)

    def subset(self, rows: np.ndarray) -> Self:
        """Return some of the sets."""
        state = np.asarray(self.initial_state, float)
        return replace(
            self,
            fields={name: field[rows] for name, field in self.fields.items()},
            initial_state=state[rows] if state.ndim == 2 else state,
        )

    def moved(self, x: float, y: float) -> Self:
        """Return the same sets with their starts displaced by (x, y) l_pre."""
        preload = np.asarray(self.fields["preload"])[:, None]
        apart = preload * np.array([x, y, 0.0, 0.0])
        return replace(self, initial_state=np.asarray(self.initial_state) + apart)

    def joined(self, *others: Self) -> Self:
        """Return these sets followed by others of the same model."""
        every = (self, *others)
        fields = {
            name: np.concatenate([each.fields[name] for each in every])
            for name in self.fields
        }
        states = [np.broadcast_to(each.initial_state, (each.size, 4)) for each in every]
        return replace(self, fields=fields, initial_state=np.concatenate(states))

    @property
    def size(self) -> int:
        """Number of sets."""
        return len(self.fields["mu"])

    @cached_property
    def time_unit(self) -> np.ndarray:
        """√(m/k1), s."""
        return np.asarray(np.sqrt(self.fields["mass"] / self.fields["k1"]))

    def ensemble(
        self, alpha1: Any, alpha2: Any, *, variant: str = "", **options: Any
    ) -> Ensemble:
        """Motions of all sets."""
        return run_ensemble(
            self.fields,
            alpha1,
            alpha2,
            model=self.model + variant,
            tol=self.tol,
            workers=self.workers,
            turns=False,
            **options,
        )

    def run(
        self, scene: Scene, tracked: str = "contact_force", **options: Any
    ) -> Ensemble:
        """The motion at a scene over its horizon, with its second half as the late one."""
        t_end = scene.t_end * self.time_unit
        return self.ensemble(
            scene.alpha1,
            scene.alpha2,
            t_end=t_end,
            t_late=0.5 * t_end,
            tracked=(tracked,),
            initial_state=self.initial_state,
            **options,
        )

    def windows(self, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
        """Largest |x| in each window of a long run at a scene, and how the run ended.

        Window after window starts where the one before ended. A run that ended early is not taken
        up again, and its windows from there on are NaN; so, unless margins are wanted, one that
        does not grow by the rule of :mod:`squealpipe.paper.schema.growth` whatever comes next. Nor
        is the last window run to its end then if half of it shows growth and only that is asked.
        """
        sizes = np.full((self.size, GrowthRule.n_windows), np.nan)
        outcome = np.full(self.size, int(Outcome.converged), np.int8)
        state = np.broadcast_to(np.array(self.initial_state, float), (self.size, 4))
        state = state.copy()
        half = self.size // 2
        alike = np.zeros(half, bool)

        def run(rows: np.ndarray, window: int, share: float = 1.0) -> Ensemble:
            some = self.subset(rows)
            runs = some.ensemble(
                scene.alpha1,
                scene.alpha2,
                t_end=share * GrowthRule.window * some.time_unit,
                tracked=("x",),
                initial_state=state[rows],
            )
            sizes[rows, window] = np.maximum(runs.early_max_x, runs.late_max_x)
            return runs

        for window in range(GrowthRule.n_windows):
            going = outcome == Outcome.converged
            if self.paired and window >= GrowthRule.n_compared:
                first, second = sizes[:half, :window], sizes[half:, :window]
                close = np.abs(second - first) <= GrowthRule.alike * first
                alike |= close.all(axis=1)
                going[half:] &= ~alike
            left = np.flatnonzero(going if self.exact else going & ~growth_fails(sizes))
            if window == GrowthRule.n_windows - 1 and not self.exact:
                # the margins of two starts that differ are compared, not their signs alone
                rows = left[np.tile(alike, 2)[left]] if self.paired else left
                runs = run(rows, window, 0.5)
                grown = growth_margin(sizes[rows]) > 0.0
                left = np.setdiff1d(left, rows[grown & (runs.outcome == outcome[rows])])
            if not left.size:
                break
            runs = run(left, window)
            outcome[left], state[left] = runs.outcome, runs.final_state
        rows = np.flatnonzero(alike)
        sizes[half + rows], outcome[half + rows] = sizes[rows], outcome[rows]
        return sizes, outcome

    @cached_property
    def contact(self) -> dict[str, StatementMargin]:
        """Lowest N/(k3 l_pre) at the scenes of Fig. 2, negative where contact is lost."""
        names = "F2a", "F2b", "F2c", "F2d"
        lowest = self.pulling_force if self.exact else self.force_until_lost
        return {name: lowest(SCENES[name]) for name in names}

    def pulling_force(self, scene: Scene) -> StatementMargin:
        """From the variant whose contact spring also pulls.

        It moves as A1 does until N = 0, and then shows by how much contact is lost.
        """
        run = self.run(scene, variant="-no-separation")
        lowest = run.lowest_contact_force
        # where contact is lost, it does not matter how the run went on
        outcome = np.where(lowest < 0, Outcome.converged, run.outcome)
        return StatementMargin(lowest, outcome)

    def force_until_lost(self, scene: Scene) -> StatementMargin:
        """From A1 itself, −1 where contact is lost, but by the variant where it is hardly lost."""
        # of a sign, errors of 1e-7 are chance in one of a million sets
        some = replace(self, tol=max(self.tol, 1e-6))
        run = some.run(scene, stop_at_first_separation=True)
        lost = run.outcome == Outcome.separated
        lowest = np.where(lost, -1.0, run.lowest_contact_force)
        outcome = np.where(lost, Outcome.converged, run.outcome)
        # what leaves faster than this, over l_pre √(k1/m), would pull by more than 1e-5 k3 l_pre
        slow = 1e-2 * np.asarray(self.fields["preload"]) / self.time_unit
        unclear = (outcome != Outcome.converged) | (run.final_state[:, 3] < slow) & lost
        rows = np.flatnonzero(unclear)
        if rows.size:
            pulled = some.subset(rows).pulling_force(scene)
            lowest[rows], outcome[rows] = pulled.margin, pulled.outcome
        return StatementMargin(lowest, outcome)

    @cached_property
    def level(self) -> Ensemble:
        """The motion at (π, π), both springs along the belt."""
        return self.run(SCENES["F5a"])

    def linear(self, scene: Scene) -> ContactSystem:
        """The linear system at a scene, with the friction of the belt's direction."""
        p = SimpleNamespace(**self.fields, drag=self.drag)
        return contact_system(p, scene.alpha1, scene.alpha2)

    @cached_property
    def sets(self) -> list[Parameters]:
        """The parameter sets one by one."""
        rows = zip(
            *(np.asarray(values).tolist() for values in self.fields.values()),
            strict=True,
        )
        return [Parameters(**dict(zip(self.fields, row, strict=True))) for row in rows]

    @cached_property
    def extended(self) -> list[Parameters]:
        """The sets if they may go beyond the paper's model; else none."""
        return self.sets if any(TABLE[name].extension for name in self.fields) else []

    @cached_property
    def drag(self) -> np.ndarray:
        """Friction over normal force along +x in the linear models."""
        if self.extended:
            return np.array([params.drag for params in self.extended])
        return np.asarray(direction_of(self.fields["belt_speed"]) * self.fields["mu"])

    def unstable_cells(self, inside: float = INSIDE, every: int = 1) -> Unstable:
        """Return angles at which A3 is unstable, set after set.

        Args:
            inside: their distance, in radii, from the centre of the disc of flutter.
            every: look at one in so many points along each edge; of sets beyond the paper's model,
                which are searched by maps, at all.
        """
        if self.extended:
            return joined([unstable_cells(p, inside=inside) for p in self.extended])
        fields = {**self.fields, "drag": self.drag}
        return unstable_along_edges(fields, inside=inside, every=every)


def sets_of(
    groups: dict[str, np.ndarray], *, tol: float, workers: int | None
) -> Candidates:
    """Candidates with equal springs, in units of m = k = l_pre = 1."""
    ones = np.ones(len(groups["mu"]))
    fields = {
        "mass": ones,
        "k1": ones,
        "k2": ones,
        "k3": groups["kappa"],
        "mu": groups["mu"],
        "preload": ones,
        "length1": groups["length_ratio"],
        "length2": groups["length_ratio"],
        "belt_speed": groups["speed_ratio"],
    }
    return Candidates(fields, tol, workers, known_maps={})
