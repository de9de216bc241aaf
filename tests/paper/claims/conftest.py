"""One run's datasets at the shipped baseline, on a coarse grid."""

import pickle

import numpy as np
import pytest
from filelock import FileLock

from squealpipe.brake.backbones.backbone import backbone
from squealpipe.brake.backbones.harmonic_forms import compare_harmonic_forms
from squealpipe.brake.curves.contact import contact_boundary
from squealpipe.brake.dynamics.assumptions import check_assumptions, linear_pull_map
from squealpipe.brake.dynamics.hammering import hammering_map
from squealpipe.brake.dynamics.runs import simulate, validity_map
from squealpipe.brake.dynamics.whirl import transient_lifetimes
from squealpipe.brake.linear.maps import (
    natural_frequencies,
    quasi_static_map,
    stability_map,
)
from squealpipe.paper.inference.inference import infer_parameters
from squealpipe.paper.schema.growth import GROWTH_HORIZON
from squealpipe.parameters import SCENE_ANGLES, SCENES, Parameters
from squealpipe.reading import READINGS, corrected, for_linear

POINTS = 41
"""Multiples of π/40: holds 0.4π, 0.5π and π."""


@pytest.fixture(scope="session")
def baseline():
    return Parameters()


def compute_evidence(params, reading="along_plus_x", *, beside=False):
    """All datasets that the checks read, at any parameters; times and speeds scale with them.

    Args:
        params: those of the study.
        reading: in which what the paper shows is computed.
        beside: the corrected physics too.
    """
    found = of_the_paper(for_linear(params, reading), READINGS[reading].a1_model)
    if beside:
        other = READINGS[reading].corrected
        mended = of_the_paper(for_linear(params, other), READINGS[other].a1_model)
        found |= {f"corrected/{name}": dataset for name, dataset in mended.items()}
    found["parameter_inference"] = infer_parameters(
        params,
        samples=24,
        reading=reading,
        kappa=(0.55, 0.7),
        mu=(0.28, 0.31),
        length_ratio=(8.0, 16.0),
        speed_ratio=(90.0, 110.0),
        workers=1,
    )
    return (
        found
        | of_one_sign(corrected(params, reading))
        | of_a4(for_linear(params, reading))
    )


def of_the_paper(params, model):
    """The scenes of Figs. 2–5, and the maps."""
    unit = params.time_unit
    angles, of_scenes = np.linspace(0.0, np.pi, POINTS), np.array(SCENE_ANGLES)
    found = {
        "quasi_static_map": quasi_static_map(params, angles, angles),
        "stability_map": stability_map(params, angles, angles),
        "natural_frequencies": natural_frequencies(params, angles, angles),
        "linear_pull": linear_pull_map(params, angles, angles, t_end=50.0 * unit),
        "at_scenes/quasi_static_map": quasi_static_map(params, of_scenes, of_scenes),
        "at_scenes/stability_map": stability_map(params, of_scenes, of_scenes),
        "at_scenes/natural_frequencies": natural_frequencies(
            params, of_scenes, of_scenes
        ),
        "validity_map": validity_map(
            params, angles, angles, t_end=200.0 * unit, model=model, workers=1
        ),
        "validity_boundary": contact_boundary(
            params, angles, angles, t_end=25.0 * unit, model=model, workers=1
        ),
    }
    runs = {
        name: (name, scene.t_end, model)
        for name, scene in SCENES.items()
        if scene.figure <= 5
    }
    runs |= {"F3_long": ("F3", GROWTH_HORIZON, model), "F4_long": ("F4", 3000.0, model)}
    runs["F2a_printed"] = ("F2a", 50.0, "A1-as-printed")
    for name, (scene, t_end, of_model) in runs.items():
        angles_of = SCENES[scene].alpha1, SCENES[scene].alpha2
        found[f"simulate/{name}"] = simulate(
            params, *angles_of, t_end=t_end * unit, model=of_model
        )
    return found


def of_one_sign(params):
    """What goes beyond the paper."""
    unit = params.time_unit
    angles = np.linspace(0.0, np.pi, POINTS)[::4]
    return {
        "assumptions": check_assumptions(params),
        "transient": transient_lifetimes(
            params, samples=8, t_end=4000.0 * unit, workers=1
        ),
        "hammering_map": hammering_map(
            params, angles, angles, t_end=50.0 * unit, workers=1
        ),
    }


def of_a4(params):
    """Periodic motions of A4."""
    scenes = {"F10": (0.5 * np.pi, np.pi, 2), "coupled": (0.3 * np.pi, 0.9 * np.pi, 2)}
    return {"harmonic_forms": compare_harmonic_forms(params, scenes)} | {
        f"backbone/{name}_mode{mode}": backbone(
            params, scene.alpha1, scene.alpha2, mode=mode
        )
        for name, scene in SCENES.items()
        if scene.figure > 5
        for mode in (1, 2)
    }


@pytest.fixture(scope="session")
def evidence(baseline, tmp_path_factory, worker_id):
    """What the paper shows as printed, and the corrected physics beside it.

    It takes 4 s, and is computed once for all test processes.
    """
    folder = tmp_path_factory.getbasetemp()
    kept = (folder if worker_id == "master" else folder.parent) / "evidence.pickle"
    with FileLock(f"{kept}.lock"):
        if not kept.exists():
            found = compute_evidence(baseline, "as_printed", beside=True)
            kept.write_bytes(pickle.dumps(found))
    return pickle.loads(kept.read_bytes())  # noqa: S301 (written by these tests)
