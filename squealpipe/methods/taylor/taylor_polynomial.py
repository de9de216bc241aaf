"""The Taylor polynomials of one integration step; compiled.

Coefficients are an array [variable, order, lane].
"""

from typing import Any

from squealpipe.methods.compiled import polynomial


@polynomial
def evaluate(coefficients: Any, variable: int, lane: int, step: float) -> Any:
    """A variable's Taylor polynomial at ``step`` from the start of the last step."""
    order = coefficients.shape[1] - 1
    value = coefficients[variable, order, lane]
    for k in range(order - 1, -1, -1):
        value = value * step + coefficients[variable, k, lane]
    return value


@polynomial
def evaluate_with_slope(coefficients: Any, variable: int, lane: int, step: float) -> Any:
    """A variable and its time derivative at ``step``."""
    order = coefficients.shape[1] - 1
    value, slope = coefficients[variable, order, lane], 0.0
    for k in range(order - 1, -1, -1):
        slope = slope * step + value
        value = value * step + coefficients[variable, k, lane]
    return value, slope
