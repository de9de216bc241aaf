"""Schema of the unstable modes of a structure that squeal: modes, attractors, random starts."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from squealpipe.codes import Verdict, Worded
from squealpipe.schema import (
    DatasetSchema,
    Outcome,
    Variable,
    count,
    flag,
    or_nan,
    outcome,
    text,
    whether,
)
from squealpipe.schema.meshes import mesh_coordinates, mesh_entries
from squealpipe.systems.datasets.agreement import Listing

NO_ATTRACTOR = -1
GIVE_DAMPING = (
    "nothing damps the structure, so that a vibration gains energy for long before it settles; "
    "give it the damping that it has, like modal_damping: 0.001 in its file (a ratio, of all modes)"
)
"""Advice on a structure without damping."""


@dataclass(frozen=True)
class SquealLimits:
    """Limits within which squeal is searched."""

    most_modes: int = 32
    """Modes up to which a structure is run as it is, and to which others are reduced at most,
    unless their contacts need more."""
    most_damping: float = 0.2
    """Largest ratio of damping that is tried as a remedy."""
    above: float = 1.01
    """Friction at which motions just above the onset are, over that of the onset."""
    narrow: float = 2e-3
    """Distance of frictions between which a motion is known to die, over that of the onset."""


JUST_ABOVE = -1
"""Track of what a push just above the onset ends in; others are of an attractor."""


class Kind(Worded):
    """Kind of a settled motion."""

    undetermined = 0
    steady_sliding = 1
    cycle = 2
    torus = 3
    irregular = 4

    @property
    def words(self) -> str:
        """The kind as people read it."""
        return "quasi-periodic" if self is Kind.torus else super().words


class OnsetKind(IntEnum):
    """Fate, below the onset of instability, of the motion that squeals just above."""

    undetermined = 0
    supercritical = 1
    """it dies there"""
    subcritical = 2
    """it lasts below"""


def _of_onset(long_name: str, units: str = "1", *dims: str, **other: Any) -> Variable:
    """One that is there if the onset was asked for."""
    return or_nan(long_name, units, dims, optional=True, **other)


def _of_whole(long_name: str, units: str = "1", *dims: str, **other: Any) -> Variable:
    """One that says how the modes kept agree with the whole; a round-off of 0 where they are it."""
    other = {"volatile": True, **other} if "rtol" not in other else other
    return or_nan(long_name, units, dims, **other)


def _level(
    long_name: str, units: str = "1", *, rtol: float = 0.05, optional: bool = False
) -> Variable:
    return or_nan(
        long_name, units, ("attractor",), rtol=rtol, atol=1e-3, optional=optional
    )


def _of_share(long_name: str) -> Variable:
    return Variable(long_name, dims=("attractor",), rtol=0.3, atol=0.1)


def _of_contact(long_name: str, units: str = "1") -> Variable:
    return or_nan(long_name, units, ("attractor", "contact"), rtol=0.05, atol=0.01)


squealing_schema = DatasetSchema(
    name="squealing_modes",
    title="Which unstable modes of a structure squeal, how loud, and with how much contact loss",
    coordinates={
        "mode": count(
            "unstable mode of steady sliding, numbered as by complex_modes", "mode"
        ),
        "attractor": count(
            "what starts settle to, by share of random starts", "attractor"
        ),
        "contact": text("name of the contact", "contact"),
        "sample": count("number of the random start", "sample"),
        "pole": count("mode of steady sliding, by frequency", "pole"),
        **mesh_coordinates,
    },
    variables={
        "verdict": flag(
            "what steady sliding ends in after a push of 1 % along its least stable mode",
            Verdict,
        ),
        "quiet_unless_struck": whether(
            "quiet from steady sliding, but some random starts end elsewhere"
        ),
        "growth_rate": Variable("growth rate", "s-1", ("mode",), rtol=1e-6),
        "frequency": Variable("frequency", "Hz", ("mode",), rtol=1e-8),
        "critical_mu": or_nan(
            "smallest friction at which growth leaves zero", "1", ("mode",), rtol=1e-8
        ),
        "mode_frequency_error": _of_whole(
            "difference of its frequency from the whole structure's", "Hz", "mode"
        ),
        "mode_growth_rate_error": _of_whole(
            "difference of its growth rate from the whole structure's", "s-1", "mode"
        ),
        "mode_is_sure": whether(
            "whether it grows by more than that difference", "mode"
        ),
        "missing_frequency": _of_whole(
            "frequency of an unstable mode of the whole structure that is missing in the "
            "modes kept",
            "Hz",
            "missing",
            rtol=1e-8,
        ),
        "missing_growth_rate": _of_whole(
            "its growth rate", "s-1", "missing", rtol=1e-6
        ),
        "same_modes_grow": whether(
            "whether the modes that grow are those of the whole structure"
        ),
        "whole_decays": whether(
            "whether every small motion of the whole structure dies out"
        ),
        "modes_that_would_do": count(
            "modes kept that agree with the whole structure within 1 %, where these do not; "
            "0: not needed, or not known"
        ),
        "static_responses": count(
            "of the modes in which it was run, how many are static responses of contact forces "
            "(attachment modes)"
        ),
        "degrees_of_freedom": count("of the whole structure"),
        "is_undamped": whether("whether nothing damps the structure"),
        **mesh_entries,
        "frequency_max": _of_whole("end of the band that was compared, NaN: all", "Hz"),
        "damping_beyond_band": _of_whole(
            "damping ratio that coordinates beyond the band were given, so that no mode grows "
            "there; 0: none"
        ),
        "ends_in": count(
            "attractor of a start of 1 % along this mode, -1: undetermined", "mode"
        ),
        "squeals": whether(
            "whether, of the unstable modes, this one is nearest in frequency to that motion",
            "mode",
        ),
        "grows_without_bound": whether(
            "whether a start of 1 % along this mode grows beyond all that contacts limit",
            "mode",
            optional=True,
        ),
        "sticks_for_good": whether(
            "whether a start of 1 % along this mode ends with a contact that sticks for good",
            "mode",
            optional=True,
        ),
        "time_to_squeal": or_nan(
            "time from there until the kinetic energy first reaches half its settled value",
            "s",
            ("mode",),
            rtol=0.2,
        ),
        "kind": flag("kind of motion", Kind, "attractor"),
        "motion": flag(
            "what is heard: it squeals if contact is kept, hammers if it is lost repeatedly",
            Verdict,
            "attractor",
        ),
        "dominant_frequency": _level(
            "strongest line of the kinetic energy", "Hz", rtol=1e-2
        ),
        "frequency_resolution": or_nan(
            "resolution of the spectrum", "Hz", ("attractor",), volatile=True
        ),
        "nearest_mode": count(
            "mode nearest to that line, an unstable one where one is within 2 % of either",
            "attractor",
        ),
        "frequency_shift": _level(
            "dominant frequency less that of the nearest mode", "Hz", rtol=0.1
        ),
        "period": or_nan(
            "period of the cycle, closed by the exact map",
            "s",
            ("attractor",),
            rtol=1e-6,
        ),
        "events_per_period": count("events in it, 0 where it is no cycle", "attractor"),
        "largest_multiplier": or_nan(
            "largest modulus of its multipliers, the trivial one left out",
            "1",
            ("attractor",),
            rtol=1e-4,
        ),
        "multiplier_real": or_nan(
            "real part of its multipliers",
            dims=("attractor", "multiplier"),
            volatile=True,
        ),
        "multiplier_imag": or_nan(
            "imaginary part", dims=("attractor", "multiplier"), volatile=True
        ),
        "divergence_rate": or_nan(
            "growth rate of the distance between neighbouring motions",
            "s-1",
            ("attractor",),
            volatile=True,
        ),
        "velocity_rms": _level("rms speed of vibration, all contacts", "m s-1"),
        "refined_n_modes": count(
            "modes in which the motions were run on, to see how their level changes; 0: none",
            optional=True,
        ),
        "refined_velocity_rms": _level(
            "rms speed of vibration, all contacts, in refined_n_modes modes; NaN: not known",
            "m s-1",
            optional=True,
        ),
        "refined_motion": flag(
            "what is heard in refined_n_modes modes",
            Verdict,
            "attractor",
            optional=True,
        ),
        "velocity_peak": _level("largest speed of vibration of a contact", "m s-1"),
        "kinetic_energy": _level("mean kinetic energy of vibration", "J", rtol=0.1),
        "contact_velocity_rms": _of_contact("rms speed of vibration", "m s-1"),
        "separated_fraction": _of_contact("share of the time without contact"),
        "stick_fraction": _of_contact("share of the time in stick"),
        "peak_force": _of_contact(
            "largest normal force over the preload (over that of steady sliding if it is 0), NaN "
            "where the contact is open then"
        ),
        "peak_normal_force": _of_contact("largest normal force", "N"),
        "sliding_force": or_nan(
            "normal force in steady sliding, 0 where the contact is open",
            "N",
            ("contact",),
            rtol=1e-6,
        ),
        "impacts_per_period": _of_contact(
            "returns to contact in a period of the dominant frequency"
        ),
        "count": count("random starts that end here", "attractor", rtol=0.3),
        "share": _of_share("share of the random starts that end here"),
        "share_low": _of_share("low end of its 95 % Wilson interval"),
        "share_high": _of_share("high end of its 95 % Wilson interval"),
        "share_undetermined": Variable(
            "share of random starts that did not settle within the horizon", atol=0.1
        ),
        "share_unbounded": Variable(
            "share of random starts that grow beyond all that contacts limit",
            atol=0.1,
            optional=True,
        ),
        "ends_at": count("attractor of the random start, -1: undetermined", "sample"),
        "start_energy": Variable(
            "energy of the random start over that of the preload", dims=("sample",)
        ),
        "settled_by": Variable(
            "time run until it had settled, or to the end",
            "s",
            ("sample",),
            volatile=True,
        ),
        "pole_frequency": Variable("frequency of the mode", "Hz", ("pole",), rtol=1e-8),
        "pole_growth_rate": Variable(
            "growth rate of the mode", "s-1", ("pole",), rtol=1e-6, atol=1e-6
        ),
        "pole_frequency_error": _of_whole(
            "difference of its frequency from the whole structure's, NaN: not known",
            "Hz",
            "pole",
        ),
        "pole_growth_rate_error": _of_whole(
            "difference of its growth rate from the whole structure's, NaN: not known",
            "s-1",
            "pole",
        ),
        **{
            name: or_nan(
                f"{words} of a state of the motion, in the coordinates of its run",
                units,
                ("attractor", "coordinate"),
                volatile=True,
            )
            for name, words, units in (
                ("displacement", "displacements", "m"),
                ("velocity", "velocities", "m s-1"),
            )
        },
        "stretch": or_nan(
            "stretch of the tangential spring at the end of the runs, 0 without one",
            "m",
            ("attractor", "contact"),
            volatile=True,
            optional=True,
        ),
        "line_frequency": or_nan(
            "frequency of the spectrum", "Hz", ("line",), volatile=True
        ),
        "spectrum": or_nan(
            "amplitude of the velocities of all modes, over the total",
            "1",
            ("attractor", "line"),
            volatile=True,
        ),
        "added_damping": or_nan(
            "smallest ratio of damping, added to every mode, from which none grows",
            rtol=1e-5,
        ),
        "added_damping_outcome": flag(
            "whether it is known: not reached up to the largest ratio tried, or unresolved "
            "where the modes kept do not give it",
            Outcome,
            optional=True,
        ),
        "onset_mu": _of_onset(
            "critical friction of steady sliding: the smallest of all modes", rtol=1e-8
        ),
        "onset_frequency": _of_onset(
            f"frequency of the mode that grows at {SquealLimits.above:g} of it",
            "Hz",
            rtol=1e-6,
        ),
        "onset_kind": flag(
            f"whether what a small push ends in at {SquealLimits.above:g} of it dies at the onset "
            "(supercritical) or lasts below (subcritical)",
            OnsetKind,
            optional=True,
        ),
        "squeals_below_critical": whether(
            "whether a motion that was followed lasts below the critical friction",
            optional=True,
        ),
        "hysteresis": _of_onset(
            "critical friction less the smallest at which a motion that was followed dies",
            rtol=0.05,
            atol=1e-3,
        ),
        "onset_outcome": flag(
            "why the kind of onset is what it is", Outcome, optional=True
        ),
        "track_attractor": count(
            f"attractor that is followed as friction falls, {JUST_ABOVE}: what a small push "
            f"ends in at {SquealLimits.above:g} of the critical friction",
            "track",
            optional=True,
        ),
        "mu_dies": _of_onset(
            "friction at which it dies as friction falls: of the fold where that is located",
            "1",
            "track",
            rtol=5e-3,
        ),
        "mu_dies_is_fold": whether(
            "whether it is where the exact map has its cycle meet an unstable one",
            "track",
            optional=True,
        ),
        "mu_dies_low": _of_onset(
            "largest friction at which it was seen to die", "1", "track", rtol=5e-3
        ),
        "mu_dies_high": _of_onset(
            "smallest friction at which it was seen to last, at most the critical one",
            "1",
            "track",
            rtol=5e-3,
        ),
        **{
            f"track_{name}": or_nan(
                long_name, units, ("track", "step"), optional=True, volatile=True
            )
            for name, long_name, units in (
                ("mu", "friction at which the motion lasts, from above", "1"),
                ("velocity_rms", "rms speed of vibration there, all contacts", "m s-1"),
                ("frequency", "of the mode at rest that moves most", "Hz"),
            )
        },
        **{
            f"unstable_{name}": or_nan(
                long_name, units, ("track", "turn"), optional=True, volatile=True
            )
            for name, long_name, units in (
                ("mu", "friction of the unstable cycle, from the fold on", "1"),
                (
                    "velocity_rms",
                    "its rms speed of vibration: smaller ones like it die out",
                    "m s-1",
                ),
            )
        },
        "track_outcome": flag(
            "whether the motion was followed to where it dies",
            Outcome,
            "track",
            optional=True,
        ),
        "n_modes": count("modes in which the structure was run"),
        "frequency_error": or_nan(
            "largest relative error of an unstable frequency, from the reduction"
        ),
        "growth_rate_error": or_nan(
            "largest error of an unstable growth rate, over the larger of it and 1 % of ω"
        ),
        "outcome": outcome("attractor", among=(Outcome.converged, Outcome.unresolved)),
    },
    lists={"attractor": Listing(kinds=("kind",))},
)
