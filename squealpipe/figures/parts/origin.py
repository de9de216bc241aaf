"""What a stored dataset says about the run that made it."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING

from squealpipe.figures.parts.style import pi_label
from squealpipe.parameters import DEFAULTS, SCENES, TABLE

if TYPE_CHECKING:
    import xarray as xr


def parameter(dataset: xr.Dataset, name: str) -> float:
    """A parameter of the run, from the attributes of its dataset, which leave out what is not used.

    Raises:
        ValueError: the dataset carries none.
    """
    own = json.loads(dataset.attrs.get("parameters", "{}"))
    study = json.loads(dataset.attrs.get("config", "{}")).get("parameters", {})
    if TABLE[name].extension:
        study = {name: DEFAULTS[name], **study}
    if name not in own | study:
        raise ValueError(f"the dataset carries no parameter {name}; save it with its configuration")
    return float((study | own)[name])


def time_unit(dataset: xr.Dataset) -> float:
    """√(m/k1) of the run, s."""
    return math.sqrt(parameter(dataset, "mass") / parameter(dataset, "k1"))


def scene_name(dataset: xr.Dataset, scene: str) -> str:
    """A scene of the periodic motions by its angles: ``(π/2, π), mode 2`` for ``F10 mode 2``."""
    name, _, mode = scene.partition(" mode ")
    own = json.loads(dataset.attrs.get("config", "{}")).get("backbones.coupled", {})
    if name in own:
        angles = [float(angle) * math.pi for angle in own[name]]
    elif name in SCENES:
        angles = [SCENES[name].alpha1, SCENES[name].alpha2]
    else:
        return scene
    return f"({', '.join(map(pi_label, angles))}), mode {mode}"
