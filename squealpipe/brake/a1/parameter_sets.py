"""The parameters of many runs of A1, checked, and the system that each run is of."""

from collections.abc import Mapping
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from squealpipe.brake.a1.motion_system import brake, brake_of, has_own_laws
from squealpipe.brake.models.refusals import WHY_A4
from squealpipe.laws.contact_laws import LINEAR
from squealpipe.laws.friction_laws import COULOMB, FALLING, LAWS, coefficient
from squealpipe.laws.springs import LONG_SPRING
from squealpipe.laws.tables import is_table
from squealpipe.parameters import DEFAULTS, NUMBERS_OF_A1, PHYSICAL, TABLE, Parameters
from squealpipe.systems.inputs.values import brief
from squealpipe.systems.inputs.words import suggestion
from squealpipe.systems.system import System
from squealpipe.validation import real_array


class ParameterSets(NamedTuple):
    """Parameters of some runs in SI units, of the shapes that they were given in.

    Attributes:
        numbers: those that the systems read, by their names there.
        systems, which: A1, or its variant, with the forces of some runs, and the index of that of
            each.
    """

    numbers: dict[str, np.ndarray]
    systems: tuple[System, ...]
    which: np.ndarray


def parameter_sets(
    parameters: Parameters | Mapping[str, Any], model: str
) -> ParameterSets:
    """Return the parameters of runs, and the systems that these are of.

    Raises:
        ValueError: a parameter or law that does not exist, that the model cannot carry, or that
            must be the same for all runs.
    """
    if isinstance(parameters, Parameters):
        return _one_set(parameters, model)
    friction, contact = laws = [
        parameters.get(name, DEFAULTS[name]) for name in ("friction_law", "contact_law")
    ]
    if not all(isinstance(law, str) for law in laws) or (
        friction in LAWS and contact == LINEAR
    ):
        arrays = _parameter_arrays(parameters)
        formulas = np.isin(arrays["friction_law"], list(LAWS)) & (
            arrays["contact_law"] == LINEAR
        )
        if not formulas.all():
            raise ValueError(
                "a table, a law in Python or a contact law must be the same for all runs"
            )
        numbers = _numbers(arrays)
        return ParameterSets(numbers, *_systems(arrays["friction_law"], numbers, model))
    return _sets_of_own_laws(parameters, friction, contact, model)


@lru_cache(maxsize=64)
def _one_set(parameters: Parameters, model: str) -> ParameterSets:
    """Return one set of parameters, which was checked when it was made; for many single runs."""
    numbers = {
        name: np.asarray(getattr(parameters, name) + 0.0) for name in NUMBERS_OF_A1
    }
    system = _system_of(parameters, model)
    return ParameterSets(numbers, (system,), np.zeros((), int))


def _sets_of_own_laws(
    parameters: Mapping[str, Any], friction: str, contact: str, model: str
) -> ParameterSets:
    """Return the parameters of runs that share laws of the user's own."""
    if is_table(contact) and np.ptp(parameters.get("preload", 0.0)):
        raise ValueError(
            "preload: under a table of contact it must be the same for all runs"
        )
    # the form of the system is that of the largest numbers: with dashpots if any run has one
    numbers_of_the_form = ("preload", "length1", "length2", "damping1", "damping2")
    largest: dict[str, Any] = {
        name: float(np.max(parameters[name]))
        for name in numbers_of_the_form
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
    arrays = _parameter_arrays({**parameters, **numbers, "contact_law": LINEAR})
    if friction not in LAWS:
        _check_stick(decisive, arrays)
    system = _system_of(decisive, model)
    return ParameterSets(_numbers(arrays), (system,), np.zeros((), int))


def _check_stick(decisive: Parameters, arrays: Mapping[str, np.ndarray]) -> None:
    """Raise for static coefficients below a law's own at speed 0."""
    onset = coefficient(0.0, SimpleNamespace(**vars(decisive) | {"mu": arrays["mu"]}))
    if np.any(arrays["mu_static"] < onset * (1.0 - 1e-12)):
        raise ValueError(
            "mu_static is below the law's coefficient at speed 0: leave it out"
        )


def _system_of(parameters: Parameters, model: str) -> System:
    """Return the system of one set of parameters; raise where the model has none."""
    carries = model == "A1" or (
        model == "A1-no-separation" and parameters.contact_law == LINEAR
    )
    if carries or not has_own_laws(parameters):
        return brake_of(parameters, model)
    known: dict[str, Any] = {"friction_law": LAWS, "contact_law": (LINEAR,)}
    own = ", ".join(
        f"{name} = {brief(law)}"
        for name in known
        if (law := getattr(parameters, name)) not in known[name]
    )
    raise ValueError(f"model = {model!r} cannot carry {own}; use model = 'A1'")


def _numbers(arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the numbers that the systems read by their names there."""
    named = {**arrays, "static_mu": arrays["mu_static"]}
    # adding 0 makes −0 to 0: equal parameters have equal bits
    return {name: named[name] + 0.0 for name in NUMBERS_OF_A1}


def _systems(
    laws: np.ndarray, numbers: Mapping[str, np.ndarray], model: str
) -> tuple[tuple[System, ...], np.ndarray]:
    """Return the systems of some runs, and which is whose.

    One coefficient for stick and slip makes falling laws Coulomb's.
    """
    damped = (numbers["damping1"] > 0) | (numbers["damping2"] > 0)
    one_mu = numbers["static_mu"] == numbers["mu"]
    falling = np.isin(laws, FALLING)
    if falling.any():  # else there would be a text for each run to sort
        laws = np.where(one_mu & falling, COULOMB, laws)
    with np.errstate(over="ignore"):
        long = LONG_SPRING * numbers["preload"]
    forms = np.broadcast_arrays(
        laws,
        damped,
        one_mu & (laws == COULOMB),
        *(numbers[name] > long for name in ("length1", "length2")),
    )
    _, code = np.unique(laws, return_inverse=True)
    code = code.reshape(laws.shape)
    for form in forms[1:]:
        code = 2 * code + form
    if not code.size:
        return (brake(model=model, one_mu=True),), code
    _, first, which = np.unique(code, return_index=True, return_inverse=True)
    systems = []
    for at in first:
        law, damps, same, *are_long = (form.reshape(-1)[at].item() for form in forms)
        if model == "A4" and (law != COULOMB or damps or not same):
            raise ValueError(
                f"model A4 carries no damping and Coulomb's law with one μ: {WHY_A4}"
            )
        springs_long = (are_long[0], are_long[1])
        systems.append(
            brake(
                law, damped=damps, model=model, one_mu=same, long_springs=springs_long
            )
        )
    return tuple(systems), which.reshape(forms[0].shape)


def _parameter_arrays(parameters: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Return checked arrays of all parameters; ``mu_static`` of None becomes ``mu``."""
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
