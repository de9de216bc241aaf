"""Datasets of systems in files, and two of them compared."""

import json

import numpy as np
import pytest
import xarray as xr

import squealpipe
from squealpipe.schema import SchemaError
from squealpipe.store.comparison.compare import compare_datasets
from squealpipe.store.comparison.differences import Agreement
from squealpipe.systems import schema as systems
from squealpipe.systems.shipped.belt_friction import leine_oscillator
from squealpipe.systems.shipped.impact_oscillator import impact_oscillator
from squealpipe.systems.shipped.mode_coupling import mode_coupling


@pytest.mark.parametrize(
    "make",
    [
        lambda: impact_oscillator.simulate(30.0, omega=1.2),
        lambda: leine_oscillator.ensemble(
            30.0, start={"x": np.linspace(0.0, 1.0, 3)}, horizon=True
        ),
        lambda: impact_oscillator.basin(50.0, start={"x": np.linspace(0.0, 1.0, 3)}),
        lambda: mode_coupling.simulate(3.0),  # no event
    ],
)
def test_a_dataset_of_a_system_is_kept_with_its_definition(make, tmp_path):
    dataset = make()
    squealpipe.save(dataset, tmp_path / "mine.nc")
    found = squealpipe.load(tmp_path / "mine.nc")
    xr.testing.assert_equal(found, dataset)
    assert any(key.startswith("d") for key in json.loads(found.attrs["system"]))


def test_runs_of_a_system_are_compared_variable_by_variable():
    a, b, c = (
        impact_oscillator.ensemble(30.0, start={"x": [0.0, 0.1]}, amplitude=amplitude)
        for amplitude in (0.5, 0.5, 0.6)
    )
    assert compare_datasets("x", a, b).verdict == Agreement.equal
    assert compare_datasets("x", a, c).verdict == Agreement.different


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.drop_vars("outcome"), "outcome is missing"),
        (lambda d: d.assign(count_impact=d.count_impact.isel(x0=0)), "has dims"),
        (lambda d: d.assign(outcome=d.outcome + 77), "flags .* that have no meaning"),
        (lambda d: d.assign(time_in_free=d.time_in_free * np.nan), "holds NaN"),
        (
            lambda d: d.assign(count_impact=d.count_impact.assign_attrs(units="m")),
            "units",
        ),
    ],
)
def test_a_dataset_of_a_system_that_does_not_fit_its_table_is_refused(change, message):
    dataset = impact_oscillator.ensemble(5.0, start={"x": [0.0, 0.1]})
    systems.check(dataset)
    with pytest.raises(SchemaError, match=message):
        systems.check(change(dataset))


def test_cycles_of_systems_fit_their_tables():
    cycle = impact_oscillator.limit_cycle(omega=2.6)
    assert systems.of_dataset(cycle).lookup("period").rtol == systems.CYCLE["rtol"]
    assert "event" in systems.of_dataset(cycle).lists
    with pytest.raises(SchemaError, match="speed is not part of the schema"):
        systems.check(cycle.assign(speed=1.0))
    with pytest.raises(SchemaError, match="x_path has dims"):
        systems.check(cycle.assign(x_path=cycle.x_path.isel(sample=0)))
    assert cycle.x_path.attrs["long_name"] == "x along the cycle"
    assert cycle.v_max.attrs["units"] == impact_oscillator.units["v"]
