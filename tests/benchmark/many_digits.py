"""A problem by its Taylor series in as many decimal digits as are asked for.

Coefficients come from the recurrences of automatic differentiation, order and step from Jorba and
Zou (2005), "A software package for the numerical integration of ODEs by means of high-order Taylor
methods": the order follows from the digits, the step from the last two coefficients.
"""

from collections.abc import Callable
from numbers import Number
from typing import Any

import mpmath

from squealpipe.benchmark.problems import Problem

LONGEST_STEP = 1.0
SAMPLES = 24
"""States within a step between which events are looked for."""


class Series:
    """A quantity along the motion: its Taylor coefficients as far as they are known.

    Args:
        quantities: all of a regime, in the order in which they depend on one another.
        coefficient: order k, coefficients below k → the coefficient of order k.
    """

    def __init__(self, quantities: list["Series"], coefficient: Callable[..., Any]):
        self.terms: list[Any] = []
        self.quantities, self.coefficient = quantities, coefficient
        quantities.append(self)

    def _with(self, coefficient: Callable[..., Any]) -> "Series":
        return Series(self.quantities, coefficient)

    def __add__(self, other: Any) -> "Series":
        a = self.terms
        if isinstance(other, Series):
            b = other.terms
            return self._with(lambda k, _: a[k] + b[k])
        return self._with(lambda k, _: a[k] if k else a[0] + other)

    def __mul__(self, other: Any) -> "Series":
        a = self.terms
        if isinstance(other, Series):
            b = other.terms
            return self._with(lambda k, _: mpmath.fdot(a[: k + 1], b[k::-1]))
        return self._with(lambda k, _: a[k] * other)

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self) -> "Series":
        return -1 * self

    def __sub__(self, other: Any) -> "Series":
        return self + -1 * other

    def __rsub__(self, other: Any) -> "Series":
        return other + -1 * self

    def __pow__(self, exponent: float) -> "Series":
        a = self.terms

        def coefficient(k: int, u: list[Any]) -> Any:
            if k == 0:
                return a[0] ** exponent
            weights = [exponent * (k - j) - j for j in range(k)]
            products = [w * b for w, b in zip(weights, a[k:0:-1], strict=True)]
            return mpmath.fdot(products, u) / (k * a[0])

        return self._with(coefficient)

    def composed(self, function: Callable[[Any], Any], slope: list[Any]) -> "Series":
        """f(a), whose rate is ``slope`` times that of a; slope is known one order less."""
        a = self.terms

        def coefficient(k: int, _: list[Any]) -> Any:
            if k == 0:
                return function(a[0])
            rates = [j * a[j] for j in range(1, k + 1)]
            return mpmath.fdot(rates, slope[k - 1 :: -1]) / k

        return self._with(coefficient)


class Functions:
    """The functions of the problems' texts, of series and of numbers."""

    @staticmethod
    def cos(a: Any) -> Any:
        return mpmath.cos(a) if isinstance(a, Number) else _sine_and_cosine(a)[1]

    @staticmethod
    def sin(a: Any) -> Any:
        return mpmath.sin(a) if isinstance(a, Number) else _sine_and_cosine(a)[0]

    exp, log, tanh = mpmath.exp, mpmath.log, mpmath.tanh
    """Of numbers: no field of a problem has them."""


def _sine_and_cosine(a: Series) -> tuple[Series, Series]:
    opposite: list[Any] = []  # −sin a, which follows the sine
    cosine = a.composed(mpmath.cos, opposite)
    sine = a.composed(mpmath.sin, cosine.terms)
    (-sine).terms = opposite
    return sine, cosine


class ManyDigits:
    """The motion of a problem by Taylor series."""

    def __init__(self, data: Any, digits: int) -> None:
        self.digits = digits
        # the local error is 10^(4 − digits): errors of the steps add up
        self.order = int(mpmath.ceil((digits - 4) * mpmath.log(10) / 2)) + 1
        self.problem = Problem(data, mpmath, mpmath.mpf)
        self.problem.patience = 10**12
        symbols = Problem(data, Functions, mpmath.mpf)
        self.regimes = {}
        for regime, rates in symbols.fields.items():
            quantities: list[Series] = []
            time = Series(quantities, lambda k, _: mpmath.mpf(k == 1))
            states = [Series(quantities, None) for _ in symbols.states]
            self.regimes[regime] = quantities, time, states, rates(time, states)

    def coefficients(self, t: Any, y: Any, regime: str) -> list[list[Any]]:
        """Of each state, from order 0."""
        quantities, time, states, rates = self.regimes[regime]
        for quantity in quantities:
            quantity.terms.clear()
        for state, value in zip(states, y, strict=True):
            state.terms.append(mpmath.mpf(value))
        followers = quantities[1 + len(states) :]
        for k in range(self.order):
            time.terms.append(t if k == 0 else mpmath.mpf(k == 1))
            for quantity in followers:
                quantity.terms.append(quantity.coefficient(k, quantity.terms))
            for state, rate in zip(states, rates, strict=True):
                known = rate.terms[k] if isinstance(rate, Series) else rate * (k == 0)
                state.terms.append(known / (k + 1))
        return [list(state.terms) for state in states]

    def step(self, regime: str, t: Any, y: Any) -> tuple[Any, Any, list[Any]]:
        """Length of a step, the flow within it, and states on the way."""
        series = self.coefficients(t, y, regime)
        size = max(mpmath.mpf(1), *(abs(value) for value in y))
        longest = mpmath.mpf(LONGEST_STEP)
        for order in (self.order - 1, self.order):
            last = max(abs(terms[order]) for terms in series)
            if last:
                radius = mpmath.root(size / last, order)
                longest = min(longest, radius / mpmath.e**2)
        h = min(longest, self.problem.t_end - t)

        def flow(span: Any) -> list[Any]:
            return [mpmath.polyval(terms[::-1], span) for terms in series]

        return h, flow, [flow(k * h / SAMPLES) for k in range(SAMPLES + 1)]
