"""Lines over two parameters at which model A3 changes its regime.

Undamped both lines are zeros of closed forms. Damped, steady sliding loses its stability where
Routh–Hurwitz's number or the determinant is zero; flutter turns into divergence where the leading
pair of eigenvalues becomes real, or a real one overtakes it. Each line is the edge of one regime,
so that of two unstable regimes that meet both have it.
"""

from functools import partial
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np

from squealpipe.brake.curves.chords import Vector
from squealpipe.brake.curves.contact import Square
from squealpipe.brake.curves.zero_lines import FirstGrid, ZeroLines
from squealpipe.brake.models import a3, damped
from squealpipe.brake.models.contact_system import contact_system, with_drag
from squealpipe.brake.schema.curves import ChartLine
from squealpipe.codes import LinearRegime

REGIME_GRID = 241
"""Points per side on which the regimes are seen."""


class Regimes:
    """Regime of A3 over a square of two parameters."""

    # Lines of a chart that are the edge of a regime.
    edges: ClassVar = {
        ChartLine.flutter: LinearRegime.flutter,
        ChartLine.divergence: LinearRegime.divergence,
    }

    def __init__(self, square: Square) -> None:
        self.square = square
        self.damped = not np.all(damped.is_undamped(self._fields(centres(REGIME_GRID))))

    def lines(self) -> dict[ChartLine, ZeroLines]:
        """The edges of flutter and of divergence."""
        # an even number of points has none in the middle, where over both angles, from 0 to π,
        # the springs are in line and upright, and three regimes meet
        return {
            which: ZeroLines(
                partial(self._edge, which=which),
                self._outside,
                FirstGrid((2 * REGIME_GRID) if self.damped else REGIME_GRID, 1),
                jump=0.5,
                touching=self.damped,
            )
            for which in Regimes.edges
        }

    def beside(self, places: Vector) -> np.ndarray:
        """:class:`LinearRegime` next to places: what holds on a line alone does not count."""
        if not self.damped:
            return self.at(places)
        regimes = np.full(len(places), int(LinearRegime.stable))
        for which, regime in Regimes.edges.items():
            regimes[self._edge(places, which) < 0.0] = regime
        return regimes

    def _outside(self, places: Vector, slope: Vector) -> Vector:
        """The regime on the outer side of a line, which changes at its corners."""
        if not self.damped:
            return 0.0 * places[:, 0]
        # way from a line to the regimes on both of its sides
        step = 1e-7 * slope / np.linalg.norm(slope, axis=1)[:, None]
        return self.beside(places + step).astype(float)

    def at(self, places: Vector) -> np.ndarray:
        """:class:`LinearRegime` at places of the square, as :func:`stability_map` has it."""
        p = self._fields(places)
        regimes = a3.regime(contact_system(p, p.alpha1, p.alpha2).invariants)
        regimes = np.broadcast_to(regimes, len(places)).copy()
        if self.damped:
            of = np.broadcast_to(np.logical_not(damped.is_undamped(p)), len(places))
            regimes[of] = damped.regime(_damped_system(p))[of]
        return regimes

    def _fields(self, places: Vector) -> SimpleNamespace:
        return with_drag(self.square.fields(places))

    def _edge(self, places: Vector, which: ChartLine) -> Vector:
        """A function that is negative in one regime alone, of order one, zero at its edge."""
        # All points of a grid would lie where the springs are in line, so that the static force
        # vanishes and friction's slope with it: places are shifted.
        p = self._fields(
            places + np.array([2e-9, 1e-9]) * (1.0 - 2.0 * places)
            if self.damped
            else places
        )
        invariants = contact_system(p, p.alpha1, p.alpha2).invariants
        quantity = (
            invariants.discriminant
            if which == ChartLine.flutter
            else invariants.determinant
        )
        values = np.broadcast_to(
            quantity / invariants.half_trace**2, len(places)
        ).copy()
        if self.damped:
            of = np.broadcast_to(np.logical_not(damped.is_undamped(p)), len(places))
            values[of] = _damped_edge(_damped_system(p), which)[of]
        return values


def centres(count: int) -> Vector:
    """Centres of ``count`` × ``count`` equal cells of the unit square."""
    middle = (np.arange(count) + 0.5) / count
    grid = np.meshgrid(middle, middle, indexing="ij")
    return np.stack(grid, axis=-1).reshape(-1, 2)


def _damped_system(p: Any) -> damped.DampedSystem:
    return damped.damped_system(p, p.alpha1, p.alpha2)


def _damped_edge(s: damped.DampedSystem, which: ChartLine) -> Vector:
    """Distance from the edge of a regime in terms of what is zero there, negative within it."""
    _, p = damped.polynomial(s)
    damping = p[0] ** 2 + p[2] ** 2
    with np.errstate(all="ignore"):
        # of order one for all dashpots, light or not, and next to the poles of N0
        oscillation = damped.hurwitz(p) / (damping * (1.0 + np.sqrt(damping)))
        unstable = ~((oscillation > 0.0) & (np.min(p, axis=0) > 0.0))
    change, oscillates = np.ones(unstable.shape), np.zeros(unstable.shape, bool)
    change[unstable], oscillates[unstable] = _distinction(
        damped.eigenvalues(damped.DampedSystem._make(e[unstable] for e in s))
    )
    flutters = which == ChartLine.flutter
    inside = unstable & (oscillates == flutters)
    onset = oscillation if flutters else p[3]
    # a number of the wrong sign is zero elsewhere than at this regime's onset
    within = np.minimum(change, np.where(onset < 0.0, -onset, 1.0))
    outside = np.where(unstable, change, onset)
    edge = np.where(inside, -within, outside)
    edge = np.nan_to_num(edge, nan=1.0)
    return np.asarray(edge / np.sqrt(1.0 + edge * edge))


def _distinction(roots: np.ndarray) -> tuple[Vector, np.ndarray]:
    """Return how far the leading eigenvalue is from being real, or one of a pair, and whether it is
    one.

    A pair that becomes real is the zero of its discriminant; one that another root overtakes, that
    of the difference of real parts.
    """
    size = np.abs(roots).max(axis=-1, keepdims=True)
    roots = roots / np.where(size > 0.0, size, 1.0)
    order = np.argsort(-roots.real, axis=-1, kind="stable")
    first, second, third, _ = np.moveaxis(
        np.take_along_axis(roots, order, axis=-1), -1, 0
    )
    gap = 0.25 * np.abs((first - second) ** 2)
    leads_in_pair = first.imag != 0.0
    overtaken = first.real - np.where(leads_in_pair, third, second).real
    other = np.where(leads_in_pair, third, second).imag != 0.0
    change = np.where(leads_in_pair, gap, np.where(other, overtaken, gap))
    by_real = leads_in_pair & ~other
    return np.where(by_real, np.minimum(change, overtaken), change), leads_in_pair
