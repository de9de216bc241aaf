"""A3 with dashpots and friction that depends on speed: m r̈ + C ṙ + K r = 0 (not in the paper).

C has the dashpots and, from the slope of the friction law, N0 μ'(|V|) in its x diagonal: a law that
falls with speed is negative damping. A dashpot c3 of the contact enters as k3 does in K. The
eigenvalues are the roots of

    s⁴ + p1 s³ + p2 s² + p3 s + p4,   p1 = tr C, p2 = tr K + det C,
    p3 = c11 k22 + c22 k11 − c12 k21 − c21 k12, p4 = det K   (all over m),

stable exactly where all p > 0 and p1 p2 p3 > p3² + p1² p4 (Routh–Hurwitz). As damping vanishes at a
fixed ratio, that becomes ω1² < p3/p1 < ω2², so the onset jumps away from the undamped one for all
ratios but one: damping-induced destabilization (Hoffmann and Gaul, ZAMM 83 (2003) 524–534).
"""

from typing import Any, NamedTuple

import numpy as np

from squealpipe.brake.models import a2, a3
from squealpipe.brake.models.a4 import contact_matrix
from squealpipe.brake.models.contact_system import contact_system
from squealpipe.codes import LinearRegime
from squealpipe.laws.dashpots import linear_damping
from squealpipe.laws.friction_laws import slope
from squealpipe.laws.springs import Stiffness, geometry, pair_determinant, sine_of_sum


class DampedSystem(NamedTuple):
    """C and K of the mass in contact, over m: 1/s and 1/s²; their determinants. With friction
    neither is symmetric.
    """

    c11: Any
    c12: Any
    c21: Any
    c22: Any
    k11: Any
    k12: Any
    k21: Any
    k22: Any
    determinant: Any
    damping_determinant: Any


def is_undamped(p: Any) -> Any:
    """Return whether C = 0, so that the closed form of A3 holds: of numbers, or of each of an
    array.
    """
    dashpots = (p.damping1 == 0) & (p.damping2 == 0) & (p.damping3 == 0)
    return dashpots & (slope(np.abs(p.belt_speed), p) == 0)


def damped_system(
    p: Any, alpha1: Any, alpha2: Any, *, sigma: Any = None
) -> DampedSystem:
    """The system at angles of any floating type, which decides the precision; NaN where friction
    depends on speed and there is no static contact force N0.

    Args:
        p: parameters, each of which may be an array that broadcasts against the angles.
        sigma: regularizing factor of the contact law, 1/m; None means the sharp law.
    """
    precision = np.result_type(alpha1, alpha2)
    k3, c3, mass, gradient = (
        np.asarray(value, precision)
        for value in (
            a2.contact_stiffness(p, sigma),
            p.damping3,
            p.mass,
            slope(np.abs(p.belt_speed), p),
        )
    )
    system = contact_system(p, alpha1, alpha2, k3=k3)
    stiffness = system.stiffness
    k11, k12, k21, k22 = contact_matrix(stiffness, k3, p.drag)
    damping = linear_damping(p, geometry(alpha1, alpha2))
    c11, c12, c21, c22 = contact_matrix(damping, c3, p.drag)
    sine = sine_of_sum(alpha1, alpha2)
    damping_determinant = pair_determinant(
        p.damping1, p.damping2, sine
    ) + c3 * contact_part(damping, p.drag)
    if (gradient != 0).any():
        force = a3.static_state(
            stiffness,
            system.spring_determinant,
            k3=k3,
            mu=p.drag,
            actuation=a2.actuation(p, sigma),
        )[2]
        falling = np.where(np.isfinite(force), force, np.nan) * gradient
        falling = np.where(gradient == 0, 0.0, falling)
        c11, damping_determinant = c11 + falling, damping_determinant + falling * c22
    determinant = system.spring_determinant + k3 * contact_part(stiffness, p.drag)
    determinants = (determinant / mass, damping_determinant / mass)
    entries = np.broadcast_arrays(c11, c12, c21, c22, k11, k12, k21, k22, *determinants)
    return DampedSystem._make(entry / mass for entry in entries)


def contact_part(pair: Stiffness, mu: Any) -> Any:
    """K11 − μ K12: by how much the determinant grows with the contact's share."""
    return pair.k11 - mu * pair.k12


def polynomial(s: DampedSystem) -> tuple[Any, list[Any]]:
    """A unit of s, 1/s, and p1 to p4 in its powers."""
    p = (
        s.c11 + s.c22,
        s.k11 + s.k22 + s.damping_determinant,
        s.c11 * s.k22 + s.c22 * s.k11 - s.c12 * s.k21 - s.c21 * s.k12,
        s.determinant,
    )
    unit = np.sqrt(np.abs(s.k11) + np.abs(s.k22))
    return unit, [np.asarray(c / unit**n) for n, c in enumerate(p, 1)]


def hurwitz(p: list[Any]) -> Any:
    """p1 p2 p3 − p3² − p1² p4: 0 where a pair of eigenvalues is ±iω, or two are opposite."""
    p1, p2, p3, p4 = p
    return p1 * p2 * p3 - p3 * p3 - p1 * p1 * p4


def eigenvalues(s: DampedSystem) -> np.ndarray:
    """The four s of each cell, complex, 1/s, in a new last axis; imaginary parts descend.

    From the double companion matrix, polished on the polynomial in the system's precision.
    Long double carries the digits of a double through coalescing pairs; double is faster.
    """
    unit, scaled = polynomial(s)
    known = np.all([np.isfinite(c) for c in scaled], axis=0)
    clean = [np.where(known, c, 0.0) for c in scaled]
    matrix = np.zeros((*known.shape, 4, 4))
    matrix[..., 0, :] = -np.stack(clean, axis=-1).astype(float)
    matrix[..., [1, 2, 3], [0, 1, 2]] = 1.0
    precision = np.result_type(*clean, np.complex64)
    roots = np.linalg.eigvals(matrix).astype(precision)
    p1, p2, p3, p4 = (c[..., None] for c in clean)
    # three Newton steps in long double take double eigenvalues to its round-off
    for _ in range(3):
        value = (((roots + p1) * roots + p2) * roots + p3) * roots + p4
        rate = ((4 * roots + 3 * p1) * roots + 2 * p2) * roots + p3
        step = np.where(rate == 0, 0, value / np.where(rate == 0, 1, rate))
        roots = roots - np.where(np.abs(step) < 1e-3 * (1 + np.abs(roots)), step, 0)
    order = np.argsort(-roots.imag, axis=-1, kind="stable")
    roots = np.take_along_axis(roots, order, axis=-1) * unit[..., None]
    return np.where(known[..., None], roots, np.nan + 0j)


class LinearStability(NamedTuple):
    """Largest real part, 1/s; |Im s| of both modes (mode last), rad/s; :class:`LinearRegime`;
    modal assurance criterion of the two mode shapes.
    """

    growth_rate: Any
    frequency: Any
    regime: Any
    shape_similarity: Any


def stability(s: DampedSystem) -> LinearStability:
    """Return how small motions grow: flutter where the fastest growing pair is complex."""
    growth_and_frequency = eigenvalues(s)
    leading = np.take_along_axis(
        growth_and_frequency,
        np.argmax(growth_and_frequency.real, axis=-1)[..., None],
        axis=-1,
    )[..., 0]
    # growth below a thousand units of round-off, over |s|, is that of a mode that is not damped
    marginal = 1e3 * np.finfo(growth_and_frequency.real.dtype).eps
    unstable = leading.real > marginal * np.abs(growth_and_frequency).max(axis=-1)
    oscillates = np.abs(leading.imag) > np.sqrt(marginal) * np.abs(leading)
    return LinearStability(
        leading.real.astype(float),
        np.maximum(growth_and_frequency.imag[..., 1::-1], 0.0).astype(float),
        np.where(
            unstable,
            np.where(oscillates, LinearRegime.flutter, LinearRegime.divergence),
            LinearRegime.stable,
        ),
        shape_similarity(s, growth_and_frequency[..., 0], growth_and_frequency[..., 1]),
    )


def shape_similarity(s: DampedSystem, first: Any, second: Any) -> Any:
    """Modal assurance criterion |v1ᴴ v2|²/(|v1|² |v2|²) of the shapes at two eigenvalues.

    A shape is perpendicular to the larger row of s² + C s + K; where both vanish any shape will do,
    and the two count as different.
    """
    shapes = []
    for value in (first, second):
        upper = (value * (value + s.c11) + s.k11, value * s.c12 + s.k12)
        lower = (value * s.c21 + s.k21, value * (value + s.c22) + s.k22)
        larger = np.hypot(*np.abs(upper)) >= np.hypot(*np.abs(lower))
        x, y = (np.where(larger, *pair) for pair in zip(upper, lower, strict=True))
        shapes.append((-y, x))
    (x1, y1), (x2, y2) = shapes
    size = np.hypot(np.abs(x1), np.abs(y1)) * np.hypot(np.abs(x2), np.abs(y2))
    product = np.abs(np.conj(x1) * x2 + np.conj(y1) * y2)
    ratio = product / np.where(size > 0, size, 1.0)
    return (ratio * ratio).astype(float)


def regime(s: DampedSystem) -> np.ndarray:
    """:class:`LinearRegime` of each cell, that of :func:`stability`; NaN counts as stable."""
    unclear, linear = unclear_stability(s)
    regimes = np.full(unclear.shape, LinearRegime.stable)
    regimes[unclear] = linear.regime
    return regimes


def unclear_stability(s: DampedSystem) -> tuple[np.ndarray, LinearStability]:
    """Return which cells Routh–Hurwitz does not clearly call stable, and how motions grow there.

    Eigenvalues, which take most of the time of :func:`stability`, are found of these cells only.
    """
    _, p = polynomial(s)
    # Routh–Hurwitz numbers above it have a sign that is not that of round-off
    clear = 1e-10
    decided = hurwitz(p) > clear
    for coefficient in p:
        decided &= coefficient > clear
    return ~decided, stability(DampedSystem._make(entry[~decided] for entry in s))


def critical_friction(
    p: Any, alpha1: Any, alpha2: Any, *, vanishing: bool = False
) -> tuple[Any, Any]:
    """The smallest μ ≥ 0 at which the sliding state of Coulomb friction is unstable, ∞: none.

    The second number is that of the same system without dashpots. Unstable is what grows
    exponentially; a double frequency, where motions grow like t, is not.
    Routh–Hurwitz is a quadratic in μ, because p3 and p4 are linear in it and p1 and p2 free of it.
    Without friction it is, with C_i the damping of the modes of K of eigenvalues κ_i,
    p1 det C p3 + C_1 C_2 (κ1 − κ2)², which loses no digit where a mode hardly moves a dashpot.

    Args:
        p: parameters, whose ``mu`` is not looked at and whose belt gives the direction.
        vanishing: the limit of both dashpots going to 0 at their ratio.
    """
    stiffness, determinant, _ = contact_system(p, alpha1, alpha2)
    stiffness = _without_round_off(stiffness)
    g = geometry(alpha1, alpha2)
    c11, c12, c22 = (
        entry / p.mass for entry in _without_round_off(linear_damping(p, g))
    )
    undamped = _undamped_critical_friction(p, stiffness, determinant)
    k11, k12, k22 = (entry / p.mass for entry in stiffness)
    push = p.belt_direction * p.k3 / p.mass
    k22 = k22 + p.k3 / p.mass
    p1 = c11 + c22
    sine = sine_of_sum(alpha1, alpha2) / p.mass
    product = (
        0.0 if vanishing else pair_determinant(p.damping1, p.damping2, sine)
    )  # det C
    p2 = k11 + k22 + product
    # p3 = a + b μ and p4 = d + e μ
    a, b = c11 * k22 + c22 * k11 - 2.0 * c12 * k12, -c12 * push
    d = determinant / p.mass / p.mass + p.k3 / p.mass * k11
    e = -push * k12
    mode = 0.5 * np.arctan2(2.0 * k12, k11 - k22)
    along, across = (
        (
            p.damping1 * (g.c1 * c + g.s1 * s) ** 2
            + p.damping2 * (g.c2 * c - g.s2 * s) ** 2
        )
        / p.mass
        for c, s in ((np.cos(mode), np.sin(mode)), (-np.sin(mode), np.cos(mode)))
    )
    left = p1 * product * a + along * across * ((k11 - k22) ** 2 + 4.0 * k12 * k12)
    flutter = _first_root(-b * b, p1 * p2 * b - 2.0 * a * b - p1 * p1 * e, left)
    flutter = np.where(
        (b == 0.0) & (e == 0.0), np.inf, flutter
    )  # friction couples nothing
    divergence = np.where(e < 0.0, -d / np.where(e < 0.0, e, 1.0), np.inf)
    damped = np.where(p1 > 0.0, np.minimum(flutter, divergence), undamped)
    return damped, undamped


def dashpots_lower(damped: Any, undamped: Any) -> Any:
    """Return whether one critical friction is the smaller by more than their round-off.

    Where steady sliding diverges first, both are one number that is formed in two ways.
    """
    # critical frictions within this relative difference are one
    return damped < (1.0 - 1e-12) * undamped


def _without_round_off(matrix: Stiffness) -> Stiffness:
    """K or C whose coupling is zero to round-off, which would give a friction of 1e16, or none."""
    return matrix._replace(k12=np.where(a2.coupling_is_zero(matrix), 0.0, matrix.k12))


def _undamped_critical_friction(p: Any, stiffness: Stiffness, determinant: Any) -> Any:
    """Flutter where (K11 − K22 − k3)² + 4 K12 (K12 + μ k3) < 0, divergence where det < 0."""
    k11, k12, k22 = stiffness
    k12 = p.belt_direction * k12
    gap = k11 - k22 - p.k3
    negative, positive = np.where(k12 < 0.0, k12, -1.0), np.where(k12 > 0.0, k12, 1.0)
    flutter = np.where(
        k12 < 0.0, (-gap * gap / (4.0 * negative) - negative) / p.k3, np.inf
    )
    divergence = (determinant + p.k3 * k11) / (p.k3 * positive)
    return np.where(k12 > 0.0, divergence, flutter)


def _first_root(a: Any, b: Any, c: Any) -> Any:
    """Smallest x ≥ 0 from which a x² + b x + c is negative, for a ≤ 0; ∞: none."""
    a, b, c = np.broadcast_arrays(a, b, c)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(b * b - 4.0 * a * c, 0.0))
        q = -0.5 * (b + np.where(b < 0.0, -root, root))
        zeros = np.stack([q / a, c / q])
    zeros = np.where(
        (b * b >= 4.0 * a * c) & np.isfinite(zeros) & (zeros > 0.0), zeros, np.inf
    )
    at_once = (c < 0.0) | ((c == 0.0) & ((b < 0.0) | ((b == 0.0) & (a < 0.0))))
    return np.where(at_once, 0.0, zeros.min(axis=0))
