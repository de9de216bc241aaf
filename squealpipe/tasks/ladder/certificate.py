"""What is known of a motion without a run, where contact is kept: bounds with measured margins.

About the equilibrium of sliding contact, A1's own, the motion from rest stays below
y* + |y1| + |y2| as far as it is linear, with y_i the modal amplitudes. The quadratic part of the
springs' geometry adds at most S = (S_x, S_y) to second order
(:func:`squealpipe.methods.modal_bounds.motion_about`). Contact is certified where

    y* + |y1| + |y2| + 2 S_y + 0.01 l_pre < l_pre,

the linear motion stays slower than the belt and within 0.35 of the shorter spring, S is less than
a tenth of the reach, ω2 is near none of ω1, 2 ω1 and 3 ω1, where the modes exchange energy and no
low order tells how far, and the difference tone ω2 − ω1 adds less than a quarter to the slower
mode. The largest force and distance are then bounded by those of the linear motion and 1.25 S.

Nothing of this is proved: friction makes the system non-conservative, and no order of the series
bounds it for all times. The factors are measured over the whole range in which a certificate is
given (:class:`Measured`), both belt directions, |V| from 0.05 to 316 l_pre √(k1/m):

- contact, force and distance: in 11.3 million random cells, a quarter of each parameter at the edge
  of its range, 2,303,766 certificates: none lost contact, and force and distance needed no more
  than 1.06 S_y and 0.81 S;
- frequency (:func:`dominance`): of 176,961 cells none was wrong by more than 0.32 S_y over the
  amplitude of the dominant mode; half of that ratio is reckoned with.

Without the limit on the reach and 3 ω1 eight wrong ones were found in 1.7 million and by a directed
search, all with a reach above 0.39 of a spring shorter than 6 l_pre.

In 109 of 143,152 certified cells the mass did reach the belt, by the second order; the bounds held
there too. tests/tasks/ladder repeats all of it on cells of its own; with n certificates and none
wrong, fewer than 3/n are wrong at 95 % confidence.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from squealpipe.laws.contact import contact_force
from squealpipe.laws.friction import dragging_force, slides
from squealpipe.laws.springs import elastic_force, geometry, linear_stiffness
from squealpipe.methods.modal_bounds import SecondOrder, motion_about
from squealpipe.models import a4

LARGEST_EXCHANGE = 0.25
"""Share that the difference tone may add to the slower mode (``SecondOrder.exchange``)."""
FACTOR = 2.0
"""Times the second-order shift that must be left; 1.06 was needed."""
FLOOR = 0.01
"""Share of l_pre that must be left besides."""
BEYOND = 1.25
"""Times the second-order shift by which force and distance may exceed their bounds to first order;
1.06 and 0.81 were needed."""
LARGEST_SHIFT = 0.1
"""Second-order shift over the reach of the linear motion, from which no order is trusted."""
NEAREST_EQUAL = 1.15
"""Least ω2/ω1."""
NEAREST_WHOLE = 0.15
"""Least distance of ω2/ω1 from 2 and 3."""
LARGEST_SWING = 0.35
"""Reach of the linear motion over the shorter spring, from which no order is trusted."""
CONTACT_SAMPLE = "measured, not proved: none of 2,303,766 random certificates was wrong"
BOUND_SAMPLE = "measured, not proved: exceeded in none of 2,303,766 random cells"
FREQUENCY_SAMPLE = "measured, not proved: wrong in none of 176,961 random cells"
FIRST_INTEGRAL_SAMPLE = "measured, not proved: wrong in 2 of 76,652 random cells"
LARGEST_TURN = 0.05
"""Reach over the shorter spring up to which the first integral of A4 is trusted in A1, or a
:data:`RESONANT` part of it."""
RESONANT = 5.0
"""How much more than far from resonance is reckoned with up to ω2 = 2 ω1 and a little more."""
UNEQUAL = 1.5
"""Ratio of modal amplitudes from which one mode is said to dominate."""
LEAST_PERIODS = 4.0
"""Periods of the dominant mode that the horizon must show."""
LINE_WIDTH = 4.0 * math.pi
"""Half the width of a spectral line under a Hann window, over one through the length of the run."""


class Measured(NamedTuple):
    """The range over which the margin was measured; outside no certificate is given.

    Attributes:
        least_length: free lengths, over l_pre.
        spread: larger over smaller spring stiffness.
        contact: k3 over the mean spring stiffness, from and to.
        friction: μ.
        horizon: end of the run, in √(2m/(k1 + k2)).
    """

    least_length: float = 3.0
    spread: float = 5.0
    contact: tuple[float, float] = (0.05, 5.0)
    friction: float = 0.8
    horizon: float = 400.0


RANGE = Measured()


class Certificate(NamedTuple):
    """What is known of contact without a run; arrays of the cells' shape.

    Attributes:
        keeps: contact is never lost up to the horizon.
        second: the motion about the equilibrium, and its second-order shift, m.
        highest: bound on y to first order, m.
        slides: the linear motion stays slower than the belt.
        mild: the shift is a small share of the reach, and the reach of the shorter spring.
        detuned: the modes exchange no energy at low order.
        in_range: the margin was measured for such parameters and horizon.
    """

    keeps: np.ndarray
    second: SecondOrder
    highest: np.ndarray
    slides: np.ndarray
    mild: np.ndarray
    detuned: np.ndarray
    in_range: np.ndarray

    def largest_force(self, preload: Any) -> np.ndarray:
        """Bound on N/(k3 l_pre) where contact is kept; not less than that of the start."""
        motion, shift, _ = self.second
        return np.asarray(
            np.maximum(1.0, 1.0 + (BEYOND * shift[..., 1] - motion.lowest()) / preload)
        )

    def largest_distance(self) -> np.ndarray:
        """Bound on √(x² + y²) where contact is kept, m."""
        motion, shift, _ = self.second
        return np.asarray(motion.farthest() + BEYOND * np.hypot(shift[..., 0], shift[..., 1]))


def contact_certificate(p: Any, alpha1: Any, alpha2: Any, t_end: Any) -> Certificate:
    """Which cells keep contact up to ``t_end``, s.

    Args:
        p: ``Parameters``, or an object with its fields and ``drag``; each may be an array.
        alpha1, alpha2: angles, rad, of one shape.
        t_end: horizon, s.
    """
    g = geometry(np.asarray(alpha1, float), np.asarray(alpha2, float))

    def sliding(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        fx, fy = elastic_force(x, y, p, g)
        normal = contact_force(y, p)
        return (fx + dragging_force(normal, p)) / p.mass, (fy + normal) / p.mass

    shape = np.shape(g.c1)
    preload = np.broadcast_to(np.asarray(p.preload, float), shape)
    second = motion_about(sliding, shape, preload)
    motion, shift, exchange = second
    highest = motion.highest()
    with np.errstate(invalid="ignore"):
        ratio = motion.omega[..., 1] / motion.omega[..., 0]
        reach = motion.farthest()
        mild = np.hypot(shift[..., 0], shift[..., 1]) < LARGEST_SHIFT * reach
        mild &= reach < LARGEST_SWING * np.minimum(p.length1, p.length2)
        left = preload - highest > FACTOR * shift[..., 1] + FLOOR * preload
    detuned = (ratio > NEAREST_EQUAL) & (np.abs(ratio - 2.0) > NEAREST_WHOLE)
    detuned &= np.abs(ratio - 3.0) > NEAREST_WHOLE
    detuned &= exchange < LARGEST_EXCHANGE
    slower = slides(motion.fastest(), p)
    in_range = np.broadcast_to(_measured(p, t_end), shape)
    keeps = motion.oscillates & slower & mild & detuned & left & in_range
    return Certificate(keeps, second, highest, slower, mild, detuned, in_range)


class Dominance(NamedTuple):
    """Whether one mode clearly dominates y within the horizon, and the error of its frequency.

    Attributes:
        dominates: one mode is larger than the other by a factor and by all that the second order
            adds to y, and the horizon shows its periods and tells both lines apart.
        error: of second order, relative; measured, not proved (:data:`FREQUENCY_SAMPLE`).
    """

    dominates: np.ndarray
    error: np.ndarray


def dominance(certificate: Certificate, t_end: float) -> Dominance:
    """Of the motion about A1's own equilibrium, up to ``t_end``, s."""
    motion, shift, _ = certificate.second
    size = np.abs(motion.y_mode)
    larger, smaller = size.max(axis=-1), size.min(axis=-1)
    omega = np.where(size[..., 0] > size[..., 1], motion.omega[..., 0], motion.omega[..., 1])
    added = shift[..., 1]
    with np.errstate(all="ignore"):
        dominates = (larger > UNEQUAL * smaller) & (larger > smaller + added)
        dominates &= omega * t_end > 2.0 * math.pi * LEAST_PERIODS
        dominates &= (motion.omega[..., 1] - motion.omega[..., 0]) * t_end > LINE_WIDTH
        return Dominance(dominates, 0.5 * added / larger)


def first_integral_error(certificate: Certificate, reach: a4.ReachFromRest, p: Any) -> np.ndarray:
    """By how much the force may exceed what A4's first integral allows, relative; ∞ for unknown.

    The springs' geometry changes their force by the share r/L for the largest r. The changes add
    up where they make the sliding state unstable, or the modes exchange energy: there nothing, and
    :data:`RESONANT` times as much, is reckoned with. Measured, not proved
    (:data:`FIRST_INTEGRAL_SAMPLE`), in cells of :class:`Measured` at its longest horizon that are
    not certified to keep contact. Reckoning with r/L alone, up to 0.2, was wrong in one of a
    thousand.
    """
    motion = certificate.second.motion
    turn = reach.distance / np.minimum(p.length1, p.length2)
    far = motion.omega[..., 1] > (2.0 + NEAREST_WHOLE) * motion.omega[..., 0]
    error = np.where(far, turn, RESONANT * turn)
    known = motion.oscillates & certificate.in_range & slides(reach.speed, p)
    return np.where(known & (error <= LARGEST_TURN), error, np.inf)


def first_integral_reach(params: Any, alpha1: Any, alpha2: Any) -> a4.ReachFromRest:
    """Bounds of A4 from rest over arrays of angles."""
    stiffness = linear_stiffness(params, geometry(np.asarray(alpha1), np.asarray(alpha2)))
    return a4.reach_from_rest(stiffness, params.drag, params)


def _measured(p: Any, t_end: Any) -> np.ndarray:
    """Whether parameters and horizon lie within the range of :data:`RANGE`."""
    mean = 0.5 * (np.asarray(p.k1) + p.k2)
    spread = np.maximum(p.k1, p.k2) / np.minimum(p.k1, p.k2)
    contact = p.k3 / mean
    return np.asarray(
        (np.minimum(p.length1, p.length2) >= RANGE.least_length * np.asarray(p.preload))
        & (spread <= RANGE.spread)
        & (contact >= RANGE.contact[0])
        & (contact <= RANGE.contact[1])
        & (np.asarray(p.mu) <= RANGE.friction)
        & (t_end <= RANGE.horizon * (1.0 + 1e-12) * np.sqrt(p.mass / mean))
    )
