"""Datasets on what the model levels take for granted (Table 1 and section 6 of the paper)."""

from __future__ import annotations

from squealpipe.schema import DatasetSchema, Variable, outcome
from squealpipe.schema.linear import ANGLES, MAP

YES_NO = {0: "no", 1: "yes"}
TABLE = ("level", "scene")


def _names(dimension: str, meaning: str) -> Variable:
    return Variable(dims=(dimension,), dtype="U", long_name=meaning)


def _largest(units: str, meaning: str) -> Variable:
    return Variable(dims=TABLE, units=units, long_name=meaning, nan_allowed=True, rtol=1e-6)


ASSUMPTIONS = DatasetSchema(
    name="assumptions",
    title="Which assumptions held along the motion that each model level computes for each scene",
    coordinates={
        "level": _names("level", "model level"),
        "scene": _names("scene", "scene of the paper"),
        "assumption": _names("assumption", "assumption"),
    },
    variables={
        "needed": Variable(
            dims=("level", "assumption"),
            dtype="i1",
            flags=YES_NO,
            long_name="whether the level makes the assumption",
        ),
        "measure": Variable(
            dims=(*TABLE, "assumption"),
            nan_allowed=True,
            rtol=1e-6,
            long_name="the number that decides",
        ),
        "limit": Variable(dims=("assumption",), long_name="limit of the measure"),
        "held": Variable(
            dims=(*TABLE, "assumption"),
            dtype="i1",
            flags=YES_NO,
            long_name="whether the assumption held along the whole motion",
        ),
        "largest_x": _largest("m", "largest |x|"),
        "largest_y": _largest("m", "largest y"),
        "peak_contact_force": _largest("1", "largest contact force over k3 l_pre"),
        "lowest_contact_force": _largest("1", "lowest contact force over k3 l_pre"),
        "t_end": Variable(dims=("scene",), units="s", long_name="end of the motion"),
        "outcome": outcome(*TABLE),
    },
)

LINEAR_PULL = DatasetSchema(
    name="linear_pull",
    title="How far the linear model lets the contact spring pull, from rest",
    coordinates=ANGLES,
    variables={
        "lowest_contact_force": Variable(
            dims=MAP, long_name="lowest contact force over k3 l_pre; negative: the spring pulls"
        ),
        "pulling_fraction": Variable(
            dims=MAP, long_name="fraction of the time during which the spring pulls"
        ),
        "first_pull_time": Variable(
            dims=MAP,
            units="s",
            nan_allowed=True,
            long_name="first instant at which the spring pulls (NaN: never, outcome converged)",
        ),
        "t_end": Variable(units="s", long_name="end of the motion"),
        "outcome": outcome(*MAP),
    },
)
