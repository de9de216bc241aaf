"""Contact that is never lost, without a run: a bound with a measured margin.

About the equilibrium of sliding contact, A1's own, the motion from rest stays below
y* + |y1| + |y2| as far as it is linear, with y_i the modal amplitudes. The quadratic part of the
springs' geometry adds at most S_y to second order
(:func:`squealpipe.methods.modal_bounds.motion_about`). Contact is certified where

    y* + |y1| + |y2| + 2 S_y + 0.01 l_pre < l_pre,

the mass stays slower than the belt, S is less than a tenth of the reach, and neither ω2 ≈ ω1 nor
ω2 ≈ 2 ω1, where the modes exchange energy and no low order tells how far. The bound is not
proved: friction makes the system non-conservative, and no order of the series bounds it for all
times. The factor 2 is measured, over the whole range in which a certificate is given
(:class:`Measured`): in 1.5 million random cells with 330,000 certificates none was wrong, and
of those that lost contact none needed a factor above 0.87. tests/tasks/ladder/test_certificate.py
repeats it on cells of its own; with n certificates and none wrong, fewer than 3/n are wrong at
95 % confidence.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from squealpipe.laws.contact import contact_force
from squealpipe.laws.friction import dragging_force, slides
from squealpipe.laws.springs import elastic_force, geometry
from squealpipe.methods.modal_bounds import SecondOrder, motion_about

FACTOR = 2.0
"""Times the second-order shift that must be left; 0.87 was needed."""
FLOOR = 0.01
"""Share of l_pre that must be left besides."""
LARGEST_SHIFT = 0.1
"""Second-order shift over the reach of the linear motion, from which no order is trusted."""
NEAREST_EQUAL = 1.15
"""Least ω2/ω1."""
NEAREST_DOUBLE = 0.15
"""Least distance of ω2/ω1 from 2."""


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
        slides: the mass stays slower than the belt.
        mild: the shift is a small share of the reach.
        detuned: the modes do not exchange energy at low order.
        in_range: the margin was measured for such parameters and horizon.
    """

    keeps: np.ndarray
    second: SecondOrder
    highest: np.ndarray
    slides: np.ndarray
    mild: np.ndarray
    detuned: np.ndarray
    in_range: np.ndarray


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
    motion, shift = second
    highest = motion.highest()
    with np.errstate(invalid="ignore"):
        ratio = motion.omega[..., 1] / motion.omega[..., 0]
        mild = np.hypot(shift[..., 0], shift[..., 1]) < LARGEST_SHIFT * motion.farthest()
        left = preload - highest > FACTOR * shift[..., 1] + FLOOR * preload
    detuned = (ratio > NEAREST_EQUAL) & (np.abs(ratio - 2.0) > NEAREST_DOUBLE)
    slower = slides(motion.fastest(), p)
    in_range = np.broadcast_to(_measured(p, t_end), shape)
    keeps = motion.oscillates & slower & mild & detuned & left & in_range
    return Certificate(keeps, second, highest, slower, mild, detuned, in_range)


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
