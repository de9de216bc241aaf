"""A1 as a system, and the parameters of its runs in units of m = k1 = l_pre = 1."""

import math
import re
from collections.abc import Mapping
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from squealpipe.brake.a1.motion_system import brake, brake_of, has_own_laws
from squealpipe.brake.models.refusals import WHY_A4
from squealpipe.laws import springs
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction_laws import COULOMB, FALLING, LAWS, coefficient
from squealpipe.laws.tables import is_table
from squealpipe.parameters import DEFAULTS, NUMBERS_OF_A1, TABLE, Parameters
from squealpipe.systems.inputs.values import brief
from squealpipe.systems.system import System
from squealpipe.text import suggestion
from squealpipe.validation import real_array

PHYSICAL = tuple(name for name, row in TABLE.items() if row.enters_a1)
"""Parameters of a run of A1."""
FORM = ("preload", "length1", "length2", "damping1", "damping2")
"""Numbers on which the form of a system with laws of the user's own depends."""


class ScaledRuns(NamedTuple):
    """Parameters in units of m = k1 = l_pre = 1, of the shape that they were given in.

    Attributes:
        time_unit, length: √(m/k1), s, and l_pre, m.
        systems: A1, or its variant, with the forces that some run has.
        rate: a bound on the frequencies of the motion, for limits of steps and events.
    """

    numbers: dict[str, np.ndarray]
    time_unit: np.ndarray
    length: np.ndarray
    systems: tuple[System, ...]
    which: np.ndarray
    rate: np.ndarray


def scaled_runs(parameters: Parameters | Mapping[str, Any], model: str) -> ScaledRuns:
    """Checked parameters in the engine's units, and the systems that they are of."""
    if isinstance(parameters, Parameters):
        return _scaled_once(parameters, model)
    friction, contact = laws = [
        parameters.get(name, DEFAULTS[name]) for name in ("friction_law", "contact_law")
    ]
    if not all(isinstance(law, str) for law in laws) or (
        friction in LAWS and contact == LINEAR
    ):
        return _scaled(_parameter_arrays(parameters), model)
    if is_table(contact) and np.ptp(parameters.get("preload", 0.0)):
        raise ValueError(
            "preload: under a table of contact it must be the same for all runs"
        )
    # the form of the system is that of the largest numbers: with dashpots if any run has one
    largest: dict[str, Any] = {
        name: float(np.max(parameters[name]))
        for name in FORM
        if np.size(parameters.get(name, ()))
    }
    if friction in FALLING:
        largest |= {"mu": 0.0, "mu_static": 1.0}
    elif friction == COULOMB:
        largest["mu_static"] = 1.0
    decisive = Parameters(**largest, friction_law=friction, contact_law=contact)
    numbers = {name: getattr(decisive, name) for name in decisive.in_laws}
    if is_table(friction):
        numbers["mu_static"] = decisive.static_mu
    elif friction not in LAWS and parameters.get("mu_static") is None:
        mu = real_array("mu", parameters.get("mu", DEFAULTS["mu"]))
        numbers["mu_static"] = coefficient(
            0.0, SimpleNamespace(**vars(decisive) | {"mu": mu})
        )
    if friction not in LAWS:
        numbers["friction_law"] = FALLING[0]
    given = _parameter_arrays({**parameters, **numbers, "contact_law": LINEAR})
    if friction not in LAWS:
        _check_stick(decisive, given)
    return _scaled(given, (_own_system(decisive, model),))


def _check_stick(decisive: Parameters, given: Mapping[str, np.ndarray]) -> None:
    """Stop static coefficients below a law's own at speed 0."""
    onset = coefficient(0.0, SimpleNamespace(**vars(decisive) | {"mu": given["mu"]}))
    if np.any(given["mu_static"] < onset * (1.0 - 1e-12)):
        raise ValueError(
            "mu_static is below the law's coefficient at speed 0: leave it out"
        )


@lru_cache(maxsize=64)
def _scaled_once(parameters: Parameters, model: str) -> ScaledRuns:
    """One set of parameters, which was checked when it was made; for many single runs."""
    numbers = plain(parameters)
    given = {name: np.asarray(getattr(numbers, name)) for name in PHYSICAL}
    given["mu_static"] = np.asarray(numbers.static_mu)
    if numbers is parameters:
        return _scaled(given, model)
    given["damping3"] = np.asarray(parameters.damping3)
    return _scaled(given, (_own_system(parameters, model),))


def _own_system(parameters: Parameters, model: str) -> System:
    if model == "A1" or (
        model == "A1-no-separation" and parameters.contact_law == LINEAR
    ):
        return brake_of(parameters, model)
    known: dict[str, Any] = {"friction_law": LAWS, "contact_law": (LINEAR,)}
    own = ", ".join(
        f"{name} = {brief(law)}"
        for name in known
        if (law := getattr(parameters, name)) not in known[name]
    )
    raise ValueError(f"model = {model!r} cannot carry {own}; use model = 'A1'")


def plain(parameters: Parameters) -> Parameters:
    """The numbers that a law of the user's own stands for, under laws that have formulas."""
    if not has_own_laws(parameters):
        return parameters
    numbers = {
        name: getattr(parameters, name) for name in ("mu", "k3", "friction_speed")
    }
    return parameters.with_(
        **numbers,
        mu_static=parameters.static_mu,
        friction_law=FALLING[0],
        contact_law=LINEAR,
        damping3=0.0,
    )


def _scaled(
    given: Mapping[str, np.ndarray], form: str | tuple[System, ...]
) -> ScaledRuns:
    """Of a model, or of a system that is known."""
    # Units of time that overflow are refused with the runs.
    with np.errstate(all="ignore"):
        time_unit = np.sqrt(given["mass"] / given["k1"])
        # adding 0 makes −0 to 0: equal parameters have equal bits
        numbers = {
            name: given[of]
            / unit_value(TABLE[of].units, given["mass"], given["k1"], given["preload"])
            + 0.0
            for name, of in NUMBERS_OF_A1.items()
        }
        formulas = np.isin(given["friction_law"], list(LAWS)) & (
            given["contact_law"] == LINEAR
        )
        if not formulas.all():
            raise ValueError(
                "a table, a law in Python or a contact law must be the same for all runs"
            )
        systems, which = form, np.zeros((), int)
        if isinstance(systems, str):
            systems, which = _systems(given["friction_law"], numbers, systems)
        shape = np.broadcast_shapes(*{array.shape for array in given.values()})
        rate = np.sqrt(1 + numbers["k2"] + numbers["k3"]) + np.abs(
            numbers["belt_speed"]
        ) / np.minimum(numbers["length1"], numbers["length2"])
    time_unit, length, which = (
        np.broadcast_to(a, shape) for a in (time_unit, given["preload"], which)
    )
    return ScaledRuns(numbers, time_unit, length, systems, which, np.asarray(rate))


def _systems(
    laws: np.ndarray, numbers: Mapping[str, np.ndarray], model: str
) -> tuple[tuple[System, ...], np.ndarray]:
    """The systems of some runs, and which is whose; one μ makes falling laws Coulomb's."""
    damped = (numbers["damping1"] > 0) | (numbers["damping2"] > 0)
    one_mu = numbers["static_mu"] == numbers["mu"]
    laws = np.where(one_mu & np.isin(laws, FALLING), COULOMB, laws)
    forms = np.broadcast_arrays(
        laws,
        damped,
        one_mu & (laws == COULOMB),
        *(numbers[name] > springs.LONG_SPRING for name in ("length1", "length2")),
    )
    code = sum(
        np.unique(each, return_inverse=True)[1].reshape(each.shape) * 8**i
        for i, each in enumerate(forms)
    )
    if not code.size:
        return (brake(model=model, one_mu=True),), code
    _, first, which = np.unique(code, return_index=True, return_inverse=True)
    systems = []
    for at in first:
        law, damps, same, *long = (each.reshape(-1)[at].item() for each in forms)
        if model == "A4" and (law != COULOMB or damps or not same):
            raise ValueError(
                f"model A4 carries no damping and Coulomb's law with one μ: {WHY_A4}"
            )
        springs_long = (long[0], long[1])
        systems.append(
            brake(
                law, damped=damps, model=model, one_mu=same, long_springs=springs_long
            )
        )
    return tuple(systems), which.reshape(forms[0].shape)


def unit_value(unit: str, mass: np.ndarray, k1: np.ndarray, length: np.ndarray) -> Any:
    """A unit such as "N s m-1" in terms of m, k1 and l_pre; a newton is the unit k1 l_pre."""
    powers = {"kg": 0, "N": 0, "m": 0, "s": 0}
    for base, power in re.findall(r"([A-Za-z]+)(-?\d*)", unit):
        powers[base] += int(power or 1)
    powers["m"] += powers["N"]
    bases = {"kg": mass, "N": k1, "m": length, "s": np.sqrt(mass / k1)}
    above, below = (
        math.prod(
            bases[base] ** abs(power)
            for base, power in powers.items()
            if power * sign > 0
        )
        for sign in (1, -1)
    )
    return above / below


def _parameter_arrays(parameters: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Checked arrays of all parameters of a run; ``mu_static`` of None becomes ``mu``."""
    for name in parameters:
        if name not in TABLE:
            raise ValueError(
                f"unknown parameter {name!r}; {suggestion(name, PHYSICAL)}"
            )
    given = {name: parameters.get(name, DEFAULTS[name]) for name in PHYSICAL}
    if given["mu_static"] is None:
        given["mu_static"] = given["mu"]
    arrays = {name: _checked(name, values) for name, values in given.items()}
    weak = (arrays["friction_law"] == COULOMB) & (arrays["mu_static"] < arrays["mu"])
    if np.any(weak):
        raise ValueError(
            "mu_static is below mu with the Coulomb law: give mu or greater, or None"
        )
    return arrays


def _checked(name: str, values: Any) -> np.ndarray:
    row = TABLE[name]
    if row.allowed == "law":
        for law in np.unique(np.asarray(values, dtype=object).astype(str)):
            row.check(name, str(law))
        return np.asarray(values, dtype=str)
    array = real_array(name, values)
    if array.size:  # the least is refused if any is
        row.check(name, float(array.min()))
    return array
