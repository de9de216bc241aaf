"""Datasets that compare methods: work–precision and the failure atlas."""

from enum import IntEnum

from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    count,
    flag,
    outcome,
    text,
)
from squealpipe.systems.datasets.agreement import ComparedAs, Listing, RoundOff


class Role(IntEnum):
    """Origin of a method: ours, or a public one."""

    public = 0
    ours = 1
    our_setting = 2


_of_run = ("problem", "solver", "tol")

work_precision_schema = DatasetSchema(
    name="work_precision",
    title="Error of a method against its cost, one run a row",
    lists={"run": Listing(kinds=("method", "setting"))},
    coordinates={"run": count("one method at one setting", "run")},
    variables={
        "method": text("method", "run"),
        "setting": text("its setting", "run"),
        "role": flag("public method, ours, or our default", Role, "run"),
        "error": Variable(
            "relative error of ω against the exact orbit, median over peaks",
            dims=("run",),
            nan_allowed=True,
            rtol=1e-3,
            round_off=RoundOff(
                ComparedAs.magnitude,
                "nothing but round-off is left at many harmonics, and the paper's Newton method "
                "has a Jacobian without full rank",
                floor=1e-12,
            ),
        ),
        "wall_time": Variable(
            "median wall time of one solution", "s", ("run",), volatile=True
        ),
        "outcome": outcome("run", among=(Outcome.converged, Outcome.no_convergence)),
    },
)


class Reliability(IntEnum):
    """Worth of a method's answer to a hard scene."""

    not_applicable = 0
    right = 1
    flagged = 2
    silently_wrong = 3


failure_atlas_schema = DatasetSchema(
    name="failure_atlas",
    title="Methods for frequencies and stability on hard scenes, judged by their errors",
    coordinates={
        "scene": text("hard scene", "scene"),
        "solver": text("method (the name xarray keeps for itself)", "solver"),
    },
    variables={
        "verdict": flag("verdict on the answer", Reliability, "scene", "solver"),
        "error": Variable(
            "largest error of the answer; infinite where there is none",
            dims=("scene", "solver"),
            nan_allowed=True,
            rtol=1e-2,
            round_off=RoundOff(
                ComparedAs.magnitude,
                "the scenes are those where methods fail; `verdict` holds what an answer is worth",
                floor=1e-9,
            ),
        ),
        "message": text("what the method said", "scene", "solver"),
        "tolerance": Variable("largest error that counts as right", dims=("scene",)),
        "role": flag("whose method it is", Role, "solver"),
    },
)

_adaptive_step_round_off = RoundOff(
    ComparedAs.magnitude, "errors of adaptive steps follow round-off", floor=1e-9
)

benchmark_schema = DatasetSchema(
    name="benchmark",
    title="Integrators with events: every solver on every problem at every tolerance",
    judged={"solver": ("role", int(Role.ours))},
    coordinates={
        "problem": text("problem", "problem"),
        "solver": text("solver", "solver"),
        "tol": Variable(
            "tolerance asked for (xarray keeps the longer name)", dims=("tol",)
        ),
    },
    variables={
        "group": text("class of the problem", "problem"),
        "role": flag("whose solver it is", Role, "solver"),
        "package": Variable(
            "package and version of the solver",
            dims=("solver",),
            dtype="U64",
            volatile=True,
            optional=True,
        ),
        "processor": Variable(
            "processor on which the solver ran",
            dims=("solver",),
            dtype="U64",
            volatile=True,
            optional=True,
        ),
        "shipped": Variable(
            "whether the answers are shipped with squealpipe and none was asked for anew",
            dims=("solver",),
            flags={0: "no", 1: "yes"},
            volatile=True,
            optional=True,
        ),
        "verdict": flag(
            "right; flagged: wrong or without an answer, and said so; silently wrong: another list "
            "of events, or an error over growth above 100 tolerances",
            Reliability,
            *_of_run,
        ),
        "missed": count(
            "events missed; -1 where no events are reported or judged", *_of_run
        ),
        "spurious": count(
            "events too many; -1 where no events are reported or judged", *_of_run
        ),
        "out_of_order": count(
            "events found before one that they follow; -1 where no events are reported or judged",
            *_of_run,
        ),
        "time_error": Variable(
            "largest error of an event's time",
            dims=_of_run,
            nan_allowed=True,
            round_off=_adaptive_step_round_off,
        ),
        "error": Variable(
            "largest error of final state and event times over the growth of a perturbation",
            dims=_of_run,
            nan_allowed=True,
            round_off=_adaptive_step_round_off,
        ),
        "evaluations": count(
            "calls of the field, counted by the harness; a solver that makes its own functions "
            "tells them, a Taylor step of order p as p + 1",
            *_of_run,
            dtype="i8",
            rtol=0.5,
        ),
        "cpu_time": Variable("CPU time", "s", _of_run, nan_allowed=True, volatile=True),
        "cpu_ratio": Variable(
            "CPU time over that of scipy's DOP853 at 1e-8 in the same process",
            dims=_of_run,
            nan_allowed=True,
            volatile=True,
        ),
        "message": Variable("what the solver said", dims=_of_run, dtype="U64"),
    },
)
