"""Distributions of uncertain parameters, from their words in the configuration."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy

from squealpipe.inputs import ANGLES
from squealpipe.laws.friction_laws import COULOMB, FALLING
from squealpipe.parameters import Parameters
from squealpipe.ranges import NUMERIC_PARAMETERS
from squealpipe.systems.inputs.values import brief, is_finite_number
from squealpipe.systems.inputs.words import suggestion

DISTRIBUTIONS: dict[str, tuple[str, str]] = {
    "uniform": ("low", "high"),
    "normal": ("mean", "std"),
    "lognormal": ("median", "log_std"),
}
"""Distribution → its two numbers."""


def distribution(name: str, given: Mapping[str, Any]) -> Any:
    """A frozen scipy distribution of one parameter."""
    if not isinstance(name, str) or name not in (*ANGLES, *NUMERIC_PARAMETERS):
        raise ValueError(
            f"{name}: no parameter or angle; {suggestion(name, (*ANGLES, *NUMERIC_PARAMETERS))}"
        )
    if not isinstance(given, Mapping):
        raise ValueError(  # noqa: TRY004
            f"{name} = {brief(given)}: a mapping is needed, such as "
            "{'distribution': 'uniform', 'low': ..., 'high': ...}"
        )
    kind = given.get("distribution")
    if not isinstance(kind, str) or kind not in DISTRIBUTIONS:
        raise ValueError(
            f"{name}: distribution = {kind!r}: one of {', '.join(DISTRIBUTIONS)} is needed"
        )
    first, second = DISTRIBUTIONS[kind]
    if set(given) != {"distribution", first, second}:
        raise ValueError(
            f"{name}: a {kind} distribution needs {first} and {second} alone"
        )
    for key in (first, second):
        if not is_finite_number(given[key]):
            raise ValueError(
                f"{name}: {key} = {given[key]!r}: a finite number is needed"
            )
    frozen = _frozen(name, kind, given[first], given[second])
    if name not in ANGLES:
        _check_support(name, kind, frozen)
    return frozen


def _frozen(name: str, kind: str, first: float, second: float) -> Any:
    if kind == "uniform":
        if not first < second:
            raise ValueError(f"{name}: low = {first!r} must be below high = {second!r}")
        return scipy.stats.uniform(first, second - first)
    if not second > 0:
        raise ValueError(
            f"{name}: {DISTRIBUTIONS[kind][1]} = {second!r}: a number above 0 is needed"
        )
    if kind == "normal":
        # in standard deviations: a normal distribution without ends would now and then draw a
        # negative stiffness
        cut_off = 4.0
        return scipy.stats.truncnorm(-cut_off, cut_off, loc=first, scale=second)
    if not first > 0:
        raise ValueError(f"{name}: median = {first!r}: a number above 0 is needed")
    return scipy.stats.lognorm(second, scale=first)


def _check_support(name: str, kind: str, frozen: Any) -> None:
    for end in frozen.support():
        if not np.isfinite(end):
            continue
        try:
            # of its own: how mu_static stands to mu is seen when both are known, and the laws
            # are those that read every parameter
            reader = Parameters(friction_law=FALLING[0], contact_law="dashpot")
            reader.with_(**{name: float(end) or 1e-300})
        except ValueError as error:
            raise ValueError(
                f"{name}: the {kind} distribution reaches {end:g}, which is not allowed: {error}"
            ) from error


def check_stick(params: Parameters, frozen: Mapping[str, Any]) -> None:
    """Stop distributions that let static friction be below that of sliding with Coulomb's law."""
    if params.friction_law != COULOMB or (
        "mu_static" not in frozen and params.mu_static is None
    ):
        return
    least = (
        frozen["mu_static"].support()[0] if "mu_static" in frozen else params.static_mu
    )
    most = frozen["mu"].support()[1] if "mu" in frozen else params.mu
    if least < most:
        raise ValueError(
            f"mu_static reaches {least:g} and mu {most:g}: with the Coulomb law mu_static must be "
            "mu or greater in all of the sample"
        )


def centred(
    params: Parameters, alpha1: float, alpha2: float
) -> dict[str, dict[str, Any]]:
    """Distributions around a study's own parameters, for those who configure none.

    Springs within 5 % and the contact spring within 10 % (standard deviation), friction between a
    third and three times its own, angles within 0.05 rad; what a table stands for is not spread.
    """
    normal = {"distribution": "normal"}
    by_parameter: dict[str, dict[str, Any]] = {
        "k1": {**normal, "mean": params.k1, "std": 0.05 * params.k1},
        "k2": {**normal, "mean": params.k2, "std": 0.05 * params.k2},
        "k3": {"distribution": "lognormal", "median": params.k3, "log_std": 0.1},
        "mu": {
            "distribution": "uniform",
            "low": params.mu / 3,
            "high": 3 * params.mu or 0.1,
        },
        "alpha1": {**normal, "mean": alpha1, "std": 0.05},
        "alpha2": {**normal, "mean": alpha2, "std": 0.05},
    }
    return {
        name: given
        for name, given in by_parameter.items()
        if name not in params.in_laws
    }
