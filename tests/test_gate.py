"""One gate for numbers: no public argument drops the unit of what it is given."""

# ruff: noqa: ARG005 (functions of a system take all four)

import inspect
import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pint
import pytest
import scipy.sparse as sp
import xarray as xr

import squealpipe
from squealpipe import (
    Contact,
    Face,
    Parameters,
    Structure,
    Sweep,
    System,
    boundary_distance,
    contact_boundary,
    propensity,
    simulate,
)
from squealpipe.brake.linear.maps import stability_map
from squealpipe.structures import elastic_pad
from squealpipe.structures.units import scales_of
from squealpipe.systems.inputs.gate import reals
from squealpipe.systems.shipped import impact_oscillator as shipped
from squealpipe.units import UnitError, in_si, number_of

QUANTITY = pint.UnitRegistry().Quantity
PAD = Parameters(k1=1e7, k2=1e7, k3=7e6, mass=0.45, preload=5e-4, length1=0.02)
OSCILLATOR = shipped.impact_oscillator
STRUCTURE = Structure(np.eye(2), 1e6 * np.eye(2))
NEEDED = {
    "params": PAD,
    "alpha1": 0.4,
    "alpha2": 0.8,
    "t_end": 1e-3,
    "mode": 1,
    "y_peak": 1e-3,
    "parameter": "mu",
    "to": 0.2,
    "label": "fold",
    "parameters": ("mu", "k3"),
    "question": "contact",
    "tol": 1e-9,
    "samples": 64,
    "distributions": {"mu": {"distribution": "uniform", "low": 0.1, "high": 0.2}},
    "resolution": 5,
    "coarse": 3,
    "leads_to": "contact_lost",
    "path": "x.nc",
    "x": 0.0,
    "y": 0.0,
    "vx": 0.0,
    "vy": 0.0,
    "name_or_path": "nothing",
    "task": "validity_map",
    "vary": {"mu": [0.1, 0.2]},
    "fixed": {},
    "name": "a",
    "leaves": "a",
    "when": abs,
    "regimes": {"a": {}},
    "mass": np.eye(2),
    "surface": "PAD",
    "states": {"x": "m"},
    "field": lambda t, s, p, r: {"x": -s.x},
    "figure": 1,
    "stiffness": np.eye(2),
    "normal": {0: 1.0},
    "tangential": {1: 1.0},
    "preload": 1.0,
    "statement": "",
    "start": {"x": 0.0},
    "structure": STRUCTURE,
    "self": STRUCTURE,
    "system": OSCILLATOR,
    "run": xr.Dataset(),
    "dataset": xr.Dataset(),
    "boundary": xr.Dataset(),
    "design": {"mu": 0.3},
    "array": xr.DataArray(0),
}
"""Valid values of the arguments that some function needs."""
OF_ITS_OWN = {
    "Contact": {"stiffness": 1.0, "preload": 1.0},
    "Face": {"stiffness": 1.0, "pressure": 1.0},
    "Switch": {"to": "a"},
    "System": {"parameters": {}},
    "cycle_curve": {"start": xr.Dataset()},
    "System.cycle_curve": {"start": xr.Dataset()},
    "System.cycle_branch": {"parameter": "gap", "start": xr.Dataset()},
}
NO_NUMBERS = {
    "self",
    "system",
    "structure",
    "figure",
    "statement",
    "Scene-name",
    "path",
    "displacements",
}
"""Arguments that are an object or words."""
VERBS = [
    *(name for name in squealpipe.__all__ if name not in {"run_sweep", "SCENES"}),
    "elastic_pad",
    *(f"System.{verb}" for verb in ("simulate", "ensemble", "basin")),
    *(f"System.{verb}" for verb in ("limit_cycle", "cycle_branch", "cycle_curve")),
    *(f"Structure.{verb}" for verb in ("complex_modes", "reduce", "read", "system")),
]


def _function(name):
    owner, _, verb = name.partition(".")
    if owner == "System" and verb in ("limit_cycle", "cycle_branch", "cycle_curve"):
        from squealpipe.systems.cycles import branch, curve, cycle

        return {
            "limit_cycle": cycle.limit_cycle,
            "cycle_branch": branch.cycle_branch,
            "cycle_curve": curve.cycle_curve,
        }[verb]
    if name == "elastic_pad":
        return elastic_pad
    found = getattr(squealpipe, owner)
    return getattr(found, verb) if verb else found


def _arguments():
    for name in VERBS:
        for each in inspect.signature(_function(name)).parameters.values():
            further = "gap" if name.startswith("System.") else "friction_speed"
            keyword = further if each.kind == each.VAR_KEYWORD else each.name
            if not {keyword, f"{name}-{keyword}"} & NO_NUMBERS:
                yield pytest.param(name, keyword, id=f"{name}-{keyword}")


@pytest.mark.parametrize(("name", "argument"), [*_arguments()])
def test_no_argument_drops_the_unit_of_a_quantity(name, argument):
    """Kelvin fits nothing here: whatever takes 300 K has taken 300."""
    function = _function(name)
    given = {
        each.name: {**NEEDED, **OF_ITS_OWN.get(name, {})}[each.name]
        for each in inspect.signature(function).parameters.values()
        if each.default is each.empty and each.kind != each.VAR_KEYWORD
    } | OF_ITS_OWN.get(name, {})
    for value in (QUANTITY(300.0, "K"), QUANTITY([300.0, 301.0, 302.0], "K")):
        with pytest.raises((ValueError, TypeError), match=argument):
            function(**given | {argument: value})


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Parameters(belt_spee=2.0), "Parameters: belt_spee: .*'belt_speed'"),
        (lambda: PAD.with_(belt_spee=2.0), "Parameters: belt_spee: .*'belt_speed'"),
        (lambda: Structure([[1.0]], [[1.0]], belt_spee=2.0), "Structure: belt_spee: "),
        (lambda: STRUCTURE.with_(belt_spee=2.0), ".*did you mean 'belt_speed'?"),
        (lambda: Contact("a", {0: 1}, {1: 1}, stifness=1.0), ".*mean 'stiffness'?"),
        (lambda: Face("lining", presure=1e5), "Face: presure: .*'pressure'?"),
        (lambda: System("one", stats={}), "System: stats: .*'states'?"),
    ],
)
def test_an_unknown_argument_is_told_with_the_one_that_was_meant(make, says):
    with pytest.raises(TypeError, match=says):
        make()


def test_starts_have_the_units_of_their_states():
    start = {"x": QUANTITY(2, "mm"), "v": "3.6 km/h"}
    run = OSCILLATOR.simulate("1 ms", start=start, t_start=QUANTITY(0, "s"))
    same = OSCILLATOR.simulate(1e-3, start={"x": 2e-3, "v": 1.0})
    assert run.identical(same)
    many = OSCILLATOR.ensemble(1e-3, start={"x": QUANTITY([1, 2], "mm")}, workers=1)
    assert many.x0.values.tolist() == [1e-3, 2e-3]
    falling = System(
        "mass",
        states={"angle": "deg", "rate": "rad/s", "share": ""},
        parameters={},
        regimes={"free": {}},
        field=lambda t, s, p, r: {"angle": s.rate, "rate": 0.0, "share": 0.0},
        start={"angle": "0.5 rad", "rate": QUANTITY(30, "rpm"), "share": "20 %"},
    )
    assert falling.start == pytest.approx(
        {"angle": np.degrees(0.5), "rate": np.pi, "share": 0.2}, rel=1e-15
    )
    with pytest.raises(ValueError, match=r"start: x = .*that is a speed; a length"):
        OSCILLATOR.basin(1.0, start={"x": QUANTITY([1, 2], "mm/s")})


def test_what_has_no_declared_unit_takes_plain_numbers_alone():
    for given in ({"gap": QUANTITY(1, "mm")}, {"gap": "1 mm"}, {"gap": ["1 mm", 2.0]}):
        with pytest.raises(ValueError, match=r"gap = .*no unit is declared"):
            OSCILLATOR.ensemble(1.0, **given)
    with pytest.raises(
        ValueError, match=r"parameters\['a'\] = .*\(number, unit\), is needed"
    ):
        System(
            "mass",
            states={"x": "m"},
            parameters={"a": QUANTITY(1.0, "m")},
            regimes={"free": {}},
            field=lambda t, s, p, r: {"x": p.a},
            start={"x": 0.0},
        )
    with pytest.raises(
        ValueError, match=r"contact pad: normal = .*no unit is declared"
    ):
        Contact("pad", QUANTITY([0, 1], "mm"), {0: 1.0}, 1.0, 1.0)


def test_ranges_and_designs_have_the_units_of_their_parameters():
    boundary = contact_boundary(
        PAD,
        "120 deg",
        "150 deg",
        t_end="2 ms",
        mu=QUANTITY([10, 30, 60], "percent"),
        belt_speed=["3.6 km/h", 2.0, QUANTITY(300, "cm/s")],
        workers=1,
    )
    assert boundary.range.values.tolist() == [[0.1, 0.6], [1.0, 3.0]]
    design = {"mu": "30 %", "belt_speed": QUANTITY(7.2, "km/h")}
    same = boundary_distance(boundary, {"mu": 0.3, "belt_speed": 2.0})
    assert boundary_distance(boundary, design).identical(same)
    with pytest.raises(ValueError, match=r"mu = .*that is a length"):
        contact_boundary(
            PAD, 1.0, 1.0, mu=QUANTITY([1, 2, 3], "mm"), k3=[1.0, 2.0, 3.0]
        )
    spread = {"mu": {"distribution": "uniform", "low": QUANTITY(1, "m"), "high": 1.0}}
    with pytest.raises(ValueError, match="that is a length; a number without a unit"):
        propensity(PAD, 1.0, 1.0, distributions=spread, t_end=1e-3)
    run = simulate(PAD, QUANTITY(22, "deg"), "0.4pi", t_end=QUANTITY(0.1, "ms"))
    assert float(run.alpha1) == np.radians(22)


@pytest.mark.parametrize("form", [np.array, sp.csr_array, np.ndarray.tolist])
def test_matrices_loads_and_ratios_have_units(form):
    pad = Structure(
        QUANTITY(form(450.0 * np.eye(2)), "g"),
        QUANTITY(form(np.diag([1, 2]).astype(np.int8)), "kN/mm"),
        QUANTITY(form(np.eye(2)), "N*s/mm"),
        load=QUANTITY([1, 2], "kN"),
        modal_damping=QUANTITY([1, 2], "percent"),
    )
    assert np.array_equal(pad.mass.toarray(), 0.45 * np.eye(2))
    assert np.array_equal(pad.stiffness.toarray(), 1e6 * np.diag([1, 2]))
    assert np.array_equal(pad.damping.toarray(), 1e3 * np.eye(2))
    assert pad.load.tolist() == [1000.0, 2000.0]
    assert pad.modal_damping.tolist() == [0.01, 0.02]
    for name in ("mass", "stiffness", "damping"):
        with pytest.raises(ValueError, match=f"{name} = .*that is a pressure"):
            Structure(
                **{"mass": np.eye(2), "stiffness": np.eye(2)}
                | {name: QUANTITY(np.eye(2), "bar")}
            )


def test_frictions_of_modes_have_units():
    pad = elastic_pad(elements=(2, 1), contacts=1)
    modes = pad.complex_modes(mu=QUANTITY([10, 30], "percent"), modal_damping="1 %")
    same = pad.complex_modes(mu=[0.1, 0.3], modal_damping=0.01)
    assert modes.identical(same)


MEANT = {
    ("0.45 t", "kg"): 450.0,
    ("0.45 tonne", "kg"): 450.0,
    ("2 short_ton", "kg"): 1814.36948,
    ("4 tf", "N"): 39226.6,
    ("4 kgf", "N"): 39.2266,
    ("2 lbm", "kg"): 0.90718474,
    ("36 kmph", "m s-1"): 10.0,
    ("3 Nm", "N m"): 3.0,
    ("3 kNm", "N m"): 3000.0,
    ("3 mm/m", "1"): 0.003,
    ("50 Hz", "rad/s"): 100 * np.pi,
}


@pytest.mark.parametrize(("text", "units"), MEANT)
def test_everyday_units_mean_what_they_do_in_europe(text, units):
    assert in_si(text, units) == pytest.approx(MEANT[text, units], rel=1e-15)


AMBIGUOUS = {
    ("0.45 ton", "kg"): "1000 kg or, in America, 907.18 kg; write t",
    ("2 tons", "kg"): "write t",
    ("4 ton_force", "N"): "9.807 kN or, in America, 8.896 kN; write tf",
    ("450 gr", "kg"): "a gram or a grain; write g",
    ("3 mt", "kg"): "write t, or kg",
    ("22 grad", "rad"): "a degree or a 400th of a turn; write deg, or gon",
    ("3 cwt", "kg"): "45.36 kg or, in Britain, 50.8 kg",
    ("3 Nm", "N"): "that is a torque or an energy; a force is needed",
    ("3 lb/in", "N m-1"): "a weight is written lbf or kgf",
    ("10 KN", "N"): "unknown unit 'KN'; did you mean kN?",
    ("5 Mpa", "Pa"): "unknown unit 'Mpa'; did you mean MPa?",
    ("450 Kg", "kg"): "did you mean kg?",
}


@pytest.mark.parametrize(("text", "units"), AMBIGUOUS)
def test_what_has_two_readings_is_refused_with_both(text, units):
    with pytest.raises(UnitError, match=re.escape(AMBIGUOUS[text, units])):
        in_si(text, units)


def test_systems_of_units():
    assert scales_of("mm-ton-s") == scales_of("mm-t-s") == scales_of("mm-Mg-s")
    assert scales_of("mm-ton-s").force == 1.0
    assert scales_of("in-slinch-s").force == pytest.approx(4.4482216152605, rel=1e-15)
    for word in ("in-lb-s", "ft-lb-s"):
        with pytest.raises(ValueError, match="lb is a mass or a force") as caught:
            scales_of(word)
        for remedy in re.findall(r"(?:in|ft)-\w+-s", str(caught.value))[1:]:
            assert scales_of(remedy).force > 0.0
    with pytest.raises(ValueError, match="name that of mass"):
        scales_of("mm-N-s")


def test_quantities_are_the_doubles_that_their_decimals_are():
    read = number_of(QUANTITY([0.57, 0.1, 3.3], "mm"), "m")
    assert read.tolist() == [5.7e-4, 1e-4, 3.3e-3]
    long = QUANTITY(
        0.12345678901234567, "pound * foot / minute ** 2 * megaparsec / megaparsec"
    )
    assert number_of(long, "N") == pytest.approx(long.m_as("N"), rel=1e-14)


def test_other_libraries_quantities_are_refused():
    class Other:
        value, unit = 2.0, "mm"

    for value in (Other(), [Other()], np.array([QUANTITY(1, "mm")], dtype=object)):
        with pytest.raises(
            ValueError, match=r"t_end = .*a quantity of another library"
        ):
            simulate(PAD, 0.1, 0.2, t_end=value)


def test_sweeps_have_units():
    sweep = Sweep(
        task="validity_map",
        params=PAD,
        vary={"mu": QUANTITY([10, 30], "percent"), "alpha1": ["30 deg", 1.0]},
        fixed={"alpha2": "60deg", "t_end": QUANTITY(20, "ms")},
    )
    assert sweep.vary == {"mu": [0.1, 0.3], "alpha1": [np.radians(30), 1.0]}
    assert sweep.fixed == {"alpha2": np.radians(60), "t_end": 0.02}
    with pytest.raises(ValueError, match=r"fixed = .*that is a length; a time"):
        replace(sweep, fixed={"alpha2": 1.0, "t_end": "20 mm"})


def test_degrees_of_temperature_and_decibels_are_no_multiples():
    assert in_si("20 mK", "K") == 0.02
    for text, units in (("20 degC", "K"), ("20 °C", "K"), ("3 dB", "1")):
        with pytest.raises(UnitError):
            in_si(text, units)
    assert number_of(QUANTITY(Fraction(1, 4), "mm"), "m") == 2.5e-4
    for value in (QUANTITY(1 + 2j, "mm"), QUANTITY(20.0, "degF")):
        with pytest.raises(UnitError):
            number_of(value, "m")


def test_arrays_of_xarray_have_the_unit_that_they_state():
    angles = xr.DataArray([10.0, 20.0], dims="a", attrs={"units": "degree"})
    start = {"x": xr.DataArray([1.0, 2.0], dims="a", attrs={"units": "mm"})}
    times = xr.DataArray([0.0, 0.5], dims="t", attrs={"units": "ms"})
    run = simulate(PAD, angles[0], angles[1], t_end=1e-3, times=times)
    assert run.time.values.tolist() == [0.0, 5e-4]
    assert float(run.alpha1) == pytest.approx(np.radians(10.0), rel=1e-15)
    many = OSCILLATOR.ensemble(1e-3, start=start, workers=1)
    assert many.x0.values.tolist() == [1e-3, 2e-3]
    # what the package gave is taken as it is
    again = OSCILLATOR.ensemble(
        1e-3, start={"x": many.x0}, gap=many.x0 + 1.0, workers=1
    )
    assert again.x0.identical(many.x0)


def test_degrees_are_one_angle_however_they_are_written():
    for number in (30.0, 22.0, 17.3):
        runs = [
            simulate(PAD, angle, 0.2, t_end=1e-4).alpha1.item()
            for angle in (f"{number} deg", QUANTITY(number, "deg"), np.radians(number))
        ]
        assert len({*runs}) == 1


def test_a_result_stays_when_the_callers_array_is_used_again():
    angles, expected = np.linspace(0.1, 3.0, 5), np.linspace(0.1, 3.0, 5)
    made = stability_map(Parameters(), angles, angles)
    angles[:] = 0.0
    assert made.alpha1.values.tolist() == expected.tolist()
    assert not np.shares_memory(reals(angles), angles)
