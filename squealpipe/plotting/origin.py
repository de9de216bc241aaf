"""Parameters and scene that a stored dataset records of the run that made it."""

import json
import math
from typing import Any

import numpy as np
import xarray as xr

from squealpipe.codes import Regime
from squealpipe.parameters import DEFAULTS, SCENES, TABLE
from squealpipe.plotting.style import pi_label


def parameter(dataset: xr.Dataset, name: str) -> Any:
    """A parameter of the run, a number or a law, from the attributes of its dataset."""
    parameters = json.loads(dataset.attrs.get("parameters", "{}"))
    study = json.loads(dataset.attrs.get("config", "{}")).get("parameters", {})
    if TABLE[name].extension:
        study = {name: DEFAULTS[name], **study}
    if name not in parameters | study:
        raise ValueError(
            f"the dataset carries no parameter {name}; save it with its configuration"
        )
    value = (study | parameters)[name]
    return value if isinstance(value, str) else float(value)


def slip_along_belt(regimes: np.ndarray, belt_speed: float) -> np.ndarray:
    """Return regimes of A1 in which slower and faster count along the belt's own motion.

    Datasets count along +x: on a belt that runs along −x a mass at rest has ``slip_faster``.
    """
    if belt_speed >= 0.0:
        return regimes
    slower, faster = Regime.slip_slower, Regime.slip_faster
    return np.select(
        [regimes == slower, regimes == faster], [faster, slower], regimes
    ).astype(regimes.dtype)


def common_friction(modes: xr.Dataset) -> float | None:
    """Return the coefficient that all contacts of a structure have of their own; None: several."""
    contacts = json.loads(modes.attrs["parameters"])["contacts"].values()
    own = {contact.get("mu") for contact in contacts}
    return own.pop() if len(own) == 1 else None


def time_unit(dataset: xr.Dataset) -> float:
    """√(m/k1) of the run, s."""
    return math.sqrt(parameter(dataset, "mass") / parameter(dataset, "k1"))


def angle_pair(alpha1: float, alpha2: float) -> str:
    """Both angles as people write them: ``(0.4π, 0.6π)``."""
    return f"({pi_label(float(alpha1))}, {pi_label(float(alpha2))})"


def scene_title(name: str) -> str:
    """A scene of the paper by its angles and its figure: ``(0.4π, 0.6π), Fig. 3``."""
    scene = SCENES[name]
    return f"{angle_pair(scene.alpha1, scene.alpha2)}, {scene.panel}"


def scene_name(dataset: xr.Dataset, scene: str) -> str:
    """A scene of the periodic motions by its angles: ``(π/2, π), mode 2`` for ``F10 mode 2``."""
    name, _, mode = scene.partition(" mode ")
    own = json.loads(dataset.attrs.get("config", "{}")).get("backbones.coupled", {})
    if name in own:
        angles = angle_pair(*(float(angle) * math.pi for angle in own[name]))
    elif name in SCENES:
        angles = angle_pair(SCENES[name].alpha1, SCENES[name].alpha2)
    else:
        return scene
    return f"{angles}, mode {mode}"
