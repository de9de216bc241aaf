"""Complex modes of structures, at one friction and belt speed or over some."""

from enum import IntEnum

from squealpipe.schema import DatasetSchema, Outcome, Variable, or_nan, outcome

NAME = "complex_modes"
FACTORS = {
    "mu": ("coefficient of friction", "1"),
    "belt_speed": ("belt speed", "m s-1"),
}
"""What modes can be computed over."""


class Onset(IntEnum):
    """Why a critical friction is what it is."""

    stable = 0
    located = 1
    unstable_throughout = 2
    not_followed = 3


def name_over(dims: tuple[str, ...]) -> str:
    """The schema's name for modes over these factors."""
    return f"{NAME} over {', '.join(dims)}" if dims else NAME


def _modes(dims: tuple[str, ...]) -> DatasetSchema:
    mode, contact = (*dims, "mode"), (*dims, "contact")
    along = tuple(dim for dim in dims if dim != "mu")
    return DatasetSchema(
        name=name_over(dims),
        title="Complex modes of a structure about steady sliding",
        coordinates={
            "mode": Variable(
                "mode, by ascending frequency at the first friction",
                dims=("mode",),
                dtype="i4",
            ),
            **{
                key: Variable(words, unit, (key,) if key in dims else ())
                for key, (words, unit) in FACTORS.items()
            },
            "contact": Variable(
                "name of the contact", dims=("contact",), dtype="U", optional=True
            ),
        },
        variables={
            "growth_rate": or_nan(
                "growth rate, real part of the eigenvalue",
                "s-1",
                mode,
                rtol=1e-6,
                atol=1e-6,
            ),
            "growth_rate_error": or_nan(
                "bound of the growth rate's error", "s-1", mode, volatile=True
            ),
            "frequency": or_nan("frequency", "Hz", mode, rtol=1e-8),
            "damping_ratio": or_nan(
                "damping ratio, negative growth rate over |s|", "1", mode, rtol=1e-6
            ),
            "unstable": Variable(
                "grows by more than the error", dims=mode, dtype="bool"
            ),
            "residual": or_nan("relative residual", "1", mode, volatile=True),
            "outcome": outcome(
                *mode,
                among=(
                    Outcome.converged,
                    Outcome.not_computed,
                    Outcome.no_sliding_state,
                ),
            ),
            "critical_mu": or_nan(
                "smallest friction at which growth leaves zero",
                "1",
                (*along, "mode"),
                rtol=1e-8,
            ),
            "onset": Variable(
                "why the critical friction is what it is",
                dims=(*along, "mode"),
                flags=Onset,
            ),
            "merges_with": Variable(
                "mode whose frequency meets this one's there, 0: none",
                dims=(*along, "mode"),
                dtype="i4",
            ),
            "normal_force": or_nan(
                "normal force in steady sliding, 0 where open",
                "N",
                contact,
                optional=True,
            ),
        },
    )


COMPLEX_MODES = tuple(
    _modes(dims) for dims in ((), ("mu",), ("belt_speed",), ("mu", "belt_speed"))
)
