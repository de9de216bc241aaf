"""Random calls of the public functions, with arguments that make sense and others that do not."""

import math
import signal
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from random import Random
from types import NoneType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import squealpipe as sp
from squealpipe.brake.a1.ensemble import run_ensemble
from squealpipe.brake.schema.ladder import QUESTIONS
from squealpipe.functions import cos
from squealpipe.inputs import parse_angle
from squealpipe.laws.friction_laws import LAWS
from squealpipe.parameters import TABLE
from squealpipe.ranges import parse_range
from squealpipe.study.configuration.settings import parse_study

LONGEST = 20.0
"""Seconds of CPU time after which a call counts as one that does not end."""

NO_NUMBER = [
    None,
    "1",
    "",
    b"1",
    1j,
    True,
    np.bool_(True),
    math.nan,
    math.inf,
    -math.inf,
    10**400,
    [],
    {},
    object(),
    np.timedelta64(1, "s"),
    np.datetime64("2020-01-01"),
    np.array([1.0, 2.0]),
    np.ma.masked,
    np.complex128(1),
    {1.0},
    range(2),
    np.nan,
    "many",
]
NO_ANGLES = [
    90.0,
    [0.1, -7.0],
    None,
    "1",
    ["0", "1"],
    [True, False],
    1j,
    [1j],
    [math.nan],
    [0.0, math.inf],
    [[0.1], [0, 1]],
    np.ma.masked_all(2),
    np.ma.masked_array([0.3, 2.0], [False, True]),
    [None, 2.0],
    [10**400],
    np.array([1], "timedelta64[s]"),
    {},
    object(),
    [object()],
    [[0.1, 0.2]],
    np.zeros((2, 2, 2)),
]
EXTREMES = [5e-324, 1e-300, 1e-155, 1e-12, 1e12, 1e155, 1e300, 1.7e308]


@dataclass
class Kind:
    """Values of one kind of argument: how to draw one that makes sense, and what is refused."""

    good: Callable[[Random], Any]
    bad: list[Any]


def number(low, high, *, zero=False, extremes=True):
    """A positive number, mostly of ordinary size; ``zero`` allows 0."""

    def draw(rng):
        if extremes and rng.random() < 0.03:
            return rng.choice(EXTREMES)
        if zero and rng.random() < 0.1:
            return 0
        value = math.exp(rng.uniform(math.log(low), math.log(high)))
        return rng.choice([value, np.float64(value), np.float32(value)])

    return Kind(draw, [*NO_NUMBER, -1.0, -5e-324, *([] if zero else [0, 0.0, -0.0])])


def one_of(*values):
    return Kind(
        lambda rng: rng.choice(values), ["", "x", None, 1.5, [], object(), "A1 "]
    )


def whole(*values):
    bad = [*NO_NUMBER, 0, -1, 1.5, 1.0]
    return Kind(lambda rng: rng.choice([*values, np.int64(values[0])]), bad)


SOME = [0, math.pi / 2, math.pi, np.float32(1.0)]
LISTS = [
    np.linspace(0, math.pi, 3),
    [0.0, math.pi / 2],
    np.float32([0.2, 3.0]),
    [1, 2],
    xr.DataArray([0.5, 1.0]),
]
ANGLE = Kind(
    lambda rng: rng.choice([rng.uniform(0, math.pi), rng.uniform(-6, 6), *SOME]),
    [*NO_NUMBER, 7.0, -90, 1e9],
)
ANGLES = Kind(
    lambda rng: rng.choice(
        [[rng.uniform(-6, 6) for _ in range(rng.choice([1, 2, 3]))], *LISTS]
    ),
    NO_ANGLES,
)
TURNS = Kind(
    lambda rng: rng.uniform(1, 9),
    ["1", True, np.bool_(True), 1j, math.nan, None, object(), b"1"],
)
MANY = Kind(ANGLE.good, NO_ANGLES[2:17])
HORIZON = number(0.05, 8.0)
MAYBE = Kind(HORIZON.good, [bad for bad in HORIZON.bad if bad is not None])
LIMITED = number(0.05, 8.0, zero=True, extremes=False)
FROM_NOW = number(0.05, 8.0, zero=True)
LATER = Kind(FROM_NOW.good, [bad for bad in FROM_NOW.bad if bad is not None])
TOL = Kind(
    lambda rng: 10.0 ** rng.uniform(-17, -3),
    [*NO_NUMBER, 0.0, -1e-6, 1.0, 1e-19, 1e-300],
)
MODEL = one_of(
    "A1", "A1-no-stick", "A1-no-separation", "A1-linear-springs", "A1-as-printed", "A4"
)
STATE = Kind(
    lambda rng: [rng.uniform(-0.5, 0.5) for _ in range(4)],
    [
        *NO_NUMBER,
        [0.0] * 3,
        [0.0] * 5,
        ["0"] * 4,
        [math.nan] * 4,
        [None] * 4,
        [True] * 4,
    ],
)
OPTIONAL = [bad for bad in NO_NUMBER if bad is not None]
SIGMA = Kind(lambda rng: rng.choice([None, 10.0, 1e3]), OPTIONAL)
START = Kind(
    lambda rng: rng.choice(
        [0.0, rng.uniform(-0.5, 0.5), [rng.uniform(-0.5, 0.0), 0.3]]
    ),
    [bad for bad in NO_ANGLES[2:] if not isinstance(bad, np.ma.MaskedArray)],
)
ONE = Kind(lambda _: 1, [0, -1, 1.0, "1", True, 10**400])
LEAST_ONE = Kind(
    lambda rng: rng.choice([1, 2, np.int64(3)]), [0, -1, 1.5, "1", True, [], 10**400]
)
SEED = Kind(
    lambda rng: rng.randrange(10**6), [None, -1, 0.5, "1", True, [1], 10**400, object()]
)
TRUTH = Kind(lambda rng: rng.random() < 0.5, [None, 0, 1.0, "yes", "", [], object()])
PLACE = Kind(
    lambda _: "no-such-folder/no-such-file.nc",
    [None, 1, 1.5, True, object(), [], {}, 1j, "\0"],
)
UNIFORM = {"distribution": "uniform", "low": 0.1, "high": 0.9}
MAPPING = [None, 1, "mu", [], ["mu"], object(), {1: 2}, {"mu": None}, {"mu": "uniform"}]
NO_PARAMETERS = [None, {"nu": 0.3}, "baseline", 1.0, sp.Parameters, [sp.Parameters()]]

PHYSICAL = {
    name: {
        "positive": number(0.05, 20.0),
        "not negative": number(0.01, 3.0, zero=True),
        "finite": Kind(lambda rng: rng.uniform(-5, 5), NO_NUMBER),
        "law": Kind(
            lambda rng: rng.choice(list(LAWS)),
            ["", "columb", None, 3, True, [], object(), b"x"],
        ),
    }[row.allowed]
    for name, row in TABLE.items()
}
PHYSICAL["mu_static"] = Kind(lambda rng: rng.choice([None, 30.0]), OPTIONAL)
WRITTEN = {
    name: Kind(
        kind.good, [bad for bad in kind.bad if type(bad).__module__ == "builtins"]
    )
    for name, kind in PHYSICAL.items()
}
"""What a YAML file can hold."""
SCENE = {"alpha1": ANGLE, "alpha2": ANGLE}
MAP = {"alpha1": ANGLES, "alpha2": ANGLES}


OSCILLATOR: dict[str, Any] = {
    "states": {"x": "m", "v": ("m/s", 2.0)},
    "parameters": {"amplitude": 0.5, "gap": 1.0},
    "regimes": {"free": {"stiffness": 1.0}},
    "field": lambda t, s, p, r: {
        "x": s.v,
        "v": p.amplitude * cos(2.0 * t) - 0.1 * s.v - r.stiffness * s.x,
    },
    "start": {"x": 0.0, "v": 0.1, "regime": "free"},
    "starts_in": ["free"],
    "period": lambda _: math.pi,
    "outputs": {"energy": ("m2/s2", lambda t, s, p, r: s.x * s.x + s.v * s.v)},
    "stops": {"far": lambda t, s, p, r: 50.0 - s.x},
    "time_scale": 1.0,
}
IMPACT: dict[str, Any] = {
    "name": "impact",
    "leaves": "free",
    "when": lambda t, s, p, r: p.gap - s.x,
    "to": [("free", lambda t, s, p, r: s.v, "touch"), "free"],
    "reset": lambda t, s, p, r: {"v": -0.8 * s.v},
}
NO_PIECES = [
    None,
    1,
    -1.0,
    5e-324,
    "1e3",
    b"1",
    True,
    object(),
    1j,
    [1],
    (None,),
    {"x": None},
    {1: 2},
    {"x": {"r": "1"}},
    {"x": ("m", -1.0)},
    {"": 1.0},
    {"x": [0.1]},
    np.ones(2),
]
NO_START = [
    1,
    "x",
    b"1",
    True,
    object(),
    [1],
    {"y": 0.0},
    {"x": None},
    {"x": "1"},
    {"x": math.nan},
    {"regime": "y"},
    {"regime": ["free"]},
    {"regime": 1},
    {1: 2},
    xr.Dataset(),
]
SYSTEM_STARTS = Kind(lambda rng: {"x": rng.uniform(-1.0, 0.9)}, NO_START)
AMPLITUDE = {
    "amplitude": Kind(
        lambda rng: rng.choice([0, 0.5, np.float32(2.0), -1.0]),
        [
            "1",
            b"1",
            None,
            True,
            1j,
            math.nan,
            math.inf,
            10**400,
            {},
            object(),
            np.ones((2, 2)),
        ],
    )
}


def pieces(known, **allowed):
    """The arguments of a definition, and which other types they may have."""
    return {
        name: Kind(
            lambda _, good=value: good,
            [
                each
                for each in NO_PIECES
                if not isinstance(each, allowed.get(name, set))
            ],
        )
        for name, value in known.items()
    }


@cache
def oscillator(*, hits=True):
    """A forced oscillator, with a stop or without."""
    return sp.System("oscillator", **OSCILLATOR, switches=[sp.Switch(**IMPACT)] * hits)


@cache
def oscillators_cycle():
    """Where a branch begins."""
    return oscillator().limit_cycle(amplitude=0.2)


CALLS: dict[str, tuple[float, Callable[..., Any], dict[str, Kind]]] = {
    "Parameters": (6.0, sp.Parameters, PHYSICAL),
    "natural_frequencies": (2.0, sp.natural_frequencies, MAP),
    "stability_map": (2.0, sp.stability_map, {**MAP, "sigma": SIGMA}),
    "quasi_static_map": (2.0, sp.quasi_static_map, {**MAP, "sigma": SIGMA}),
    "critical_friction_map": (1.0, sp.critical_friction_map, MAP),
    "simulate": (
        3.0,
        sp.simulate,
        {
            **SCENE,
            "t_end": FROM_NOW,
            "model": MODEL,
            "tol": TOL,
            "initial_state": STATE,
        },
    ),
    "validity_map": (
        1.0,
        sp.validity_map,
        {**MAP, "t_end": LATER, "tol": TOL, "workers": ONE},
    ),
    "hammering_map": (
        1.0,
        sp.hammering_map,
        {**MAP, "t_end": HORIZON, "tol": TOL, "workers": ONE},
    ),
    "basin_map": (
        0.5,
        sp.basin_map,
        {**SCENE, "x": START, "vy": START, "t_end": HORIZON, "workers": ONE},
    ),
    "periodic_orbit": (
        2.0,
        sp.periodic_orbit,
        {**SCENE, "mode": whole(1, 2), "y_peak": number(0.1, 10.0)},
    ),
    "backbone": (
        0.15,
        sp.backbone,
        {
            **SCENE,
            "mode": whole(1, 2),
            "y_peak_max": number(1.1, 4.0, extremes=False),
            "method": one_of("exact", "hbm"),
            "n_harmonics": whole(4, 8),
        },
    ),
    "choose_model": (
        0.7,
        sp.choose_model,
        {**SCENE, "question": one_of(*QUESTIONS), "t_end": MAYBE},
    ),
    "refine_validity_map": (
        0.3,
        sp.refine_validity_map,
        {
            "resolution": Kind(lambda _: 5, OPTIONAL),
            "coarse": Kind(lambda _: 3, OPTIONAL),
            "t_end": HORIZON,
            "tol": TOL,
            "workers": ONE,
        },
    ),
    "run_ensemble": (
        1.0,
        run_ensemble,
        {
            "alpha1": MANY,
            "alpha2": MANY,
            "t_end": Kind(FROM_NOW.good, [*MANY.bad, -1.0]),
            "model": MODEL,
            "tol": TOL,
            "tangent": TRUTH,
            "log_events": Kind(lambda _: 3, SEED.bad),
            "stop_at_first_separation": TRUTH,
            "stop_at_turns": TURNS,
            "initial_state": STATE,
            "workers": ONE,
        },
    ),
    "infer_parameters": (
        0.5,
        sp.infer_parameters,
        {
            "samples": LEAST_ONE,
            "seed": SEED,
            "tol": TOL,
            "workers": ONE,
            "mu": Kind(
                lambda _: (0.1, 0.5), [None, 1.0, (0.1,), ("a", "b"), (0.1, math.nan)]
            ),
        },
    ),
    "propensity": (
        0.5,
        sp.propensity,
        {
            **SCENE,
            "t_end": HORIZON,
            "seed": Kind(SEED.good, [bad for bad in SEED.bad if bad is not None]),
            "tol": TOL,
            "workers": ONE,
            "samples": Kind(lambda _: 64, [*NO_NUMBER, 0, -64, 65, 64.0]),
            "distributions": Kind(lambda _: {"mu": UNIFORM}, MAPPING),
            "spring_correlation": Kind(lambda _: 0.0, [*NO_NUMBER, 1.0, -1.0, 2]),
        },
    ),
    "smallest_disturbance": (
        0.5,
        sp.smallest_disturbance,
        {
            **SCENE,
            "t_end": HORIZON,
            "bound": MAYBE,
            "directions": Kind(lambda _: 8, [*NO_NUMBER, 7]),
            "leads_to": one_of("contact_lost", "whirl"),
            "model": MODEL,
            "seed": SEED,
            "tol": TOL,
            "workers": ONE,
        },
    ),
    "assess": (0.2, sp.assess, {**SCENE, "tol": TOL}),
    "limit_cycle": (
        0.5,
        sp.limit_cycle,
        {
            **SCENE,
            "model": one_of("A1"),
            "t_settle": MAYBE,
            "guess": Kind(STATE.good, [bad for bad in STATE.bad if bad is not None]),
        },
    ),
    "cycle_branch": (
        0.5,
        sp.cycle_branch,
        {
            **SCENE,
            "parameter": one_of("mu", "k3", "alpha1"),
            "to": number(0.1, 1.0, zero=True),
            "n_points": Kind(lambda _: 2, [*NO_NUMBER, 0, 1, -3, 2.0]),
            "doubled": TRUTH,
            "start": Kind(
                STATE.good, ["offset", [0.0] * 3, [None] * 4, ["0"] * 4, object(), 1j]
            ),
        },
    ),
    "Sweep": (
        0.7,
        lambda params, **given: sp.Sweep(params=params, **given),
        {
            "task": one_of("stability_map"),
            "fixed": Kind(
                lambda _: {"alpha1": [1.0], "alpha2": [2.0]},
                [None, 1, "mu", [], object()],
            ),
            "vary": Kind(
                lambda _: {"mu": [0.1, 0.2]},
                [
                    *MAPPING,
                    {},
                    {"mu": []},
                    {"mu": ["a"]},
                    {"mu": [0.1, 0.1]},
                    {"mu": [-1.0]},
                ],
            ),
        },
    ),
    "System": (
        2.0,
        partial(sp.System, "oscillator"),
        pieces(
            OSCILLATOR,
            period=NoneType,
            outputs=NoneType,
            stops=NoneType,
            time_scale=int | float | NoneType,
        ),
    ),
    "Switch": (
        1.0,
        sp.Switch,
        pieces(IMPACT, reset=NoneType, name=str, leaves=str, to=str),
    ),
    "System.simulate": (
        1.5,
        lambda hits, **given: oscillator(hits=hits).simulate(**given),
        {
            "hits": Kind(TRUTH.good, []),
            "t_end": LIMITED,
            "start": SYSTEM_STARTS,
            "tol": TOL,
            **AMPLITUDE,
        },
    ),
    "System.ensemble": (
        1.0,
        lambda **given: oscillator().ensemble(**given),
        {
            "t_end": LIMITED,
            "start": SYSTEM_STARTS,
            "t_late": LATER,
            "horizon": TRUTH,
            "workers": ONE,
            **AMPLITUDE,
        },
    ),
    "System.basin": (
        0.7,
        lambda **given: oscillator().basin(**given),
        {"t_end": LIMITED, "start": SYSTEM_STARTS, "workers": ONE, **AMPLITUDE},
    ),
    "System.limit_cycle": (
        0.7,
        lambda hits, **given: oscillator(hits=hits).limit_cycle(**given),
        {
            "hits": Kind(TRUTH.good, []),
            "guess": SYSTEM_STARTS,
            "start": Kind(lambda _: None, NO_START),
            "periods": LEAST_ONE,
            "t_settle": MAYBE,
            **AMPLITUDE,
        },
    ),
    "System.cycle_branch": (
        0.5,
        lambda **given: oscillator().cycle_branch(
            **{"start": oscillators_cycle(), **given}
        ),
        {
            "parameter": one_of("amplitude", "gap"),
            "to": Kind(lambda rng: rng.uniform(0.3, 0.5), NO_NUMBER),
            "n_points": Kind(lambda _: 3, [*NO_NUMBER, 0, 1, -3, 2.0]),
        },
    ),
    "System.cycle_curve": (
        0.4,
        lambda **given: oscillator().cycle_curve(
            **{"start": oscillators_cycle(), **given}
        ),
        {
            "label": one_of("fold"),
            "parameters": Kind(lambda _: ("amplitude", "gap"), NO_PIECES),
            "start": Kind(lambda _: oscillators_cycle(), NO_PIECES),
            "n_points": Kind(lambda _: 3, [*NO_NUMBER, 0, 1, 2.0]),
        },
    ),
    "load": (0.4, lambda **given: sp.load(given["path"]), {"path": PLACE}),
    "save": (
        0.4,
        lambda **given: sp.save(given["dataset"], given["path"]),
        {
            "dataset": Kind(lambda _: xr.Dataset(), [None, {}, 1, "x", object()]),
            "path": PLACE,
        },
    ),
    "open_results": (0.4, sp.open_results, {"name_or_path": PLACE}),
    "parse_study": (1.0, lambda **given: parse_study({"parameters": given}), WRITTEN),
    "parse_range": (
        0.7,
        lambda **given: parse_range(given["text"], parse_angle),
        {
            "text": Kind(
                lambda rng: rng.choice(
                    ["0:pi:5", "1,2", ".5pi", "0.1:10:4:log", "5pi/6"]
                ),
                [
                    "",
                    ":",
                    "0:1",
                    "0:1:0",
                    "0:1:-3",
                    "a",
                    "nan",
                    "inf",
                    "1:2:3:4",
                    "0:1:5:log",
                    "1,,2",
                    "pipi",
                    "1e999",
                    "0:1:1e9",
                    "0:1:2.5",
                ],
            )
        },
    ),
    "Scene": (
        0.5,
        lambda **given: sp.Scene(name="X", figure=1, statement="", **given),
        {**SCENE, "t_end": number(0.1, 100.0)},
    ),
}
"""Name → weight, function, arguments."""


class Findings(NamedTuple):
    """What random calls did: how many refused arguments, what was wrong."""

    refused: list[bool]
    faults: list[str]


EXPENSIVE = {
    "infer_parameters",
    "propensity",
    "smallest_disturbance",
    "limit_cycle",
    "cycle_branch",
    "assess",
    "System.cycle_curve",
}
"""Always called with an argument that makes no sense."""
NO_PARAMS = {
    "Parameters",
    "parse_study",
    "parse_range",
    "Scene",
    "load",
    "save",
    "open_results",
}
NO_PARAMS |= {name for name in CALLS if name.startswith(("System", "Switch"))}


class TooLongError(Exception):
    """A call that does not end."""


def _ring(*_):
    raise TooLongError


def physical(rng):
    """Parameters that make sense, the paper's or any others."""
    if rng.random() < 0.2:
        return sp.Parameters()
    while True:
        chosen = rng.sample(sorted(PHYSICAL), rng.randrange(1, 8))
        try:
            return sp.Parameters(**{name: PHYSICAL[name].good(rng) for name in chosen})
        except ValueError:  # the static coefficient below that of sliding
            continue


def draw(rng):
    """A call: function, arguments, and the names of those that make no sense."""
    name = rng.choices(list(CALLS), [weight for weight, *_ in CALLS.values()])[0]
    kinds = CALLS[name][2]
    given = {argument: kind.good(rng) for argument, kind in kinds.items()}
    if kinds is PHYSICAL or name == "parse_study":
        given = {argument: given[argument] for argument in rng.sample(sorted(given), 4)}
    wrong: set[str] = set()
    if rng.random() < 0.5 or name in EXPENSIVE:
        candidates = [argument for argument in given if kinds[argument].bad]
        for argument in rng.sample(
            candidates, min(len(candidates), rng.choice([1, 1, 2]))
        ):
            given[argument] = rng.choice(kinds[argument].bad)
            wrong.add(argument)
    return name, given, wrong


def fault_of(name, given, wrong, params):
    """What is wrong with what a call did; empty where nothing is."""
    function = CALLS[name][1]
    takes_params = name not in NO_PARAMS
    try:
        found = function(params, **given) if takes_params else function(**given)
    except TooLongError:
        return "does not end"
    except FileNotFoundError:
        return "" if "path" in given or "name_or_path" in given else "no path was given"
    except ValueError as error:
        named = any(
            argument in str(error) for argument in ("param", "x = ", *given, *TABLE)
        )
        return "" if named or name == "parse_range" else f"names no argument: {error}"
    except TypeError as error:  # None is what pads leave out, too
        missing = "missing required argument" in str(error)
        return "" if missing else f"raw TypeError: {error}"
    except Exception as error:  # noqa: BLE001  whatever it is, it is the finding
        return f"raw {type(error).__name__}: {error}"
    if wrong:
        return "silent"
    return unearned(found) if isinstance(found, xr.Dataset) else ""


def unearned(found):
    """A converged outcome beside numbers that are none."""
    if "outcome" not in found:
        return ""
    converged = found.outcome == 0
    for name in (
        "x_static",
        "growth_rate",
        "omega",
        "x",
        "max_displacement",
        "late_max_x",
    ):
        if name not in found or not set(found.outcome.dims) <= set(found[name].dims):
            continue
        if bool((np.isnan(found[name]) & converged).any()):
            return f"{name} is NaN where the outcome is converged"
    return ""


def warm_up():
    """Compile what the calls need; each law and form of springs is a system of its own."""
    for law in LAWS:
        for model in ("A1", "A1-linear-springs"):
            for damping in (0.0, 0.1):
                params = sp.Parameters(
                    friction_law=law, mu_static=0.5, damping1=damping
                )
                sp.simulate(params, 1.0, 2.0, t_end=0.1, model=model)
    sp.hammering_map(sp.Parameters(), [1.0], [2.0], t_end=1.0, workers=1)
    for method in ("exact", "hbm"):
        sp.backbone(sp.Parameters(), 0.5, 3.0, mode=2, y_peak_max=1.2, method=method)
    sp.periodic_orbit(sp.Parameters(), 0.5, 3.0, mode=2, y_peak=2.0)


def fuzz(calls, seed):
    """Make random calls and judge each, once all that is compiled is there."""
    warm_up()
    rng, verdict = Random(seed), Findings([], [])  # noqa: S311
    previous = signal.signal(signal.SIGPROF, _ring)
    try:
        for _ in range(calls):
            name, given, wrong = draw(rng)
            params = physical(rng)
            if name not in NO_PARAMS and rng.random() < 0.02:
                params, wrong = rng.choice(NO_PARAMETERS), {*wrong, "params"}
            unit = params.time_unit if isinstance(params, sp.Parameters) else 1.0
            if "t_end" in given and "t_end" not in wrong and given["t_end"]:
                # a run of a million time units ends, but it takes minutes
                given["t_end"] = min(given["t_end"], 1e4 * unit) or unit
            signal.setitimer(signal.ITIMER_PROF, LONGEST)
            fault = fault_of(name, given, wrong, params)
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            verdict.refused.append(bool(wrong))
            if fault:
                verdict.faults.append(f"{name}({given}) with {params}: {fault}")
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, previous)
    return verdict
