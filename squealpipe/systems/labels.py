"""Parts that all datasets of systems share: labels, flags, and the record of the system."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from squealpipe.systems.datasets import OWN_NAMES, SYSTEM, Outcome, flag_table, in_words
from squealpipe.systems.datasets.versions import versions
from squealpipe.systems.taylor import layout
from squealpipe.systems.tracing import TracedSystem as System


def labels(long_name: str, units: str) -> dict[str, str]:
    """Attributes of a variable."""
    return {"long_name": long_name, "units": units}


def flag(long_name: str, dims: Any, values: Any, table: Mapping[int, str]) -> Any:
    """A flag variable: dimensions, values and the names of its values."""
    attributes = {
        "long_name": long_name,
        "flag_values": np.array(list(table), np.int16),
        "flag_meanings": " ".join(name.replace(" ", "_") for name in table.values()),
    }
    return dims, np.asarray(values, np.int16), attributes


def named(long_name: str, dims: Any, values: Any, table: Mapping[int, str]) -> Any:
    """A flag variable whose values, from 0 on, have the names that the system gives them."""
    dims, values, attributes = flag(long_name, dims, values, table)
    own = {value: name for value, name in table.items() if value >= 0}
    return dims, values, attributes | _own(own)


def _own(table: Mapping[int, str]) -> dict[str, str]:
    """The attribute that holds names of a system's own, if there are any."""
    if not table:
        return {}
    return {OWN_NAMES: " ".join(name.replace(" ", "_") for name in table.values())}


def regime_flag(
    system: System, long_name: str, dims: tuple[str, ...], regimes: np.ndarray
) -> Any:
    """The flag variable of regimes (…, components); over ``component`` where there are several."""
    names = dict(enumerate(system.regimes))
    if (np.asarray(regimes) < 0).any():
        names[-1] = "not_reached"  # instants after the end of a run
    if len(system.composition.names) == 1:
        return named(long_name, dims, np.asarray(regimes)[..., 0], names)
    return named(f"{long_name} of each component", (*dims, "component"), regimes, names)


def components_of(system: System) -> dict[str, Any]:
    """The coordinate of a system's components, if there are several."""
    names = system.composition.names
    if len(names) == 1:
        return {}
    return {"component": ("component", list(names), {"long_name": "component"})}


def outcome(system: System, dims: Any, values: Any) -> Any:
    """The flag variable that says how runs ended."""
    return explained(system, "how the run ended", dims, values, flag_table(Outcome))


def explained(
    system: System, long_name: str, dims: Any, values: Any, table: Mapping[int, str]
) -> Any:
    """A flag variable of outcomes and of the system's own stops, with what each means and helps."""
    stops = {layout.outcomes.stopped + i: name for i, name in enumerate(system.stops)}
    table = {**table, **stops}
    dims, values, attributes = flag(long_name, dims, values, table)
    return dims, values, attributes | {"comment": in_words(table)} | _own(stops)


def attributes_of(
    system: System, what: str, given: Mapping[str, float], tol: float
) -> dict[str, Any]:
    """Return the attributes that record a dataset's system and run."""
    return {
        "title": f"{system.name}: {what}",
        "schema": SYSTEM + what,
        "schema_version": 1,
        "system": json.dumps(system.text),
        "parameters": json.dumps(dict(given)),
        "tolerance": tol,
        "method": "Taylor series with located events",
        "package_version": versions()["package_version"],
    }
