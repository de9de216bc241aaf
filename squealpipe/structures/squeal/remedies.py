"""Find how much more damping stops the modes that grow.

Idea: from the largest ratio down, the first of a row of ratios at which a mode grows brackets the
boundary. The mode that grows most there is followed to it, by Newton's method on its eigenvalue
s and the ratio ζ together, with d s/d ζ = −wᴴ s (∂C/∂ζ) v / wᴴ Q'(s) v.

Invariant: just above the ratio that is returned all eigenvalues have been computed, and none grows.
Cost: one problem of all eigenvalues for each ratio tried, and two systems a step of Newton's.
"""

import math
from typing import Self

import numpy as np
import scipy.linalg as la
from scipy.optimize import brentq

from squealpipe.schema import Outcome
from squealpipe.structures.agreement import Truth
from squealpipe.structures.coordinates import Coordinates, StaticSpace
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.reduction import quick_values
from squealpipe.structures.schema.squealing import SquealLimits
from squealpipe.structures.squeal.plant import Plant


def added_damping(plant: Plant) -> tuple[float, Outcome]:
    """Return the smallest ratio of damping, added to every mode at rest, from which no mode grows.

    Damping may destabilize before it stabilizes: from this ratio to the largest tried nothing
    grows. It is found in the modes that are run, and located from there in the whole structure: by
    Newton's method if its matrices are dense and no band limits its modes, else by secants.

    Returns:
        The ratio and its outcome: 0 where nothing grows without it, NaN where the largest does not
        suffice (``not_reached``) or where it is not known (``unresolved``).
    """
    ratio, reduced = 0.0, _Damped(plant.structure)
    if plant.unstable.size:
        ratio = reduced.boundary()
    origin, truth = plant.structure.reduced_from, plant.truth
    if origin is not None and truth is not None:
        grows_now = bool(truth.unstable.size)
        if origin.whole.size > DENSE or origin.frequency_max is not None:
            located = _located_in_band(plant, ratio, grows_now)
            if located is None:
                return np.nan, Outcome.unresolved
            ratio = located
        elif not grows_now:
            ratio = 0.0
        else:
            damped = _Damped(origin.whole)
            located = damped.located(reduced, ratio)
            ratio = damped.boundary(near=ratio) if located is None else located
    known = math.isfinite(ratio)
    return ratio, Outcome.converged if known else Outcome.not_reached


def _located_in_band(plant: Plant, ratio: float, grows_now: bool) -> float | None:
    """Return the ratio where modes of the whole are computed up to a frequency alone.

    Secants of the fastest growth begin without added damping and at the ratio of the modes that are
    run, from which growth rates of the whole differ by some per cent.

    Returns:
        NaN where the largest does not suffice, None where the search has come to no ratio.
    """
    origin, truth = plant.structure.reduced_from, plant.truth
    assert origin is not None  # noqa: S101
    assert truth is not None  # noqa: S101
    if ratio == 0.0 or not grows_now:
        return ratio if grows_now == (ratio != 0.0) else None

    def damped(added: float) -> Truth:
        ratios = origin.whole.modal_damping
        if ratios.ndim and origin.whole.size <= DENSE:  # those without a ratio have 0
            ratios = np.pad(ratios, (0, origin.whole.size - len(ratios)))
        whole = origin.whole.with_(modal_damping=ratios + added)
        return Truth.of(whole, origin.frequency_max)

    def grows(added: float) -> bool:
        return bool(damped(added).unstable.size)

    if not math.isfinite(ratio):
        return ratio if grows(SquealLimits.most_damping) else None
    before, growth = 0.0, _fastest(truth)
    # growth is nearly linear in the ratio: secants end within a few steps, or not at all
    for _ in range(5):
        now = _fastest(damped(ratio))
        if (now - growth) * (ratio - before) >= 0.0:  # more damping destabilizes
            return None
        step = now * (ratio - before) / (now - growth)
        before, ratio, growth = ratio, ratio - step, now
        if not 0.0 < ratio <= SquealLimits.most_damping:
            return None
        if abs(step) < 0.01 * before and not grows(1.01 * ratio):
            return ratio
    return None


def _fastest(truth: Truth) -> float:
    """Return the fastest growth within the band, 1/s; negative where all modes decay."""
    return float(truth.values[truth.within].real.max())


class _Damped:
    """Small motions of a structure in coordinates of its modes at rest, with damping added."""

    def __init__(self, structure: ContactStructure) -> None:
        kept = Coordinates(StaticSpace(structure, structure.size), structure.size, 0)
        self.stiffness, self.damping = kept.small_motions()
        self.rates = 2.0 * kept.omega
        """∂C/∂ζ, a diagonal."""

    def values(self, ratio: float) -> np.ndarray:
        """Return all eigenvalues."""
        return quick_values(self.stiffness, self.damping + np.diag(ratio * self.rates))

    def grows(self, ratio: float) -> bool:
        """Tell whether a mode grows by more than round-off."""
        values = self.values(ratio)
        return bool((values.real > 1e-9 * np.abs(values)).any())

    def located(self, reduced: Self, ratio: float) -> float | None:
        """Return the ratio near that of a reduction, in which all larger ones were tried.

        Returns:
            NaN where the largest ratio does not suffice in either, None where there is none near.
        """
        if math.isnan(ratio):
            return math.nan if self.grows(SquealLimits.most_damping) else None
        values = reduced.values(ratio)
        ends = self._followed(complex(values[values.real.argmax()]), ratio)
        # farther away it may be the ratio of another mode: then all ratios are searched
        if ends is None or not 0.8 * ratio < ends < 1.25 * ratio:
            return None
        return None if self.grows(ends * (1.0 + 1e-6)) else ends

    def boundary(self, near: float = 0.0) -> float:
        """Return the ratio from which nothing grows, NaN if the largest does not suffice.

        Args:
            near: the ratio of a reduction, in which all larger ones were tried; 0: none.
        """
        # ratios of damping between which stability is taken to change once at most
        tried = [*np.geomspace(1e-4, SquealLimits.most_damping, 24)[::-1].tolist(), 0.0]
        if near > 0.0 and not self.grows(1.25 * near):
            tried = [1.25 * near, *(ratio for ratio in tried if ratio < 0.8 * near)]
        above = math.nan
        for ratio in tried:
            values = self.values(ratio)
            if ratio == 0.0 or (values.real > 1e-9 * np.abs(values)).any():
                break
            above = ratio
        if math.isnan(above):
            return math.nan
        for _ in range(len(values)):
            fastest = complex(values[values.real.argmax()])
            located = self._followed(fastest, ratio)
            if located is None or not ratio <= located <= above:
                break
            # another mode may need more
            values = self.values(located * (1.0 + 1e-6))
            if not (values.real > 1e-9 * np.abs(values)).any():
                return located
            ratio = located
        return float(brentq(self._growth, ratio, above, xtol=1e-9))

    def _growth(self, ratio: float) -> float:
        return float(self.values(ratio).real.max())

    def _followed(self, s: complex, ratio: float) -> float | None:
        """Return the ratio at which a mode stops growing, None where it cannot be followed."""
        right = left = None
        for _ in range(30):
            damping = self.damping + np.diag(ratio * self.rates)
            matrix = s * (s * np.eye(len(damping)) + damping) + self.stiffness
            factors = la.lu_factor(matrix, check_finite=False)
            start = np.random.default_rng(0).standard_normal(len(matrix))
            right = start if right is None else right
            left = start if left is None else left
            for _ in range(2):
                right = la.lu_solve(factors, right)
                left = la.lu_solve(factors, left, trans=2)
                right, left = right / np.linalg.norm(right), left / np.linalg.norm(left)
            if not np.isfinite(right).all() or not np.isfinite(left).all():
                return None
            adjoint = left.conj()
            of_s = adjoint @ (2.0 * s * right + damping @ right)
            off = adjoint @ (matrix @ right) / of_s
            of_ratio = adjoint @ (s * self.rates * right) / of_s
            if of_ratio.real == 0.0:
                return None
            change = (s.real - off.real) / of_ratio.real
            s = 1j * complex(s - off - change * of_ratio).imag
            ratio += change
            if abs(change) <= 1e-13 * abs(ratio):
                return float(ratio)
        return None
