"""Parameters of runs in units of m = k1 = l_pre = 1."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from squealpipe.laws import springs
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction_laws import COULOMB, FALLING, LAWS
from squealpipe.parameters import DEFAULTS, NUMBERS_OF_A1, TABLE, Parameters
from squealpipe.solvers.a1.records import ORDER
from squealpipe.solvers.a1.system import DISSIPATIONS, EXTENSIONS
from squealpipe.text import suggestion
from squealpipe.validation import real_array

PHYSICAL = tuple(name for name, row in TABLE.items() if row.enters_a1)
"""Parameters of a run of A1."""

_CODES = np.zeros((len(LAWS), 2, 2, 2, 2), np.int64)
"""Index into ``DISSIPATIONS`` by law, damped, static_apart, long1 and long2."""
for _code, _kind in enumerate(DISSIPATIONS):
    _CODES[(list(LAWS).index(_kind.law), *map(int, _kind[1:]))] = _code


class ScaledRuns(NamedTuple):
    """Parameters in units of m = k1 = l_pre = 1, of the shape that they were given in.

    Attributes:
        orders: ``records.ORDER`` with its parameters filled in.
        time_unit, length: √(m/k1), s, and l_pre, m.
        dissipation: index into ``system.DISSIPATIONS``.
        rate: a bound on the frequencies of the motion, for limits of steps and events.
    """

    orders: np.ndarray
    time_unit: np.ndarray
    length: np.ndarray
    dissipation: np.ndarray
    rate: np.ndarray


def scaled_parameters(
    parameters: Parameters | Mapping[str, Any], *, linear_springs: bool
) -> ScaledRuns:
    """Checked parameters in the engine's units.

    Raises:
        ValueError: an unknown parameter, or a value that is not allowed.
    """
    if isinstance(parameters, Parameters):
        return _scaled_once(parameters, linear_springs)
    return _scaled(_parameter_arrays(parameters), linear_springs)


@lru_cache(maxsize=64)
def _scaled_once(parameters: Parameters, linear_springs: bool) -> ScaledRuns:
    """One set of parameters, which was checked when it was made; for many single runs."""
    given = {name: getattr(parameters, name) for name in PHYSICAL}
    given["mu_static"] = parameters.static_mu
    scaled = _scaled({name: np.asarray(value) for name, value in given.items()}, linear_springs)
    for array in scaled:
        array.flags.writeable = False
    return scaled


def _scaled(given: Mapping[str, np.ndarray], linear_springs: bool) -> ScaledRuns:
    # Units of time that overflow are refused with the runs.
    with np.errstate(all="ignore"):
        time_unit = np.sqrt(given["mass"] / given["k1"])
        # adding 0 makes −0 to 0: equal parameters have equal bits
        scaled = {
            name: given[of]
            / unit_value(TABLE[of].units, given["mass"], given["k1"], given["preload"])
            + 0.0
            for name, of in NUMBERS_OF_A1.items()
        }
        formulas = np.isin(given["friction_law"], list(LAWS)) & (given["contact_law"] == LINEAR)
        if not formulas.all():
            raise ValueError(
                "a table, a law in Python or a contact law needs Parameters, the same for all runs"
            )
        dissipation = _dissipation(given["friction_law"], scaled, linear_springs=linear_springs)
        shape = np.broadcast_shapes(*{array.shape for array in given.values()})
        orders = np.zeros(shape, ORDER)
        for name, values in scaled.items():
            orders[name] = values
        dissipation = np.broadcast_to(dissipation, shape).copy()
        orders["onset_mu"] = _onset_mu(dissipation, orders)
        rate = np.sqrt(1 + orders["k2"] + orders["k3"]) + np.abs(orders["belt_speed"]) / np.minimum(
            orders["length1"], orders["length2"]
        )
    time_unit, length = (np.array(np.broadcast_to(a, shape)) for a in (time_unit, given["preload"]))
    return ScaledRuns(orders, time_unit, length, dissipation, np.asarray(rate))


def unit_value(unit: str, mass: np.ndarray, k1: np.ndarray, length: np.ndarray) -> Any:
    """A unit such as "N s m-1" in terms of m, k1 and l_pre; a newton is the unit k1 l_pre."""
    powers = {"kg": 0, "N": 0, "m": 0, "s": 0}
    for base, power in re.findall(r"([A-Za-z]+)(-?\d*)", unit):
        powers[base] += int(power or 1)
    powers["m"] += powers["N"]
    bases = {"kg": mass, "N": k1, "m": length, "s": np.sqrt(mass / k1)}
    above, below = (
        math.prod(bases[base] ** abs(power) for base, power in powers.items() if power * sign > 0)
        for sign in (1, -1)
    )
    return above / below


def _parameter_arrays(parameters: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Checked arrays of all parameters of a run; ``mu_static`` of None becomes ``mu``."""
    for name in parameters:
        if name not in TABLE:
            raise ValueError(f"unknown parameter {name!r}; {suggestion(name, PHYSICAL)}")
    given = {name: parameters.get(name, DEFAULTS[name]) for name in PHYSICAL}
    if given["mu_static"] is None:
        given["mu_static"] = given["mu"]
    arrays = {name: _checked(name, values) for name, values in given.items()}
    weak = (arrays["friction_law"] == COULOMB) & (arrays["mu_static"] < arrays["mu"])
    if np.any(weak):
        raise ValueError("mu_static is below mu with the Coulomb law: give mu or greater, or None")
    return arrays


def _checked(name: str, values: Any) -> np.ndarray:
    row = TABLE[name]
    if row.allowed == "law":
        for law in np.unique(np.asarray(values, dtype=object).astype(str)):
            row.check(name, str(law))
        return np.asarray(values, dtype=str)
    array = real_array(name, values)
    if row.allowed == "positive" and not (array > 0).all():
        raise ValueError(f"{name} holds {float(array.min())!r}: must be greater than 0")
    if row.allowed == "not negative" and not (array >= 0).all():
        raise ValueError(f"{name} holds {float(array.min())!r}: must be 0 or greater")
    return array


def _dissipation(
    laws: np.ndarray, scaled: Mapping[str, np.ndarray], *, linear_springs: bool
) -> np.ndarray:
    """Index into ``DISSIPATIONS`` of each run; one μ makes falling laws Coulomb's."""
    damped = (scaled["damping1"] > 0) | (scaled["damping2"] > 0)
    apart = scaled["static_mu"] != scaled["mu"]
    laws = np.where(~apart & np.isin(laws, FALLING), COULOMB, laws)
    apart = apart | (laws != COULOMB)
    long1, long2 = (
        (scaled[name] > springs.LONG) & (not linear_springs) for name in ("length1", "length2")
    )
    law = sum(index * (laws == name) for index, name in enumerate(LAWS))
    return np.asarray(_CODES[law, damped * 1, apart * 1, long1 * 1, long2 * 1])


def _onset_mu(dissipation: np.ndarray, orders: np.ndarray) -> np.ndarray:
    """μ of slip as the sliding speed goes to 0."""
    found = np.empty(dissipation.shape)
    for code in np.unique(dissipation):
        rows = dissipation == code
        p = SimpleNamespace(**{name: orders[name][rows] for name in ("mu", *EXTENSIONS)})
        found[rows] = LAWS[DISSIPATIONS[code].law].coefficient(0.0, p)
    return found
