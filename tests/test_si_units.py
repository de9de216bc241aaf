"""A brake in SI units gets the answers of the same brake in units of its own, without options."""

import numpy as np
import pytest

import squealpipe as sp
from squealpipe.cli import run
from tests.calls import CALLS, A, B

SI = sp.Parameters(
    mass=0.5,
    k1=1e7,
    k2=1e7,
    k3=7e6,
    mu=0.3,
    belt_speed=5.0,
    preload=1e-3,
    length1=0.05,
    length2=0.05,
    sigma=1e6,
)
TIME, LENGTH, FORCE = SI.time_unit, SI.preload, SI.k1 * SI.preload
UNIT = sp.Parameters(
    mass=1.0,
    k1=1.0,
    k2=1.0,
    k3=0.7,
    mu=0.3,
    belt_speed=5.0 * TIME / LENGTH,
    preload=1.0,
    length1=0.05 / LENGTH,
    length2=0.05 / LENGTH,
    sigma=1e6 * LENGTH,
)
UNITS = {
    "s": TIME,
    "s-1": 1 / TIME,
    "rad s-1": 1 / TIME,
    "m": LENGTH,
    "m s-1": LENGTH / TIME,
    "Hz": 1 / TIME,
    "N": FORCE,
    "N m-1": SI.k1,
}


WITH_DASHPOTS = {
    "cycle_branch": "without, it begins where two modes merge, ill-conditioned"
}


CHAOTIC = {"infer_parameters": 1e-4}
"""Whose runs are long enough for chaos to magnify the last digits; by how much at most."""


def without_curves(*charts):
    """Charts without their curves, which must lie on one another.

    With how many points a curve is drawn depends on last digits, also where k3 changes by 1e-16.
    """
    first, second = (
        np.stack([chart.alpha1.values, chart.alpha2.values], axis=1) for chart in charts
    )
    apart = np.linalg.norm(first[:, None] - second, axis=2)
    gaps = np.linalg.norm(np.diff(second, axis=0), axis=1)
    assert apart.min(axis=1).max() < np.median(gaps)
    return [chart.drop_dims("point").drop_vars("runs") for chart in charts]


COSTLY = {
    "assess": pytest.mark.long,
    "limit_cycle": pytest.mark.release,
    "boundary_distance": pytest.mark.release,
    "contact_boundary": pytest.mark.release,
    "infer_parameters": pytest.mark.release,
    "regime_chart": pytest.mark.release,
    "smallest_disturbance": pytest.mark.release,
}
"""Marks of what takes 20 s, and of what takes more than a second."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=COSTLY.get(name, [])) for name in CALLS]
)
def test_answers_scale(name):
    """As long as no chaos magnifies the last digits, which these horizons leave no time for."""
    share = 0.01 if name in WITH_DASHPOTS else 0.0
    real, scaled = (
        CALLS[name](p.with_(damping1=share * np.sqrt(p.k1 * p.mass)))
        for p in (SI, UNIT)
    )
    if name == "regime_chart":
        real, scaled = without_curves(real, scaled)
    assert dict(real.sizes) == dict(scaled.sizes)
    if (
        "cure" in real
    ):  # sorted by a change that round-off may tie; each has a unit of its own
        scaled = scaled.sel(cure=real.cure)
        units = [UNITS.get(unit, 1.0) for unit in real.unit.values]
        own_units = ("value", "quiet_from", "quiet_from_any_start")
        for key in (*own_units, "lowest_tried", "highest_tried"):
            real[key] = real[key] / units
        for key in ("quiet_low", "quiet_high"):
            real[key] = real[key] / np.array(units)[:, None]
    for key, variable in real.variables.items():
        if variable.dtype.kind not in "fiub":
            continue
        unit = UNITS.get(variable.attrs.get("units", "1"), 1.0)
        size = np.abs(scaled[key].values[np.isfinite(scaled[key].values)])
        atol = CHAOTIC.get(name, 1e-7) * size.max(initial=1.0)
        np.testing.assert_allclose(
            variable.values / unit,
            scaled[key].values,
            rtol=1e-6,
            atol=atol,
            err_msg=str(key),
        )


@pytest.mark.parametrize("question", ["contact_lost", "frequency", "max_displacement"])
def test_choices_scale(question):
    unit = {"frequency": 1 / TIME, "max_displacement": LENGTH}.get(question, 1.0)
    real, scaled = (sp.choose_model(p, A, B, question) for p in (SI, UNIT))
    assert real.model == scaled.model
    assert float(real.value) / unit == pytest.approx(float(scaled.value), rel=1e-6)


def typed(params):
    return [
        f"--{name.replace('_', '-')}={value}"
        for name, value in params.as_dict().items()
    ]


@pytest.mark.release
def test_simulate_prints_the_frequency_of_the_motion(capsys, tmp_path, monkeypatch):
    """Without options: no beat of samples a thousand periods apart."""
    monkeypatch.chdir(tmp_path)
    command = ["simulate", "0.5pi", "pi", "--model", "A4", *typed(SI)]
    assert run([*command, "-q"]) == 0
    printed = capsys.readouterr().out.split("ω = ")[1]
    assert float(printed.split()[0].rstrip(",")) == pytest.approx(
        np.sqrt(1.7e7 / 0.5), rel=0.02
    )
    assert run([*command, "--t-end", "50", "--points", "2001", "-o", "far.nc"]) == 0
    assert "do not resolve oscillations of period" in capsys.readouterr().out


def test_instants_that_skip_oscillations_are_reported():
    with pytest.warns(UserWarning, match="do not resolve") as caught:
        sp.simulate(SI, A, B, t_end=1.0, times=np.linspace(0, 1, 101))
    assert caught[0].filename == __file__


def test_times_stay_numbers_where_xarray_opens_a_file(tmp_path):
    import xarray as xr

    path = sp.save(CALLS["simulate"](SI), tmp_path / "run.nc")
    with xr.open_dataset(path) as opened:
        assert all(opened[name].dtype.kind == "f" for name in ("time", "event_time"))
        np.testing.assert_array_equal(opened.time, sp.load(path).time)
