"""Schemas of all datasets: names, dimensions, units, meanings and tolerances, each stated once.

Each room of the package holds the tables of what it makes in its ``schema``; a task imports its
own table and calls :func:`build`. :func:`find` gets a schema by name, for readers of files.
"""

import importlib
import pkgutil
from collections.abc import Iterator
from functools import cache

import xarray as xr

from squealpipe.systems.datasets import ABSENT as ABSENT
from squealpipe.systems.datasets import ANGLE_CONVENTION as ANGLE_CONVENTION
from squealpipe.systems.datasets import LINEAR_ENDS as LINEAR_ENDS
from squealpipe.systems.datasets import ORBIT_ENDS as ORBIT_ENDS
from squealpipe.systems.datasets import RUN_ENDS as RUN_ENDS
from squealpipe.systems.datasets import SYSTEM as SYSTEM
from squealpipe.systems.datasets import DatasetSchema as DatasetSchema
from squealpipe.systems.datasets import Outcome as Outcome
from squealpipe.systems.datasets import SchemaError as SchemaError
from squealpipe.systems.datasets import Variable as Variable
from squealpipe.systems.datasets import blank as blank
from squealpipe.systems.datasets import build as build
from squealpipe.systems.datasets import count as count
from squealpipe.systems.datasets import flag as flag
from squealpipe.systems.datasets import flag_table as flag_table
from squealpipe.systems.datasets import labels as labels
from squealpipe.systems.datasets import meanings as meanings
from squealpipe.systems.datasets import or_nan as or_nan
from squealpipe.systems.datasets import outcome as outcome
from squealpipe.systems.datasets import text as text
from squealpipe.systems.datasets import validate as validate
from squealpipe.systems.datasets import whether as whether
from squealpipe.systems.inputs.words import nearest


def find(name: str) -> DatasetSchema:
    """The schema of that name, from the tables of all rooms."""
    schemas = all_schemas()
    if name in schemas:
        return schemas[name]
    # schemas in these modules follow from their names, since they depend on what was swept
    derived = (
        "squealpipe.study.schema.sweep",
        "squealpipe.structures.schema.structures",
    )
    for module in derived:
        derive = importlib.import_module(module).derived
        if (schema := derive(name)) is not None:
            return schema  # type: ignore[no-any-return]
    near = nearest(name, schemas)
    raise SchemaError(
        f"no schema {name!r}" + (f"; did you mean {near!r}?" if near else "")
    )


def schema_of(dataset: xr.Dataset) -> DatasetSchema:
    """The schema that a dataset states; of a system, with the names that the dataset has."""
    name = str(dataset.attrs.get("schema"))
    if "schema" not in dataset.attrs:
        raise SchemaError(
            "the dataset states no schema, so it is not one of this package, or an operation has "
            "dropped its attributes; keep them, as with xr.set_options(keep_attrs=True), or write "
            "it by dataset.to_netcdf(path), which `squealpipe plot` and `convert` read, too"
        )
    if not name.startswith(SYSTEM):
        return find(name)
    systems = importlib.import_module("squealpipe.systems.schema")
    return systems.of_dataset(dataset)  # type: ignore[no-any-return]


@cache
def all_schemas() -> dict[str, DatasetSchema]:
    """Every schema of the package by name."""
    schemas = {}
    for name in _modules_of_schemas():
        table = importlib.import_module(name)
        for value in vars(table).values():
            for schema in value if isinstance(value, tuple) else (value,):
                if isinstance(schema, DatasetSchema):
                    schemas[schema.name] = schema
    return schemas


def _modules_of_schemas() -> Iterator[str]:
    """Names of the modules ``schema`` of the rooms, and of those below them."""
    # packages that hold the schemas of the datasets that they make, in their module schema
    rooms = (
        "systems",
        "vibration",
        "brake",
        "structures",
        "benchmark",
        "study",
        "paper",
    )
    for room in rooms:
        package = importlib.import_module(f"squealpipe.{room}.schema")
        yield package.__name__
        below = pkgutil.walk_packages(
            getattr(package, "__path__", ()), f"{package.__name__}."
        )
        yield from (module.name for module in below)
