"""The appendix of shares and fits: errors that cover, areas and lines that are known."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from squealpipe.methods.survival import survival
from squealpipe.parameters import Parameters
from squealpipe.schema import build
from squealpipe.schema.dynamics.runs import VALIDITY_MAP
from squealpipe.study.claims.evidence import Run
from squealpipe.study.report.facts.sampling import sampling
from squealpipe.tasks.linear.maps import quasi_static_map, stability_map

ANGLES = np.linspace(0.0, np.pi, 81)


def rows_of(**datasets: xr.Dataset) -> dict[str, dict[str, object]]:
    found = sampling(Run(Parameters(), datasets))["rows"]
    assert all(row["dataset"] in datasets for row in found)
    return {str(row["name"]): row for row in found}


def validity(separates: np.ndarray) -> xr.Dataset:
    shape = separates.shape
    return build(
        VALIDITY_MAP,
        {
            "first_separation_time": np.where(separates, 1.0, np.nan),
            "separates": separates,
            "regime_linear": np.zeros(shape),
            "response_growth": np.where(separates, np.nan, 1.0),
            "t_end": 200.0,
            "outcome": np.where(separates, 1, 0),
        },
        {"alpha1": ANGLES, "alpha2": ANGLES},
    )


def test_the_error_of_an_area_covers_a_known_one() -> None:
    """Half of the map and a quarter disc, whose areas are known."""
    first, second = ANGLES[:, None] + 0 * ANGLES, ANGLES + 0 * ANGLES[:, None]
    for cells, area in (
        (first < np.pi / 2, 0.5),
        (first**2 + second**2 < (0.8 * np.pi) ** 2, 0.16 * np.pi),
    ):
        row = rows_of(validity_map=validity(cells))["A1 loses contact (F7a)"]
        assert row["sample"] == 81 * 81
        assert row["value"] == cells.mean()
        assert row["low"] <= area + 0.01
        assert area - 0.01 <= row["high"]
        assert row["high"] - row["low"] < 0.03


def test_areas_of_the_linear_maps_against_a_finer_grid() -> None:
    params = Parameters()
    fine = np.linspace(0.0, np.pi, 641)
    stability = stability_map(params, fine, fine)
    rows = rows_of(
        stability_map=stability_map(params, ANGLES, ANGLES),
        quasi_static_map=quasi_static_map(params, ANGLES, ANGLES),
    )
    exact = float((stability.regime_linear > 0).mean())
    assert rows["A3 unstable"]["value"] == pytest.approx(exact, abs=0.003)
    split = 2.0 * np.cos(fine[:, None] + fine) * np.cos(fine[:, None] - fine)
    turned = rows["order of the directions turns over at separation (C1)"]
    assert turned["value"] == pytest.approx(((split > 0) & (split < params.k3)).mean(), abs=0.02)


def whirl(speeds: np.ndarray, sizes: np.ndarray) -> xr.Dataset:
    fitted = ("belt_speed", np.ones(speeds.size, np.int8))
    return xr.Dataset(
        {"fitted": fitted, "amplitude": ("belt_speed", sizes)}, {"belt_speed": speeds}
    )


def test_the_interval_of_a_fit_covers_the_line_behind_it() -> None:
    generator = np.random.default_rng(4)
    speeds = np.geomspace(5.0, 300.0, 20)
    covered = 0
    for _ in range(100):
        sizes = (5.0 + 0.75 * speeds) * (1 + 0.01 * generator.standard_normal(20))
        row = rows_of(whirl=whirl(speeds, sizes))["slope of the whirl's size against |V|"]
        covered += row["low"] <= 0.75 <= row["high"]
    assert 85 <= covered <= 100
    row = rows_of(whirl=whirl(speeds, 5.0 + 0.75 * speeds))["slope of the whirl's size against |V|"]
    assert row["value"] == pytest.approx(0.75, rel=1e-9)
    assert row["of"] == "belt speeds from 5 to 300 m/s"


def test_a_run_without_datasets_has_no_rows() -> None:
    assert rows_of() == {}


def test_the_interval_of_a_median_covers_the_one_behind_it() -> None:
    """Exponential lifetimes, the long ones cut off as the horizon does."""
    generator = np.random.default_rng(9)
    covered = 0
    for _ in range(100):
        lifetimes = generator.exponential(1.0, 200)
        lifetimes[lifetimes > 3.0] = np.nan
        ended = np.isfinite(lifetimes)
        median = survival(np.where(ended, lifetimes, 3.0), ended).median()
        dataset = xr.Dataset(
            {
                "shown_lifetime": ("shown_sample", lifetimes),
                "median_lifetime": ("estimate", list(median)),
            }
        )
        row = rows_of(transient=dataset)["median lifetime in the scene of Fig. 4"]
        covered += row["low"] <= np.log(2.0) <= row["high"]
    assert 90 <= covered <= 100


def test_without_enough_ended_runs_there_is_no_median() -> None:
    dataset = xr.Dataset({"shown_lifetime": ("shown_sample", np.full(20, np.nan))})
    rows = rows_of(transient=dataset)
    assert list(rows) == ["runs of Fig. 4 that end in the whirl before the horizon"]
    assert next(iter(rows.values()))["value"] == 0.0
