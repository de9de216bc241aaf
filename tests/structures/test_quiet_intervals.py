"""Linear boundaries of random structures against dense eigenvalues put together here."""

import numpy as np
import pytest
import scipy.linalg as la

from squealpipe import Contact, Structure
from squealpipe.structures.quiet_intervals import linear_intervals
from tests.samples import some


class Case:
    """A random structure of 2 to 12 degrees of freedom with 1 to 4 contacts, one or all closed.

    Small masses at weak springs and dashpots let modes cross, merge and part.
    """

    def __init__(self, seed, damped=True):
        draw = np.random.default_rng([65, seed])
        size = int(draw.integers(2, 13))
        count = int(draw.integers(1, min(4, size // 2) + 1))
        a, b = draw.standard_normal((2, size, size)) / np.sqrt(size)
        self.mass = a @ a.T + 0.5 * np.eye(size)
        self.stiffness = 10 * b @ b.T + np.eye(size)
        self.ratio = 0.01 * draw.uniform(0.2, 2.0) if damped else 0.0
        self.normal, self.tangential = draw.standard_normal((2, size, count))
        self.springs = draw.uniform(0.5, 8.0, count)
        self.preload = draw.uniform(20.0, 40.0, count)
        self.falls = bool(draw.integers(0, 2)) and damped
        self.mu, self.belt, self.size = (
            draw.uniform(0.2, 0.6),
            draw.uniform(0.5, 3.0),
            size,
        )
        self.factors = {"stiffness": 1.0, "preload": 1.0, "mass": 0.0}

    def structure(self):
        contacts = [
            Contact(
                f"c{i}",
                n,
                t,
                k * self.factors["stiffness"],
                p * self.factors["preload"],
            )
            for i, (n, t, k, p) in enumerate(
                zip(
                    self.normal.T,
                    self.tangential.T,
                    self.springs,
                    self.preload,
                    strict=True,
                )
            )
        ]
        law = (
            {"friction_law": "exponential", "mu_static": 1.3 * self.mu}
            if self.falls
            else {}
        )
        return Structure(
            self.whole_mass, self.stiffness, modal_damping=self.ratio, contacts=contacts,
            mu=self.mu, belt_speed=self.belt, friction_speed=1.5, **law,
        )  # fmt: skip

    @property
    def whole_mass(self):
        mass = self.mass.copy()
        mass[0, 0] += self.factors["mass"]
        return mass

    def at(self, name, value):
        other = object.__new__(Case)
        other.__dict__.update(self.__dict__)
        if name in self.factors:
            other.factors = self.factors | {name: value}
        elif name == "mu" and self.falls:
            raise AssertionError
        else:
            setattr(other, name, value)
        return other

    def growth(self):
        """Largest growth rate; inf without a state in which all contacts that press are closed."""
        springs = self.springs * self.factors["stiffness"]
        preload = self.preload * self.factors["preload"]
        mu, slope = self.mu, 0.0
        if self.falls:
            fall = 0.3 * self.mu * np.exp(-abs(self.belt) / 1.5)
            mu, slope = mu + fall, -fall / 1.5
        acting = self.normal + np.sign(self.belt) * mu * self.tangential
        closed = np.ones(len(springs), bool)
        for _ in range(30):
            matrix = self.stiffness + (acting * springs * closed) @ self.normal.T
            load = (acting * closed - self.normal) @ preload
            force = preload - springs * (self.normal.T @ la.solve(matrix, load))
            wrong = np.flatnonzero(closed != (force > 0))
            if not wrong.size:
                break
            closed[wrong[0]] = ~closed[wrong[0]]
        else:
            return np.inf
        mass = self.whole_mass
        at_rest = self.stiffness + (self.normal * springs) @ self.normal.T
        # C = 2 ζ M (M⁻¹K)^½
        root = la.sqrtm(la.solve(mass, at_rest)).real
        damping = 2 * self.ratio * mass @ root
        falling = self.tangential * (force * slope * closed)
        damping = damping + falling @ self.tangential.T
        lower = [-la.solve(mass, matrix), -la.solve(mass, damping)]
        first = np.block([[np.zeros_like(mass), np.eye(len(mass))], lower])
        return la.eigvals(first).real.max()


RANGES = {
    "mu": (0.0, 2.0),
    "ratio": (0.0, 0.2),
    "stiffness": (0.1, 10.0),
    "preload": (0.001, 2.0),
    "belt": (0.1, 6.0),
    "mass": (0.0, 20.0),
}


STEPS = np.linspace(-1.0, 1.0, 17)


def check(seed, name, damped=True, points=60):
    """Compare with dense eigenvalues at points, and at 1 % either side of each boundary."""
    case = Case(seed, damped)
    if name == "mu":
        case.falls = False
    low, high = RANGES[name]
    now = {"mu": case.mu, "ratio": case.ratio, "belt": case.belt}.get(name, 1.0)
    intervals = linear_intervals(
        lambda v: case.at(name, v).structure(), np.linspace(low, high, 17), now
    )
    distances = [each.distance(now) for each in intervals]
    assert distances == sorted(distances)
    edges = [edge for each in intervals for edge in each.edges()]
    if not damped:
        edges = [edge for edge in edges if edge > 1e-6]
    beside = [edge * side for edge in edges for side in (0.99, 1.01)]
    limit = 1e-7 if damped else 1e-5
    for value in [*np.linspace(low + 1e-9, high, points), *beside]:
        if not low <= value <= high:
            continue
        is_quiet = any(each.contains(value) for each in intervals)
        growth = case.at(name, value).growth()
        # on a boundary itself both are right
        if min((abs(edge - value) for edge in edges), default=1.0) < 1e-9 * high:
            continue
        assert is_quiet == (growth <= limit), (seed, name, value, growth, intervals)
    for edge in edges:
        inner, outer = edge * (1 - 1e-4), edge * (1 + 1e-4)
        signs = [case.at(name, value).growth() > limit for value in (inner, outer)]
        assert signs[0] != signs[1], (seed, name, edge)
    return len(edges)


SEEDS = {
    "mu": (6,),
    "ratio": (6,),
    "stiffness": (7,),
    "preload": (9,),
    "belt": (2,),
    "mass": (6,),
}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(n, marks=[pytest.mark.release] * (n not in {"mu", "preload"}))
        for n in SEEDS
    ],
)
def test_boundaries_are_where_growth_passes_zero(name):
    assert sum(check(seed, name, points=8) for seed in SEEDS[name]) >= 1


def test_undamped_modes_turn_unstable_where_they_merge():
    assert check(7, "mu", damped=False, points=8) >= 1


@pytest.mark.release
@pytest.mark.parametrize("name", RANGES)
def test_all_intervals_of_many_structures(name):
    for seed in some(range(10, 20)):
        check(seed, name)
        if name in ("mu", "stiffness", "mass"):
            check(seed, name, damped=False)


@pytest.mark.release
def test_undamped_modes_that_merge_part_and_merge_again():
    """Circulatory forces couple two modes where their frequencies cross: a bubble of growth."""

    def structure_at(detuning):
        contact = Contact("c", {1: 1.0}, {0: 1.0}, stiffness=1.0, preload=10.0)
        return Structure(
            np.eye(2), [[9.0 + detuning, 0.0], [0.0, 8.0]], contacts=[contact], mu=0.0,
        )  # fmt: skip

    assert len(linear_intervals(structure_at, STEPS, 0.0)) == 1

    def coupled(detuning):
        structure = structure_at(detuning)
        stiffness = np.add(structure.stiffness.toarray(), [[0.0, 0.01], [-0.01, 0.0]])
        return Structure(structure.mass, stiffness, contacts=structure.contacts, mu=0.0)

    intervals = linear_intervals(coupled, STEPS, 0.5)
    # (9 + d − 9)² / 4 < 0.01²
    assert [(each.low, each.high) for each in intervals] == [
        (pytest.approx(0.02, abs=1e-9), 1.0),
        (-1.0, pytest.approx(-0.02, abs=1e-9)),
    ]


def test_without_steady_sliding_nothing_is_quiet():
    """Contacts do not slide on a belt at rest."""
    structure = Case(4).structure()
    (only,) = linear_intervals(
        lambda speed: structure.with_(belt_speed=max(speed, 0.0)), 2.0 * STEPS, 1.0
    )
    assert only.low == pytest.approx(0.0, abs=1e-10)
    assert (only.low_open, only.high, only.high_open) == (False, 2.0, True)


def test_a_range_turned_round_is_refused():
    case = Case(0)
    with pytest.raises(ValueError, match="at least two, ascending"):
        linear_intervals(lambda _: case.structure(), [1.0, 0.5], 0.7)
