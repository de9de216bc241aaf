"""Levels that carry the paper's laws alone: Coulomb's with one coefficient, a linear contact, no
dashpots; and parameters that a law does not read.
"""

from collections.abc import Collection
from types import SimpleNamespace

import numpy as np

from squealpipe.laws.friction_laws import COULOMB, FALLING, LAWS, coefficient
from squealpipe.laws.tables import is_table
from squealpipe.parameters import DEFAULTS, TABLE, Parameters
from squealpipe.systems.inputs.values import brief

OF_OTHER_LAWS = {name for law in LAWS.values() for name in law.PARAMETERS} - set(
    LAWS[COULOMB].PARAMETERS
)
"""Parameters that some friction law reads, but not Coulomb's."""
WHY_A4 = (
    "A4 has families of periodic orbits by its first integral alone, which damping and friction "
    "that depends on speed destroy, and closed forms for a linear contact alone"
)


def extensions(params: Parameters) -> list[str]:
    """Parameters that give dashpots or other laws than the paper's, with one μ."""
    beyond = {
        name: getattr(params, name)
        for name, row in TABLE.items()
        if row.extension and name not in OF_OTHER_LAWS
    }
    if params.static_mu == params.mu:
        beyond.pop("mu_static")
    return [name for name, value in beyond.items() if value != DEFAULTS[name]]


def refuse_extensions(params: Parameters, who: str, why: str) -> None:
    """Stop a level that carries no :func:`extensions`."""
    if wrong := extensions(params):
        extended = ", ".join(
            f"{name} = {brief(getattr(params, name))}" for name in wrong
        )
        remedy = ", ".join(f"{name} = {DEFAULTS[name]!r}" for name in wrong)
        raise ValueError(
            f"{extended}: {who} cannot carry this ({why}); use model A1, or {remedy}"
        )


def refuse_scales(params: Parameters) -> None:
    """Stop linear models whose characteristic polynomial leaves the range of a double."""
    mass, stiffest = params.mass, max(params.k1, params.k2, params.k3)
    friction = max(abs(params.drag), params.static_mu) * stiffest
    limits = {
        name: (getattr(params, name), 1e-140, 1e140) for name in ("k1", "k2", "k3")
    }
    limits |= {
        "mu": (friction, 0.0, 1e140),
        "preload": (params.preload * stiffest, 0.0, 1e140),
    }
    limits |= {
        name: (getattr(params, name), 0.0, 1e70) for name in ("damping1", "damping2")
    }
    for name, (value, least, most) in limits.items():
        if not least <= value / mass < most:
            raise ValueError(
                f"{name} = {getattr(params, name)!r} with mass = {mass!r}: over the mass it is "
                f"{value / mass:.3g}, whose powers a number cannot hold; use other units"
            )


def refuse_unread(params: Parameters, varied: Collection[str]) -> None:
    """Stop a range of a parameter that no equation reads, or in whose place a law's file stands."""
    for name in varied:
        if why := _why_unread(params, "k3" if name == "kappa" else name, varied):
            raise ValueError(
                f"{name} cannot vary: {why}; leave it out, or give another law"
            )


def _why_unread(params: Parameters, name: str, varied: Collection[str]) -> str:
    law, contact = params.friction_law, params.contact_law
    if name in TABLE and not TABLE[name].enters_a1:
        return "A1 does not read it"
    if name in params.in_laws:
        return "the file of a law stands for it"
    if name == "preload" and is_table(contact):
        return "a table of contact is read at one preload"
    if name == "damping3" and contact != "dashpot":
        return f"contact_law = {brief(contact)} does not read it"
    if name in OF_OTHER_LAWS and law in LAWS:
        # from a static coefficient that is that of sliding nothing falls
        static = params.mu_static
        falls = "mu_static" in varied or (
            static is not None and ("mu" in varied or static != params.mu)
        )
        if name not in LAWS[law].PARAMETERS or (law in FALLING and not falls):
            return f"friction_law = {law!r} does not read it" + (
                " without mu_static" * (law in FALLING)
            )
    if name == "mu" and law not in LAWS:
        unknown = SimpleNamespace(**params.as_dict() | {"mu": np.nan})
        unknown.friction_law, unknown.friction_speed = law, params.friction_speed
        speeds = np.linspace(0.0, 2.0, 9) * max(abs(params.belt_speed), 1.0)
        if np.isfinite([coefficient(speed, unknown) for speed in speeds]).all():
            return "the law in Python does not read it"
    return ""
