"""Shares of the verdicts on a structure whose parameters scatter, and which of them decides.

Each parameter is multiplied by a lognormal factor of mean 1, which is positive however wide it is.
The sample is Saltelli's: its first matrix gives the shares, and with the others, in which one
parameter at a time is drawn anew, it gives Sobol's indices of each verdict.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import scipy
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.parameters import finite_number
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.structures.assess.cures import with_preload
from squealpipe.structures.assess.designs import Design, Structures, pushed
from squealpipe.structures.contact import face_of
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.schema.propensity import structure_propensity_schema
from squealpipe.structures.varied_friction import VariedFriction
from squealpipe.systems.inputs.values import brief
from squealpipe.systems.inputs.words import suggestion
from squealpipe.systems.processes import available_cores, run_shared
from squealpipe.systems.progress import with_progress
from squealpipe.validation import Seed, Tolerance, Whole, Workers
from squealpipe.vibration import sobol
from squealpipe.vibration.shares import wilson_interval

Change = Callable[[ContactStructure, float], ContactStructure]


@recorded(
    model="structure with exact contact and friction",
    method="quasi-random sample; Sobol indices from replicates",
)
def structure_propensity(
    structure: Any,
    *,
    relative_std: Mapping[str, Any],
    samples: Whole = 256,
    seed: Seed = 0,
    tol: Tolerance = 1e-9,
    workers: Workers = None,
) -> xr.Dataset:
    """Return the shares of the verdicts on a structure; see :func:`squealpipe.propensity`."""
    if samples < 64 or samples & (samples - 1):
        raise ValueError(
            f"samples = {samples!r}: a power of 2 of at least 64 is needed"
        )
    design = Design.of(structure.with_common_mu())
    changes = _changes(design.whole, relative_std)
    factors = {
        name: _factor(f"relative_std: {name}", relative_std[name]) for name in changes
    }
    if design.obstacle:
        raise ValueError(f"the structure cannot be run: {design.obstacle}")
    judge = partial(_judged, design, list(changes.values()), tol, workers)
    judged = sobol.judged_matrices(judge, factors, samples, seed)
    happens = judged[0] > 0.5
    counts = happens.sum(axis=1)
    low, high = np.transpose([wilson_interval(int(count), samples) for count in counts])
    # runs of structures are dear: an index within ±0.15, three times as wide as of pads, still
    # tells which parameter decides
    widest = 0.15
    table = sobol.supported_indices(list(np.moveaxis(judged, 1, 0)), 1, widest)
    del table["half_width_by_size"]
    supported = np.isfinite(table["total_order"]).all(axis=1)
    return build(
        structure_propensity_schema,
        {
            "share": counts / samples,
            "share_low": low,
            "share_high": high,
            **table,
            "relative_std": np.array(
                [_relative(name, relative_std[name]) for name in changes]
            ),
            "judged": samples,
            "n_modes": design.n_modes or design.whole.size,
            "outcome": np.where(supported, Outcome.converged, Outcome.unresolved),
        },
        {"verdict": [each.name for each in Verdict], "input": list(changes)},
    )


def _judged(
    design: Design,
    changes: list[Change],
    tol: float,
    workers: int | None,
    values: np.ndarray,
) -> np.ndarray:
    """Return whether each verdict is that of each sample, (verdicts, samples).

    Args:
        values: factors, (changes, samples).
    """
    count = values.shape[1]
    family = Structures(tol, 0, 0, 1)

    def fill(arrays: dict[str, np.ndarray], first: int, stride: int) -> None:
        for place in with_progress(range(first, count, stride)):
            whole = design.whole
            for change, factor in zip(changes, values[:, place].tolist(), strict=True):
                whole = change(whole, factor)
            start = pushed(design.changed(whole))
            verdict = Verdict.undetermined
            if start is not None:
                (run,) = family.settled([start])
                verdict = run.verdict
            arrays["verdict"][place] = verdict

    filled = run_shared(
        fill,
        {"verdict": ((count,), np.int64)},
        jobs=count,
        workers=available_cores() if workers is None else workers,
    )
    return np.array([filled["verdict"] == each for each in Verdict])


def _relative(name: str, written: Any) -> float:
    value = finite_number(f"relative_std: {name}", written, "1")
    if not 0.0 < value <= 1.0:
        raise ValueError(
            f"relative_std: {name} = {brief(written)}: a standard deviation over the value, above "
            "0 and up to 1, is needed"
        )
    return value


def _factor(title: str, written: Any) -> Any:
    """Return the lognormal distribution of mean 1 and a relative standard deviation."""
    deviation = _relative(title.partition(": ")[2], written)
    spread = math.sqrt(math.log1p(deviation**2))
    return scipy.stats.lognorm(spread, scale=1.0 / math.sqrt(1.0 + deviation**2))


def _changes(structure: ContactStructure, names: Any) -> dict[str, Change]:
    """Return what each factor does to the structure, by name.

    Raises:
        ValueError: a name that is unknown, or scatters nothing.
    """
    if not isinstance(names, Mapping) or not names:
        raise ValueError(
            f"relative_std = {brief(names)}: {{'mu': 0.1}} or the like is needed"
        )
    known = known_inputs(structure)
    # Quantities that scatter for a face or contact alone too, like ``mu_lining``.
    of_contacts = ("mu", "contact_stiffness", "preload")
    for name in names:
        if name not in known:
            raise ValueError(f"relative_std: {name!r}: {suggestion(str(name), known)}")
        for quantity in of_contacts:
            if name.startswith(f"{quantity}_") and quantity in names:
                raise ValueError(
                    f"relative_std: {quantity} and {name} scatter the same; keep one"
                )
    return {name: known[name] for name in names}


def known_inputs(structure: ContactStructure) -> dict[str, Change]:
    """Return everything that can scatter: name → change of a structure by a factor."""
    own = structure.has_own_mu
    known: dict[str, Change] = {
        "contact_stiffness": partial(_with_contacts, "stiffness", np.ones_like(own)),
        "preload": with_preload,
        "belt_speed": lambda each, factor: each.with_(
            belt_speed=factor * each.belt_speed
        ),
    }
    if np.any(structure.modal_damping):
        known["modal_damping"] = lambda each, factor: each.with_(
            modal_damping=(factor * np.asarray(each.modal_damping)).tolist()
        )
    if not own.all():
        known["mu"] = partial(_with_friction, ~own)
    names = [face_of(contact.name) or contact.name for contact in structure.contacts]
    for group in dict.fromkeys(names):
        chosen = np.array(names) == group
        known[f"contact_stiffness_{group}"] = partial(
            _with_contacts, "stiffness", chosen
        )
        known[f"preload_{group}"] = partial(_with_contacts, "preload", chosen)
        if own[chosen].all():
            known[f"mu_{group}"] = partial(_with_friction, chosen)
    return known


def _with_friction(
    chosen: np.ndarray, structure: ContactStructure, factor: float
) -> ContactStructure:
    """Multiply the friction of some contacts by a factor, and limits of stick with it."""
    varied = VariedFriction(chosen, is_factor=True)
    return varied.changed(structure, factor, limit=factor)


def _with_contacts(
    key: str, chosen: np.ndarray, structure: ContactStructure, factor: float
) -> ContactStructure:
    """Multiply a number of some contacts."""
    contacts = [
        contact.scaled(**{key: factor}) if is_chosen else contact
        for contact, is_chosen in zip(structure.contacts, chosen, strict=True)
    ]
    return structure.with_(contacts=contacts)
