"""cos, sin, exp, log, sqrt, tanh, … of floats, arrays and the symbols of a system."""

from typing import Any

import numpy as np

from squealpipe.systems import natural_exponential
from squealpipe.systems.taylor import symbols


def _of(name: str, value: Any) -> Any:
    if isinstance(value, symbols.Symbol):
        return symbols.function(name, value)
    return getattr(np, name)(value)


def cos(value: Any) -> Any:
    """cos x."""
    return _of("cos", value)


def sin(value: Any) -> Any:
    """sin x."""
    return _of("sin", value)


def exp(value: Any) -> Any:
    """eˣ."""
    return _of("exp", value)


def log(value: Any) -> Any:
    """ln x."""
    return _of("log", value)


def tanh(value: Any) -> Any:
    """tanh x."""
    return _of("tanh", value)


def sinh(value: Any) -> Any:
    """sinh x."""
    return _of("sinh", value)


def cosh(value: Any) -> Any:
    """cosh x."""
    return _of("cosh", value)


def atan(value: Any) -> Any:
    """arctan x."""
    return _of("atan", value)


def asin(value: Any) -> Any:
    """arcsin x, −1 < x < 1."""
    return _of("asin", value)


def sqrt(value: Any) -> Any:
    """√x."""
    return value**0.5 if isinstance(value, symbols.Symbol) else np.sqrt(value)


natural_exponential.exp.register(symbols.Symbol, exp)
