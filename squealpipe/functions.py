"""cos, sin, exp, log, sqrt, tanh, … of floats, arrays and the symbols of a system."""

from squealpipe.systems.functions import (
    asin,
    atan,
    cos,
    cosh,
    exp,
    log,
    sin,
    sinh,
    sqrt,
    tanh,
)

__all__ = ["asin", "atan", "cos", "cosh", "exp", "log", "sin", "sinh", "sqrt", "tanh"]
