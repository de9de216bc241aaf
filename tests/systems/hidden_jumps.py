"""Expressions that jump or have a pole, smooth and kinked ones, and their integrals.

Of u, which grows by 1 a unit of time from −0.7, and of the time. They were written down before the
code that tells them apart.
"""

from itertools import pairwise
from math import pi
from types import SimpleNamespace

import numpy as np
from scipy.integrate import quad

START = -0.7
NUMPY = SimpleNamespace(
    sin=np.sin,
    cos=np.cos,
    exp=np.exp,
    log=np.log,
    sqrt=np.sqrt,
    tanh=np.tanh,
    sinh=np.sinh,
    cosh=np.cosh,
    atan=np.arctan,
    asin=np.arcsin,
)

JUMPS = {
    "atan tan": lambda u, t, f: f.atan(f.sin(u) / f.cos(u)),
    "atan cot": lambda u, t, f: f.atan(f.cos(u) / f.sin(u)),
    "atan tan 2": lambda u, t, f: f.atan(f.sin(2 * u) / f.cos(2 * u)),
    "atan scaled": lambda u, t, f: f.atan(3 * f.sin(u) / f.cos(u)),
    "half angle": lambda u, t, f: f.atan(f.sin(u) / (1 + f.cos(u))),
    "sawtooth t": lambda u, t, f: t - f.atan(f.sin(pi * t) / f.cos(pi * t)) / pi,
    "sawtooth t fast": lambda u, t, f: f.atan(f.sin(7 * t) / f.cos(7 * t)),
    "sawtooth t shifted": lambda u, t, f: f.atan(
        f.cos(pi * t + 0.3) / f.sin(pi * t + 0.3)
    ),
    "sign sin": lambda u, t, f: f.sin(u) / f.sqrt(f.sin(u) ** 2),
    "sign cos": lambda u, t, f: f.cos(u) / f.sqrt(f.cos(u) * f.cos(u)),
    "sign sin 1-cos2": lambda u, t, f: f.sin(u) / f.sqrt(1 - f.cos(u) ** 2),
    "sign x": lambda u, t, f: u / f.sqrt(u * u),
    "sign x pow": lambda u, t, f: u / (u * u) ** 0.5,
    "sign x inverse pow": lambda u, t, f: u * (u * u) ** (-0.5),
    "sign x up": lambda u, t, f: f.sqrt(u * u) / u,
    "sign x cubed": lambda u, t, f: u**3 / f.sqrt(u**6),
    "sign x quartic root": lambda u, t, f: u / (u**4) ** 0.25,
    "sign x shifted": lambda u, t, f: (u - 1.3) / f.sqrt((u - 1.3) ** 2),
    "sign of product": lambda u, t, f: (u * (u - 2)) / f.sqrt((u * (u - 2)) ** 2),
    "sign in sum": lambda u, t, f: f.cos(u) + 0.01 * u / f.sqrt(u * u),
    "tiny sign": lambda u, t, f: f.cos(u) + 1e-7 * u / f.sqrt(u * u),
    "atan inverse": lambda u, t, f: f.atan(1 / u),
    "atan inverse cube": lambda u, t, f: f.atan(1 / u**3),
    "atan inverse shifted": lambda u, t, f: f.atan(0.1 / (u - 2.2)),
    "atan log": lambda u, t, f: f.atan(f.log(u * u) / (u)),
    "tanh inverse": lambda u, t, f: f.tanh(1 / u),
    "tanh inverse small": lambda u, t, f: f.tanh(0.01 / u),
    "logistic inverse": lambda u, t, f: 1 / (1 + f.exp(1 / u)),
    "sqrt of sign": lambda u, t, f: f.sqrt(2 + u / f.sqrt(u * u)),
    "exp of sign": lambda u, t, f: f.exp(0.5 * u / f.sqrt(u * u)),
    "asin of sign": lambda u, t, f: f.asin(0.5 * u / f.sqrt(u * u)),
    "log of sign": lambda u, t, f: f.log(3 + u / f.sqrt(u * u)),
    "square wave product": lambda u, t, f: (
        f.cos(u) * f.sin(3 * u) / f.sqrt(f.sin(3 * u) ** 2)
    ),
    "sign minus sign": lambda u, t, f: (u / f.sqrt(u * u)) * (2 + f.sin(t)),
    "square of shifted sign": lambda u, t, f: (1 + u / f.sqrt(u * u)) ** 2,
    "pole": lambda u, t, f: 1 / u,
    "pole two": lambda u, t, f: 1 / (u * u),
    "tan": lambda u, t, f: f.sin(u) / f.cos(u),
    "step by sqrt": lambda u, t, f: 0.5 * (1 + u / f.sqrt(u * u + 0 * t)),
    "acos like": lambda u, t, f: f.atan(f.sqrt(1 - f.cos(u) ** 2) / f.cos(u)),
    "root of tan2": lambda u, t, f: f.sqrt((f.sin(u) / f.cos(u)) ** 2 + 1) * f.cos(u),
    "log of tan2": lambda u, t, f: f.log((f.sin(u) / f.cos(u)) ** 2),
    "sign exp": lambda u, t, f: (f.exp(u) - 1) / f.sqrt((f.exp(u) - 1) ** 2),
    "sign tanh": lambda u, t, f: f.tanh(u) / f.sqrt(f.tanh(u) ** 2),
    "ratio of kinks": lambda u, t, f: (
        f.sqrt((u - 1) ** 2) / (u - 1) + f.sqrt((u - 2) ** 2)
    ),
}

SMOOTH = {
    "kink": lambda u, t, f: f.sqrt(u * u),
    "kink pow": lambda u, t, f: (u * u) ** 0.5,
    "kink sin": lambda u, t, f: f.sqrt(f.sin(u) ** 2),
    "kink 1-cos2": lambda u, t, f: f.sqrt(1 - f.cos(u) ** 2),
    "triangle": lambda u, t, f: f.asin(f.sin(u)),
    "triangle scaled": lambda u, t, f: f.asin(0.999999 * f.sin(u)),
    "kink quartic": lambda u, t, f: (u**4) ** 0.25,
    "kink cubed": lambda u, t, f: (u * u) ** 1.5,
    "kink shifted": lambda u, t, f: f.sqrt((u - 1.3) ** 2),
    "max": lambda u, t, f: 0.5 * (u - 1 + f.sqrt((u - 1) ** 2)),
    "max 2": lambda u, t, f: (
        0.5 * (f.sin(u) + f.cos(u) + f.sqrt((f.sin(u) - f.cos(u)) ** 2))
    ),
    "kink in exp": lambda u, t, f: f.exp(-f.sqrt(u * u)),
    "kink in tanh": lambda u, t, f: f.tanh(f.sqrt((u - 1) ** 2)),
    "kink in denominator": lambda u, t, f: 1 / (1 + f.sqrt(u * u)),
    "kink in atan": lambda u, t, f: f.atan(f.sqrt(u * u)),
    "kink in log": lambda u, t, f: f.log(1 + f.sqrt(f.sin(u) ** 2)),
    "u abs u": lambda u, t, f: u * f.sqrt(u * u),
    "regularised sign": lambda u, t, f: u / f.sqrt(u * u + 1e-2),
    "regularised sign fine": lambda u, t, f: u / f.sqrt(u * u + 1e-6),
    "steep tanh": lambda u, t, f: f.tanh(50 * u),
    "steeper tanh": lambda u, t, f: f.tanh(1000 * u),
    "steep atan": lambda u, t, f: f.atan(1000 * u),
    "atan sin": lambda u, t, f: f.atan(2 * f.sin(u)),
    "rational": lambda u, t, f: 1 / (1 + u * u),
    "runge": lambda u, t, f: 1 / (1 + 25 * u * u),
    "runge fine": lambda u, t, f: 1 / (1 + 1e4 * u * u),
    "denominator dips": lambda u, t, f: 1 / (1.001 + f.cos(u)),
    "lorentzian in t": lambda u, t, f: 1 / (1e-3 + (t - 2) ** 2),
    "angle away": lambda u, t, f: f.atan(f.sin(u) / (1.5 + f.cos(u))),
    "log positive": lambda u, t, f: f.log(2 + f.sin(u)),
    "log square plus": lambda u, t, f: f.log(u * u + 1e-4),
    "sqrt positive": lambda u, t, f: f.sqrt(1.01 + f.sin(u)),
    "gauss": lambda u, t, f: f.exp(-u * u),
    "narrow gauss": lambda u, t, f: f.exp(-((30 * u) ** 2)),
    "logistic": lambda u, t, f: (1 - f.tanh(20 * u)) / 2,
    "power": lambda u, t, f: (2 + f.sin(u)) ** 1.7,
    "negative power": lambda u, t, f: (2 + f.sin(u)) ** -2.5,
    "double well": lambda u, t, f: u**3 - u,
    "sin of square": lambda u, t, f: f.sin(u * u),
    "asinh like": lambda u, t, f: f.log(u + f.sqrt(u * u + 1)),
    "cosh": lambda u, t, f: f.cosh(0.5 * u),
    "asin inner": lambda u, t, f: f.asin(0.9 * f.cos(3 * u)),
    "two kinks": lambda u, t, f: (
        f.sqrt(u * u) + f.sqrt((u - 1) ** 2) - 2 * f.sqrt((u - 0.5) ** 2)
    ),
    "friction": lambda u, t, f: -f.tanh(u / 0.1) * (0.3 + 0.2 * f.exp(-u * u)),
    "cubed sine": lambda u, t, f: f.sin(u) ** 3 / (1 + f.cos(u) ** 2),
}


def integral(expression, t_end):
    """The integral from 0 on, by quadrature between all places where one of them is not smooth."""
    places = np.concatenate(
        [
            np.array([0.0, 0.5, 1.0, 1.3, 2.0, 2.2]) - START,
            np.arange(-40, 160) * pi / 12.0 - START,
            np.arange(0, 400) * 0.5,
            np.arange(0, 400) * pi / 14.0,
            (np.arange(0, 400) * pi / 2.0 - 0.3) / pi,
        ]
    )
    inner = np.unique(places[(places > 0.0) & (places < t_end)])
    ends = [0.0, *inner[np.diff(inner, append=t_end) > 1e-12], t_end]
    with np.errstate(all="ignore"):
        parts = [
            quad(
                lambda t: expression(np.float64(t + START), np.float64(t), NUMPY),
                *pair,
                epsabs=1e-14,
                epsrel=1e-13,
                limit=400,
            )[0]
            for pair in pairwise(ends)
        ]
    return sum(parts)
