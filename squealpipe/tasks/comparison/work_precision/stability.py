"""Work–precision of stability: numeric eigenvalues beside closed forms, next to flutter onset.

At onset two eigenvalues merge and the matrix is defective, so an error of one ulp in it moves
them by the square root of an ulp. The closed form works on the discriminant itself instead.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import mpmath
import numpy as np
import scipy.linalg

from squealpipe.laws.springs import Stiffness
from squealpipe.models import a3, a4
from squealpipe.schema import Outcome
from squealpipe.schema.comparison import Role
from squealpipe.tasks.comparison.work_precision.solutions import Solution, timed

TASK = "stability"
_DIGITS = 60


class OnsetCase:
    """A contact state with unit mass whose flutter onset is at μ = 1.

    The structure of Hoffmann et al. (2002), K11 = K22 + k3, with numbers that binary holds
    exactly, so that 1 − μ is the exact distance from onset.
    """

    stiffness = Stiffness(2.0, -1.0, 1.0)
    k3 = 1.0
    determinant = 1.0

    def matrix(self, mu: float) -> np.ndarray:
        """Stiffness per mass in contact."""
        a11, a12, a21, a22 = a4.contact_matrix(self.stiffness, self.k3, mu)
        return np.array([[a11, a12], [a21, a22]])

    def reference(self, mu: float) -> list[complex]:
        """ω² of both modes, exact to sixty digits before rounding."""
        with mpmath.workdps(_DIGITS):
            (a11, a12), (a21, a22) = (map(mpmath.mpf, row) for row in self.matrix(mu))
            half, mean = (a11 - a22) / 2, (a11 + a22) / 2
            root = mpmath.sqrt(half * half + a12 * a21)
            return [complex(mpmath.sqrt(mean - root)), complex(mpmath.sqrt(mean + root))]


def solutions(*, halvings: Sequence[int], repeats: int) -> Iterator[Solution]:
    """Closed form and numeric eigenvalues at distances 1 − μ = 2⁻ⁿ from onset.

    Args:
        halvings: n of the distances 2⁻ⁿ, which binary holds exactly.
        repeats: runs of which the median time is taken.
    """
    case = OnsetCase()
    for distance in (2.0**-n for n in halvings):
        for side, mu in (("stable", 1.0 - distance), ("flutter", 1.0 + distance)):
            reference = _sorted(case.reference(mu))
            for method, role, run in _methods(case, mu):
                found, seconds = timed(run, repeats)
                yield Solution(
                    task=TASK,
                    scene=side,
                    method=method,
                    setting=f"1 - mu {distance:.1e}",
                    role=role,
                    error=float(np.max(np.abs(_sorted(found) - reference) / np.abs(reference))),
                    wall_time=seconds,
                    evaluations=1.0,
                    reference_error=np.finfo(float).eps,
                    outcome=Outcome.converged if side == "stable" else Outcome.complex_pair,
                )


def _methods(case: OnsetCase, mu: float) -> list[tuple[str, Role, Callable[[], Any]]]:
    matrix = case.matrix(mu)
    first_order = np.block([[np.zeros((2, 2)), np.eye(2)], [-matrix, np.zeros((2, 2))]])

    def closed_form() -> Any:
        invariants = a4.spectrum(case.stiffness, case.determinant, k3=case.k3, mu=mu, mass=1.0)
        return np.array(a3.eigenvalues(invariants)) * -1j

    def numpy_4() -> Any:
        s = np.linalg.eigvals(first_order)
        return (s * -1j)[np.argsort(-s.imag)][:2]

    return [
        ("closed form", Role.our_setting, closed_form),
        ("eigenvalues, 4 × 4 (numpy)", Role.public, numpy_4),
        (
            "eigenvalues, 2 × 2 (scipy)",
            Role.public,
            lambda: np.sqrt(scipy.linalg.eigvals(matrix).astype(complex)),
        ),
    ]


def _sorted(omega: Any) -> np.ndarray:
    """Both ω with |Im|, ascending real part: signs of growth are a convention."""
    omega = np.asarray(omega, complex)
    return np.sort_complex(np.abs(omega.real) + 1j * np.abs(omega.imag))
