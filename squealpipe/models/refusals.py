"""Levels that carry the paper's laws alone: Coulomb's with one coefficient, a linear contact, no
dashpots.
"""

from squealpipe.laws.friction_laws import COULOMB, LAWS
from squealpipe.parameters import DEFAULTS, TABLE, Parameters, brief

WHY_A4 = (
    "A4 has families of periodic orbits by its first integral alone, which damping and friction "
    "that depends on speed destroy, and closed forms for a linear contact alone"
)
WHY_CIRCLES = "its curves are circles of the undamped model A3 alone"


def extensions(params: Parameters) -> list[str]:
    """Parameters that give dashpots or other laws than the paper's, with one μ."""
    of_other_laws = {name for law in LAWS.values() for name in law.PARAMETERS} - set(
        LAWS[COULOMB].PARAMETERS
    )
    given = {
        name: getattr(params, name)
        for name, row in TABLE.items()
        if row.extension and name not in of_other_laws
    }
    if params.static_mu == params.mu:
        given.pop("mu_static")
    return [name for name, value in given.items() if value != DEFAULTS[name]]


def refuse_extensions(params: Parameters, who: str, why: str) -> None:
    """Stop a level that carries no :func:`extensions`."""
    if wrong := extensions(params):
        found = ", ".join(f"{name} = {brief(getattr(params, name))}" for name in wrong)
        remedy = ", ".join(f"{name} = {DEFAULTS[name]!r}" for name in wrong)
        raise ValueError(
            f"{found}: {who} cannot carry this ({why}); use model A1, or {remedy}"
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
