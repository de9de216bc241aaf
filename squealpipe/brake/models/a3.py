"""A3: the linearized model about its static sliding state: eigenvalue stability (section 6).

Drops from A1 the exact geometry, contact loss and the reversal of friction: the contact spring
pulls as well as pushes. Valid for small motion about a static state in contact with ẋ < V.

The angles enter through one complex number only, Z = k1 exp(2iα1) + k2 exp(−2iα2): with
S = k1 + k2, K11 = ½(S + Re Z), K22 = ½(S − Re Z), K12 = ½ Im Z. In the plane of Z all of Fig. 6
is two circles about c = k3 (1 − iμ) and a line: flutter inside |Z − c| = μ k3, divergence
outside |Z − c|² = (S + k3)² + μ²k3², and Eq. (11) at Re(Z (1 + iμ)) = −S.
"""

from typing import Any, NamedTuple

import numpy as np

from squealpipe.brake.models.a4 import StiffnessSpectrum, natural_frequencies_squared
from squealpipe.codes import LinearRegime
from squealpipe.laws.springs import Stiffness


class Groups(NamedTuple):
    """Squared ratios of Eqs. (12a)–(12d) to ω11²; ω12² may be negative, so ω12 is not formed."""

    coupling: Any
    vertical: Any
    contact: Any


def groups(stiffness: Stiffness, k3: Any) -> Groups:
    """Eqs. (12a)–(12g): ω12²/ω11², ω22²/ω11², ω3²/ω11².

    Singular where K11 = 0, at α1 = α2 = π/2, for there τ = ω11 t stands still (E12).
    """
    return Groups(
        stiffness.k12 / stiffness.k11, stiffness.k22 / stiffness.k11, k3 / stiffness.k11
    )


def acceleration(x: Any, y: Any, ratios: Groups, mu: Any, load: Any) -> tuple[Any, Any]:
    """Eqs. (13), (14): (X'', Y'') with respect to τ = ω11 t; Eqs. (16), (17) with ``load`` 0.

    Args:
        x, y: X = x/l_pre, Y = y/l_pre of Eqs. (12e), (12f), about the unloaded state, or about
            the static state where ``load`` is 0: the change of variable is X − X* (E4).
        load: ½ (k3/K11)(1 + tanh σ l_pre), which tends to k3/K11.
    """
    return (
        mu * load - x - (ratios.coupling + mu * ratios.contact) * y,
        load - ratios.coupling * x - (ratios.vertical + ratios.contact) * y,
    )


def jacobian(ratios: Groups, mu: Any) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """Derivative of the accelerations of Eqs. (16), (17) by (X, Y)."""
    return (
        (-1.0, -(ratios.coupling + mu * ratios.contact)),
        (-ratios.coupling, -(ratios.vertical + ratios.contact)),
    )


def eigenvalues(invariants: StiffnessSpectrum) -> tuple[Any, Any]:
    """The s of largest real part of either mode, complex, 1/s; the others are −s.

    Flutter gives both modes the same growth and frequency; divergence gives mode 1 s > 0.
    """
    first, second = (
        np.sqrt(-squared) for squared in natural_frequencies_squared(invariants)
    )
    return abs(first.real) + 1j * abs(first.imag), abs(second.real) + 1j * abs(
        second.imag
    )


def regime(invariants: StiffnessSpectrum) -> Any:
    """:class:`LinearRegime` of each cell: flutter where ω² is complex, divergence where ω1² < 0."""
    flutter = invariants.discriminant < 0
    divergence = ~flutter & (invariants.determinant < 0)
    return np.where(
        flutter,
        LinearRegime.flutter,
        np.where(divergence, LinearRegime.divergence, LinearRegime.stable),
    )


def shape_similarity(invariants: StiffnessSpectrum, mu: Any, k3: Any, mass: Any) -> Any:
    """Modal assurance criterion |v1ᴴ v2|²/(|v1|² |v2|²) of the two mode shapes.

    Henrici's departure from normality g of a 2×2 matrix gives it as g²/(g² + |λ1 − λ2|²)
    (1962); here g² = h² of real λ, h² − |λ1 − λ2|² of complex ones, with
    h = μ k3/m the difference of the two couplings. It is 1 at the onset of flutter alone.
    """
    asymmetry = (mu * k3 / mass) ** 2
    apart = 4.0 * np.abs(invariants.discriminant)
    departure = np.where(invariants.discriminant < 0, asymmetry - apart, asymmetry)
    whole = departure + apart
    alike = departure / np.where(whole > 0, whole, 1.0)
    return np.clip(alike.astype(float), 0.0, 1.0)


def static_state(
    stiffness: Stiffness, spring_determinant: Any, *, k3: Any, mu: Any, actuation: Any
) -> tuple[Any, Any, Any]:
    """Eqs. (15a), (15b): the equilibrium (x*, y*) of Eqs. (6), (7), m, and its contact force, N.

    The contact force F_n − K3 y* is returned as F_n det K/(det K + K3 (K11 − μK12)), which
    keeps its sign where it almost vanishes.

    Args:
        k3: K3 of Eq. (8d), or its sharp limit k3, N/m.
        actuation: right-hand side of Eq. (7), k3 l_pre in the sharp limit, N.

    Not finite where the contact stiffness is singular.
    """
    k11, k12, k22 = stiffness
    contact_determinant = spring_determinant + k3 * (k11 - mu * k12)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = actuation / contact_determinant
        return (
            scale * (mu * k22 - k12),
            scale * (k11 - mu * k12),
            scale * spring_determinant,
        )


def plane(p: Any, alpha1: Any, alpha2: Any) -> Any:
    """Z = k1 exp(2iα1) + k2 exp(−2iα2), N/m (module docstring)."""
    return p.k1 * np.exp(2j * alpha1) + p.k2 * np.exp(-2j * alpha2)


def angles_from_plane(
    z: Any, p: Any, *, both: bool = True
) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs (α1, α2) in [0, π) with :func:`plane` = z, rad, as two arrays (2, *z.shape).

    Args:
        z: complex array, N/m, within the reach |k1 − k2| ≤ |z| ≤ k1 + k2 and not 0.
        both: False: return the first pair alone, as arrays (1, *z.shape).
    """
    length = np.abs(z)
    cosine = (length * length + p.k1 * p.k1 - p.k2 * p.k2) / (2.0 * p.k1 * length)
    spread = np.arccos(np.clip(cosine, -1.0, 1.0))
    doubled = np.angle(z) + np.stack([spread, -spread] if both else [spread])
    rest = z - p.k1 * np.exp(1j * doubled)
    return np.mod(0.5 * doubled, np.pi), np.mod(-0.5 * np.angle(rest), np.pi)


def circle_arcs(
    p: Any, centre: complex, radius: float, points: int
) -> list[np.ndarray]:
    """The parts of a circle in the plane of Z that the springs reach, each as points of Z.

    Points crowd towards the ends, where the angles vary like a square root.
    """
    arcs = reached_arcs(p, centre, radius, points)
    return [arc.reshape(-1) for arc in arcs] if np.isfinite(arcs[0]).all() else []


def reached_arcs(p: Any, centre: Any, radius: Any, points: int) -> list[np.ndarray]:
    """Return two arcs of each of many circles, (circles, points); NaN of those not reached.

    Args:
        p, centre, radius: numbers or arrays (circles, 1).
    """
    nearest, farthest = np.abs(p.k1 - p.k2), p.k1 + p.k2
    offset = np.abs(centre)
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = (
            np.clip(
                (reach**2 - offset**2 - radius**2) / (2 * offset * radius), -1.0, 1.0
            )
            for reach in (nearest, farthest)
        )
        none = (radius * offset == 0) | (low == high)
        turn = _crowded(np.arccos(high), np.arccos(low), points)
        direction = np.where(none, np.nan, centre / np.where(offset == 0, 1.0, offset))
    return [
        np.atleast_2d(centre + radius * direction * np.exp(1j * sign * turn))
        for sign in (1, -1)
    ]


def line_parts(p: Any, normal: complex, level: float, points: int) -> list[np.ndarray]:
    """The parts of the line Re(Z conj(normal)) = level that the springs reach, as points of Z."""
    unit = normal / abs(normal)
    distance = level / abs(normal)
    nearest, farthest = abs(p.k1 - p.k2), p.k1 + p.k2
    if abs(distance) >= farthest:
        return []
    # Z = 0, which equal springs reach, belongs to a whole line of angles: stay clear of it.
    nearest = max(nearest, 1e-9 * farthest)
    inner = np.sqrt(max(nearest**2 - distance**2, 0.0))
    outer = np.sqrt(farthest**2 - distance**2)
    along = _crowded(inner, outer, points)
    return [unit * (distance + 1j * sign * along) for sign in (1, -1)]


def _crowded(start: Any, stop: Any, points: int) -> np.ndarray:
    share = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, points))
    return np.asarray(start + (stop - start) * share)


def flutter_circle(p: Any, k3: Any) -> tuple[Any, Any]:
    """Centre and radius of the circle in the plane of Z inside which there is flutter, N/m."""
    return k3 * (1.0 - 1j * p.drag), np.abs(p.drag) * k3


def divergence_circle(p: Any, k3: Any) -> tuple[Any, Any]:
    """Centre and radius of the circle in the plane of Z outside which there is divergence, N/m."""
    return k3 * (1.0 - 1j * p.drag), np.hypot(p.k1 + p.k2 + k3, p.drag * k3)
