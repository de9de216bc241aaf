"""The explorer: one self-contained page on which a pair of angles shows its motion."""

import base64
import json
import os
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from shlex import quote
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import Environment, StrictUndefined

from squealpipe.parameters import SCENES, direction_of
from squealpipe.plotting.origin import parameter
from squealpipe.schema import meanings
from squealpipe.store.whole_files import whole_file
from squealpipe.study.report.explorer.layers import Layer
from squealpipe.systems.inputs.units import engineering


def write_explorer(
    explorer: xr.Dataset,
    layers: Mapping[str, Layer],
    path: str | os.PathLike[str],
    scenes: Mapping[str, Mapping[str, Any]] | None = None,
    *,
    paper: bool = True,
) -> None:
    """Write the page, whole or not at all."""
    papers = {
        scene.panel: {"alpha1": scene.alpha1, "alpha2": scene.alpha2, "near": 0.03}
        # one of each figure
        for scene in {each.figure: each for each in SCENES.values()}.values()
        if paper and scene.figure <= 5
    }
    with whole_file(Path(path)) as temporary:
        temporary.write_text(
            page(explorer, layers, papers | dict(scenes or {}), paper=paper),
            encoding="utf-8",
        )


def page(
    explorer: xr.Dataset,
    layers: Mapping[str, Layer],
    scenes: Mapping[str, Mapping[str, Any]],
    *,
    paper: bool = False,
) -> str:
    """The text of the page."""
    environment = Environment(undefined=StrictUndefined, autoescape=True)
    folder = Path(str(files("squealpipe.study.report.explorer")))
    shell = environment.from_string(
        (folder / "page.html.j2").read_text(encoding="utf-8")
    )
    return shell.render(
        style=(folder / "explorer.css").read_text(encoding="utf-8"),
        script=(folder / "explorer.js").read_text(encoding="utf-8"),
        chart=(folder / "chart.js").read_text(encoding="utf-8"),
        layers={key: layer.label for key, layer in layers.items()},
        branches="end" in explorer,
        belt=belt_in_words(explorer, paper=paper),
        payload=in_script(payload(explorer, layers, scenes)),
        blocks=blocks(explorer, layers),
        commit=explorer.attrs.get("commit", "unknown"),
        dataset_id=explorer.attrs.get("dataset_id", "unknown"),
    )


def belt_in_words(explorer: xr.Dataset, *, paper: bool) -> str:
    """Describe the belt of all motions on the page."""
    speed = parameter(explorer, "belt_speed")
    side = "+x" if direction_of(speed) > 0 else "−x"
    told = f"The belt runs along {side} at {engineering(abs(speed), 'm s-1')}, in all models."
    if paper:
        told += (
            " That is the physics with one sign of friction; the report says which sign its "
            "figures have."
        )
    return told


def in_script(content: Mapping[str, Any]) -> str:
    """JSON that no text in it can end or comment out, whatever the browser's parser is in."""
    return (
        json.dumps(content, allow_nan=False)
        .replace("<", "\\u003c")
        .replace(">", "\\u003e")
    )


def blocks(explorer: xr.Dataset, layers: Mapping[str, Layer]) -> dict[str, str]:
    """Numbers as text that the page decodes when a pair or layer is chosen, not before."""
    return {
        **{
            name: packed_curves(explorer[name].values)
            for name in ("x", "y", "normalized_contact_force", "force_spectrum")
        },
        **{
            name: _records(
                np.asarray(explorer[name].values, "<f4").reshape(
                    explorer.outcome.size, -1
                )
            )
            for name in ("omega", "x_amplitude", "y_peak", "stability_index")
            if name in explorer
        },
        **{
            f"layer-{key}": _encode(
                layer.map.values.astype("i1" if layer.meanings else "<f4")
            )
            for key, layer in layers.items()
        },
    }


def payload(
    explorer: xr.Dataset,
    layers: Mapping[str, Layer],
    scenes: Mapping[str, Mapping[str, Any]],
) -> dict[str, Any]:
    """Return the data that the script needs at once, ready for JSON."""
    return {
        "angles": [explorer.alpha1.values.tolist(), explorer.alpha2.values.tolist()],
        "time": _encode(explorer.time.values.astype("<f4")),
        "frequency": _encode(explorer.frequency.values.astype("<f4")),
        "options": run_options(explorer),
        "outcome": _meanings(explorer.outcome),
        **({"end": _meanings(explorer.end)} if "end" in explorer else {}),
        "preload": float(explorer.preload),
        "lengths": [float(explorer.length1), float(explorer.length2)],
        "layers": {key: _layer(layer) for key, layer in layers.items()},
        "scenes": [
            {
                "name": name,
                "angles": [scene["alpha1"], scene["alpha2"]],
                "near": scene.get("near"),
            }
            for name, scene in scenes.items()
            if all(0.0 <= scene[angle] <= np.pi for angle in ("alpha1", "alpha2"))
        ],
    }


def run_options(explorer: xr.Dataset) -> str:
    """Options of ``squealpipe simulate`` that repeat the runs shown: times and all parameters."""
    stated = explorer.attrs
    times = {"t_end": float(stated["run_t_end"]), "points": int(stated["run_points"])}
    options = times | json.loads(stated["parameters"])
    return " ".join(
        f"--{key.replace('_', '-')} {quote(_plain(value))}"
        for key, value in options.items()
    )


def _plain(value: object) -> str:
    return (
        repr(int(value))
        if isinstance(value, float) and value.is_integer()
        else str(value)
    )


def _layer(layer: Layer) -> dict[str, Any]:
    values = layer.map
    unit = values.attrs.get("units", "1")
    return {
        **layer._asdict(),
        "unit": "" if unit == "1" else unit.replace(" s-1", "/s").replace("s-1", "1/s"),
        "angles": [values.alpha1.values.tolist(), values.alpha2.values.tolist()],
        "map": None,  # in a block of its own
        "range": _colour_range(values.values.astype(float)),
    }


def _colour_range(values: np.ndarray) -> list[float]:
    """All but the outermost hundredths: a few late cells must not take the colours of the rest."""
    finite = values[np.isfinite(values)]
    return (
        [float(limit) for limit in np.percentile(finite, [1, 99])]
        if finite.size
        else [0.0, 1.0]
    )


def _meanings(flag: xr.DataArray) -> dict[str, Any]:
    table = meanings(flag)
    return {
        "values": _encode(np.asarray(flag.values, "i1")),
        "meanings": {
            key: table[key].replace("_", " ") for key in np.unique(flag.values).tolist()
        },
    }


def packed_curves(values: np.ndarray) -> str:
    """Each pair's curve: its lowest value, a scale, and 16-bit integers between lowest and highest.

    That halves the page; the error is below 1/131,070 of the curve's range.
    """
    flat = np.asarray(values, float).reshape(-1, values.shape[-1])
    low, high = flat.min(axis=1, keepdims=True), flat.max(axis=1, keepdims=True)
    scale = np.where(high > low, high - low, 1.0) / 65535.0
    numbers = np.round((flat - low) / scale).astype("<u2")
    head = np.hstack([low, scale]).astype("<f4")
    return _records(np.hstack([head.view(np.uint8), numbers.view(np.uint8)]))


def _records(rows: np.ndarray) -> str:
    """Rows as pieces of text of one length, so that each can be decoded alone."""
    return "".join(map(_encode, rows))


def _encode(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()
