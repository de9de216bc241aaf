"""The tables of datasets: complete, consistent, and every fault of a dataset told at once."""

import subprocess
import sys
from enum import IntEnum

import numpy as np
import pytest

from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    SchemaError,
    Variable,
    all_schemas,
    build,
    find,
    flag_table,
    outcome,
    validate,
)

SCHEMAS = all_schemas()


Colour = IntEnum("Colour", "red green", start=0)


TABLE = DatasetSchema(
    name="probe",
    title="Probe",
    coordinates={"t": Variable(dims=("t",), units="s", long_name="time")},
    variables={
        "x": Variable(dims=("t",), units="m", long_name="place"),
        "gap": Variable(dims=("t",), units="m", long_name="gap", nan_allowed=True),
        "colour": Variable(dims=("t",), dtype="i1", flags=Colour, long_name="colour"),
        "label": Variable(dims=("t",), dtype="U8", long_name="label", optional=True),
        "outcome": outcome("t"),
    },
)
GOOD = {"x": [1.0, 2.0], "gap": [np.nan, 0.0], "colour": [0, 1], "outcome": [0, 1]}
T = {"t": [0.0, 1.0]}


def test_built_dataset_is_labelled():
    made = build(TABLE, GOOD, T, {"model": "A1"})
    assert made.x.attrs == {"long_name": "place", "units": "m"}
    assert made.colour.attrs["flag_meanings"] == "red green"
    assert made.colour.attrs["flag_values"].dtype == made.colour.dtype == np.int8
    assert made.attrs["schema"] == "probe"
    assert made.attrs["model"] == "A1"
    validate(made, TABLE)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"colour": [0, 7]}, "colour holds flags \\[7\\] that have no meaning"),
        ({"x": [np.nan, 0.0]}, "x holds NaN; give the reason in an outcome variable"),
        ({"speed": [1.0, 2.0]}, "unknown variable speed"),
        ({"x": None}, "x is missing"),
        ({"x": ["far", "near"]}, "probe: x: could not convert"),
        ({"x": [1j, 0.0]}, "probe: x: .*complex"),
        ({"x": [[1.0, 2.0]]}, "probe: x: dimensions"),
        ({"colour": [0, 256]}, "probe: colour: .*out of bounds"),
        ({"colour": [np.nan, 1.0]}, "probe: colour: cannot convert float NaN"),
    ],
)
def test_faulty_data_are_refused(change, message):
    data = {
        name: values
        for name, values in {**GOOD, **change}.items()
        if values is not None
    }
    with pytest.raises(SchemaError, match=message):
        build(TABLE, data, T)


def test_datasets_share_no_attributes():
    first, second = build(TABLE, GOOD, T), build(TABLE, GOOD, T)
    first.colour.attrs["flag_values"][0] = 9
    first.x.attrs["units"] = "mm"
    assert second.colour.attrs["flag_values"].tolist() == [0, 1]
    assert second.x.attrs["units"] == "m"


def test_all_faults_are_told_at_once():
    made = build(TABLE, GOOD, T).drop_vars("gap").assign(extra=1.0)
    made["x"] = made.x.astype(int)
    with pytest.raises(SchemaError) as caught:
        validate(made.assign_attrs(schema_version=7), TABLE)
    for part in (
        "version is 7",
        "gap is missing",
        "x has dtype int",
        "extra is not part of",
    ):
        assert part in str(caught.value)


def test_every_outcome_says_what_to_do():
    assert all(outcome.remedy for outcome in Outcome)
    assert sorted(Outcome) == list(range(len(Outcome)))
    with pytest.raises(SchemaError, match=r"did you mean 'stability_map'"):
        find("stabilty_map")


@pytest.mark.parametrize("name", sorted(SCHEMAS))
def test_schema_is_complete_and_a_dataset_of_zeros_can_be_made_from_it(name):
    schema = SCHEMAS[name]
    assert schema.name == name
    assert schema.title
    assert not set(schema.variables) & set(schema.coordinates)
    for variable, entry in {**schema.variables, **schema.coordinates}.items():
        where, kind = f"{name}.{variable}", np.dtype(entry.dtype).kind
        assert entry.long_name, f"{where} has no long_name"
        assert min(entry.rtol, entry.atol) >= 0, where
        if entry.flags is not None:
            table = flag_table(entry.flags)
            assert len(set(table.values())) == len(table), where
            assert all(" " not in meaning for meaning in table.values()), where
            assert kind == "i", where
        assert kind == "f" or not entry.nan_allowed, where

    def zeros(entries):
        made = {}
        for variable, entry in entries.items():
            fill = 0 if entry.flags is None else min(flag_table(entry.flags))
            fill = "a" if np.dtype(entry.dtype).kind in "US" else fill
            made[variable] = np.full([2] * len(entry.dims), fill, entry.dtype)
        return made

    made = build(schema, zeros(schema.variables), zeros(schema.coordinates))
    assert made.attrs["schema"] == name


def test_reading_a_dataset_loads_no_heavy_library():
    """Every job looks for its schema in all tables: what one of them imports costs all jobs."""
    code = (
        "import sys; from squealpipe.schema import all_schemas; all_schemas(); "
        "print(*{name.split('.')[0] for name in sys.modules} & {'scipy', 'heyoka', 'numba'})"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert run.stdout.split() == []
