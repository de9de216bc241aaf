"""Methods that say which unstable modes squeal: what each says, how well, and what it costs."""

from enum import IntEnum

from squealpipe.benchmark.schema import Reliability, Role
from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    count,
    flag,
    or_nan,
    outcome,
    text,
)
from squealpipe.systems.datasets.agreement import Listing

NO_MODE = -1


class PushAnswer(IntEnum):
    """Answer of a method to a push along an unstable mode, compared with the finest run."""

    right = 0
    other_mode = 1
    quiet_instead = 2
    rings_instead = 3
    not_settled = 4
    no_such_mode = 5
    not_known = 6


def _of_contact(long_name: str) -> Variable:
    dims = ("run", "mode", "contact")
    return or_nan(long_name, dims=dims, rtol=0.05, atol=0.01)


def _error(long_name: str) -> Variable:
    words = "largest over the pushes; NaN: not answered"
    return or_nan(f"{long_name}, {words}", dims=("run",), rtol=0.2, atol=1e-3)


def _uncertainty(long_name: str) -> Variable:
    return or_nan(
        f"{long_name} of the finest run: its scatter over starts, or the change from the next "
        "smaller number of modes, the larger",
        rtol=0.5,
        atol=1e-3,
    )


squeal_ladder_schema = DatasetSchema(
    name="squeal_ladder",
    title="What methods say of a structure's squeal, against the finest run, and their cost",
    coordinates={
        "run": count("one method at one setting", "run"),
        "mode": count(
            "mode of the finest structure along which is pushed, numbered as by complex_modes",
            "mode",
        ),
        "contact": text("name of the contact", "contact"),
    },
    variables={
        "method": text("method", "run"),
        "setting": text("its setting", "run"),
        "role": flag("whose method it is", Role, "run"),
        "n_modes": count("modes of the structure", "run"),
        "friction_width": or_nan(
            "sliding speed over which friction is smoothed, over the belt's; 0: exact; NaN: no run",
            dims=("run",),
        ),
        "contact_width": or_nan(
            "force over which loss of contact is smoothed, over the preload; 0: exact; NaN: no run",
            dims=("run",),
        ),
        "answer": flag("what becomes of a push", PushAnswer, "run", "mode"),
        "verdict": flag(
            "right: the same modes ring after all pushes; flagged: a motion has not settled; "
            "silently wrong: another mode rings, or none does",
            Reliability,
            "run",
        ),
        "rings_near": count(
            "mode of the finest structure nearest to the strongest line, -1: none rings",
            "run",
            "mode",
        ),
        "frequency": or_nan(
            "strongest line of the kinetic energy", "Hz", ("run", "mode"), rtol=1e-2
        ),
        "velocity_rms": or_nan(
            "rms speed of vibration, all contacts",
            "m s-1",
            ("run", "mode"),
            rtol=0.05,
            atol=1e-3,
        ),
        "separated_fraction": _of_contact("share of the time without contact"),
        "stick_fraction": _of_contact(
            "share of the time in stick; of smoothed friction, slower than its width"
        ),
        "creep": or_nan(
            "mean speed of sliding in that time, over the belt's; NaN: no such time",
            dims=("run", "mode", "contact"),
            rtol=0.1,
            atol=1e-3,
        ),
        "peak_force": _of_contact("largest normal force over the preload"),
        "frequency_error": _error(
            "relative error of the frequency, 1 where none rings"
        ),
        "velocity_error": _error("relative error of the rms speed"),
        "separation_error": _error("largest error of a share of time without contact"),
        "frequency_uncertainty": _uncertainty("relative error of the frequency"),
        "velocity_uncertainty": _uncertainty("relative error of the rms speed"),
        "separation_uncertainty": _uncertainty("error of the shares without contact"),
        "cpu_time": Variable(
            "CPU time for all pushes, median; of exact events that of one in an ensemble",
            "s",
            ("run",),
            volatile=True,
        ),
        "compile_time": Variable(
            "CPU time to compile before, about 0 where the code was kept",
            "s",
            ("run",),
            volatile=True,
        ),
        "evaluations": count(
            "calls of the field for all pushes, a Taylor step of order p as p + 1; 0: none",
            "run",
            dtype="i8",
            rtol=0.2,
        ),
        "t_end": Variable("time that is run", "s"),
        "outcome": outcome(
            "run",
            "mode",
            among=(Outcome.converged, Outcome.unresolved, Outcome.no_convergence),
        ),
    },
    lists={"run": Listing(kinds=("method", "setting"))},
)
