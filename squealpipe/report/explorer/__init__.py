"""The explorer: one self-contained page on which a pair of angles shows its motion."""

from __future__ import annotations

import base64
import json
import os
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import Environment, StrictUndefined
from plotly.offline import get_plotlyjs

from squealpipe.parameters import SCENES
from squealpipe.report.explorer.layers import Layer

HERE = Path(str(files("squealpipe.report.explorer")))
HISTORIES = ("x", "y", "normalized_contact_force", "force_spectrum")
BRANCHES = ("omega", "x_amplitude", "y_amplitude", "y_peak", "stability_index")


def write_explorer(
    explorer: xr.Dataset, layers: Mapping[str, Layer], path: str | os.PathLike[str]
) -> None:
    """Write the page, whole or not at all.

    Args:
        explorer: dataset ``explorer``.
        layers: what the map can show, by key.
        path: the HTML file; it needs no network and no other file.
    """
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    temporary = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        temporary.write_text(page(explorer, layers), encoding="utf-8")
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


def page(explorer: xr.Dataset, layers: Mapping[str, Layer]) -> str:
    """The text of the page."""
    environment = Environment(undefined=StrictUndefined, autoescape=True)
    shell = environment.from_string((HERE / "page.html.j2").read_text(encoding="utf-8"))
    return shell.render(
        style=(HERE / "explorer.css").read_text(encoding="utf-8"),
        script=(HERE / "explorer.js").read_text(encoding="utf-8"),
        plotly=get_plotlyjs(),
        layers={key: layer.label for key, layer in layers.items()},
        payload=json.dumps(payload(explorer, layers), allow_nan=False).replace("</", "<\\/"),
        commit=explorer.attrs.get("commit", "unknown"),
        dataset_id=explorer.attrs.get("dataset_id", "unknown"),
    )


def payload(explorer: xr.Dataset, layers: Mapping[str, Layer]) -> dict[str, Any]:
    """Everything the script draws, ready for JSON."""
    return {
        "angles": [_single(explorer.alpha1.values), _single(explorer.alpha2.values)],
        "time": _single(explorer.time.values),
        "frequency": _single(explorer.frequency.values),
        "histories": {name: _scaled(explorer[name].values) for name in HISTORIES},
        "branches": {name: _single(explorer[name].values) for name in BRANCHES},
        "outcome": _meanings(explorer.outcome),
        "end": _meanings(explorer.end),
        "preload": float(explorer.preload),
        "lengths": [float(explorer.length1), float(explorer.length2)],
        "layers": {key: _layer(layer) for key, layer in layers.items()},
        "scenes": [
            {"name": scene.name, "angles": [scene.alpha1, scene.alpha2], "figure": scene.figure}
            for scene in SCENES.values()
            if scene.figure <= 5
        ],
    }


def _layer(layer: Layer) -> dict[str, Any]:
    return {
        "label": layer.label,
        "unit": layer.unit,
        "angles": [_single(layer.alpha1), _single(layer.alpha2)],
        "values": _single(layer.values),
        "range": _colour_range(layer.values),
        "meanings": layer.meanings,
        "colours": layer.colours,
        "note": layer.note,
    }


def _colour_range(values: np.ndarray) -> list[float]:
    """All but the outermost hundredths: a few late cells must not take the colours of the rest."""
    finite = values[np.isfinite(values)]
    return [float(limit) for limit in np.percentile(finite, [1, 99])] if finite.size else [0.0, 1.0]


def _meanings(flag: xr.DataArray) -> dict[str, Any]:
    names = str(flag.attrs["flag_meanings"]).split()
    table = dict(zip(map(int, flag.attrs["flag_values"]), names, strict=True))
    return {
        "values": _encode(np.asarray(flag.values, "i1")),
        "meanings": {key: table[key].replace("_", " ") for key in np.unique(flag.values).tolist()},
    }


def _single(values: np.ndarray) -> str:
    return _encode(np.asarray(values, "<f4"))


def _scaled(values: np.ndarray) -> dict[str, str]:
    """Each pair's curve as 16-bit integers between its own lowest and highest value.

    That halves the page; the error is below 1/131,070 of the curve's range.
    """
    flat = np.asarray(values, float).reshape(-1, values.shape[-1])
    low, high = flat.min(axis=1, keepdims=True), flat.max(axis=1, keepdims=True)
    scale = np.where(high > low, high - low, 1.0) / 65535.0
    return {
        "values": _encode(np.round((flat - low) / scale).astype("<u2")),
        "low": _single(low),
        "scale": _single(scale),
    }


def _encode(values: np.ndarray) -> str:
    return base64.b64encode(np.ascontiguousarray(values).tobytes()).decode()
