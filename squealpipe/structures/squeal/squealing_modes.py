"""Find which unstable modes of a structure squeal, and with what motion, as a dataset.

Idea: linear growth says which modes leave steady sliding, not where they end. Each is pushed by 1 %
along itself and run until its motion has settled; random starts show motions that no push leads to.
Equal motions are one attractor. A motion that leaves what repels it is run on. Invariant:
statistics begin after a motion has settled. Cost: nearly all is in the runs, some thousand periods
of the slowest unstable mode each.
"""

from __future__ import annotations  # help shows Angle, not its checks

from typing import Any

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.schema import Outcome, build
from squealpipe.schema.origin import recorded
from squealpipe.structures.meshes.datasets import mesh_variables
from squealpipe.structures.schema.squealing import (
    GIVE_DAMPING,
    NO_ATTRACTOR,
    Kind,
    squealing_schema,
)
from squealpipe.structures.squeal.attractors import grouped, is_same
from squealpipe.structures.squeal.hysteresis import hysteresis
from squealpipe.structures.squeal.kinds import Described, described
from squealpipe.structures.squeal.plant import PUSH_OF_A_MODE, Plant
from squealpipe.structures.squeal.refined_levels import refined_levels
from squealpipe.structures.squeal.remedies import added_damping
from squealpipe.structures.squeal.settling import (
    arrival,
    settings_of,
    settle,
    settle_on,
    so_far,
)
from squealpipe.structures.squeal.windows import (
    Running,
    StructureWindows,
    merged,
    still,
)
from squealpipe.systems.inputs.words import duration
from squealpipe.systems.progress import partial_answer, stage, stop_is_asked
from squealpipe.validation import Natural, Positive, Seed, Tolerance, Workers, checked
from squealpipe.vibration.settled_runs import SettledRun
from squealpipe.vibration.shares import wilson_interval
from squealpipe.vibration.verdicts import heard


@recorded(
    model="structure with exact contact and friction",
    method="Taylor series with located events; cycles by the exact map",
)
def squealing_modes(
    structure: Any,
    *,
    samples: Natural = 64,
    t_end: Positive | None = None,
    seed: Seed = 0,
    onset: bool = False,
    tol: Tolerance = 1e-12,
    workers: Workers = None,
) -> xr.Dataset:
    """Find the unstable modes that squeal: run from small pushes and random starts until they
    settle.

    A start of 1 % is pushed along each unstable mode of steady sliding, in a reduced structure up
    to its ``frequency_max`` (its energy is 1e-4 of what the preload stores in the contacts).
    ``samples`` more are uniform in the ball of that energy. Every event is located. At first a push
    runs for as long as its own mode needs to grow beyond small motions, a random start for as long
    as the fastest mode does; windows of growing length follow, until the statistics of two agree.
    Motions with the same statistics are one attractor. Each is then run on: neighbours that run
    away show irregular motion, and the exact map closes cycles.

    Args:
        structure: a :class:`squealpipe.Structure`; one of more than 32 degrees of freedom is
            reduced first, to the fewest modes within 1 %, at most 32 or four a contact, and beyond
            1000 must be (see ``Structure.reduce``); one that was reduced is run as it is. At most
            512 modes and 512 contacts; exact cycles, with multipliers, up to 32 and 16.
        samples: random starts.
        t_end: longest time of a run, s; by default 8000 periods of the slowest unstable mode,
            beyond the time in which it grows.
        seed: of the random starts.
        onset: also follow what squeals down in friction until it dies, at its own friction and
            just above the onset of instability; costs about as much as the rest.
        tol: tolerance of the Taylor integrator.
        workers: processes; None takes all cores.

    Returns:
        Dataset ``squealing_modes``: over ``mode`` the unstable modes, and which attractor they end
        in, with the errors of the reduction; over ``missing`` unstable modes of the whole structure
        that the reduced one lacks; over ``attractor`` kind, frequency, level, and by contact the
        shares of time separated and in stick; ``share`` of the random starts with its interval;
        ``refined_velocity_rms`` of each in ``refined_n_modes``, twice as many (64 at least), where
        it is run on; ``verdict``. It is undetermined where an unstable mode is missing or the sign
        of a growth rate is within its error (``modes_that_would_do`` would decide; nothing is run),
        and where nothing could be run: the attribute ``not_run`` says why. With ``onset`` also
        ``onset_kind`` (supercritical, or subcritical: squeal lasts below the critical friction),
        ``mu_dies`` of each motion that was followed, over ``track``, ``squeals_below_critical`` and
        ``hysteresis``.

    Raises:
        ValueError: there is no steady sliding; no contact; a structure that is too large; or
            ``onset`` where every contact has a ``mu`` of its own.
    """
    structure = structure.with_common_mu()
    if onset and structure.contacts and structure.has_own_mu.all():
        raise ValueError(
            "onset = True lowers the structure's mu, but every contact has one of its own; leave "
            "mu out of those that are to change, and give it to the structure"
        )
    return squealing_of(
        Plant(structure),
        samples=samples,
        t_end=t_end,
        seed=seed,
        onset=onset,
        refines=True,
        tol=tol,
        workers=workers,
    )


@checked
def squealing_of(
    plant: Any,
    *,
    samples: Natural,
    t_end: Positive | None,
    seed: Seed = 0,
    onset: bool = False,
    refines: bool = False,
    tol: Tolerance,
    workers: Workers,
) -> xr.Dataset:
    """Return what :func:`squealing_modes` does, of a plant whose system the caller goes on using.

    Tracing its system and writing its code takes seconds with eight contacts.

    Args:
        refines: whether motions are run on in more coordinates, for how far their level is right,
            and the damping that stops what grows is sought.
    """
    growth = plant.spectrum.values.real
    places = plant.asked
    if not places.size:  # nothing grows: a push along the mode that decays slowest
        places = np.array([growth.argmax()])
    pushes = [plant.pushed(int(place), PUSH_OF_A_MODE) for place in places]
    drawn = plant.random_states(samples, seed)
    how = Running(tol, seed, workers)
    starts = np.concatenate([pushes, drawn])
    # a random start is loud from its begin: what grows fastest in it decides
    rates = np.concatenate([growth[places], np.full(samples, growth.max())])
    settled = []
    if not plant.obstacle:
        if plant.is_undamped and plant.unstable.size:
            partial_answer(lambda: GIVE_DAMPING)
        how, seconds = settings_of(plant, starts[-1], rates, t_end, how)
        with stage(_told_before(plant, len(starts), seconds, how)):
            settled = settle(plant, starts, rates, t_end, how)
    with stage("kinds of the motions that have settled"):
        settled, numbers, modes = _attractors(plant, settled, len(pushes), t_end, how)
    if plant.obstacle:
        numbers = np.full(len(starts), NO_ATTRACTOR)
    members = _members(plant, settled, numbers) if settled else []
    of_mode = _of_modes(plant, settled[: len(pushes)], numbers, modes)
    of_attractor = _of_attractors(plant, members, modes)
    shares = _shares(numbers[len(pushes) :], len(members))
    if unbounded := [run for run in settled[len(pushes) :] if run.unbounded]:
        shares["share_unbounded"] = len(unbounded) / samples
    if refines and not plant.obstacle:
        with stage("levels in more modes"):
            motions = [runs[0] for runs in members]
            refined = refined_levels(plant, motions, t_end, how)
            of_attractor |= {
                "refined_n_modes": refined.n_modes,
                "refined_velocity_rms": refined.speeds,
                "refined_motion": refined.verdicts,
            }
    below = {}
    if onset and not plant.obstacle and not stop_is_asked():
        with stage("the friction at which the squeal dies"):
            below = hysteresis(plant, [runs[0] for runs in members], how)
    verdict = _verdict(plant, int(numbers[0]), modes, of_attractor["motion"])
    loud = [index for index, mode in enumerate(modes) if not members[index][0].quiet]
    drawn_in = set(numbers[len(pushes) :].tolist())
    damping, damping_outcome = np.nan, Outcome.not_computed
    if refines:
        with stage("the damping that stops it"):
            damping, damping_outcome = added_damping(plant)
    with stage("the number of modes that would do"):
        of_whole = _of_whole(plant)
    of_mesh, mesh_coordinates = mesh_variables(plant.structure)
    return build(
        squealing_schema,
        {
            **of_mode,
            **of_attractor,
            **shares,
            **below,
            "verdict": verdict,
            "quiet_unless_struck": verdict is Verdict.quiet
            and bool(drawn_in & set(loud)),
            "ends_at": numbers[len(pushes) :],
            "start_energy": plant.sizes(drawn - plant.sliding) ** 2 / plant.energy,
            "settled_by": np.array(
                [run.elapsed for run in settled[len(pushes) :]] or np.zeros(samples)
            ),
            "pole_frequency": plant.frequencies,
            "pole_growth_rate": plant.spectrum.values.real,
            "added_damping": damping,
            "added_damping_outcome": damping_outcome,
            **of_whole,
            **of_mesh,
        },
        {
            "mode": plant.numbers[plant.unstable],
            "attractor": np.arange(len(members)),
            "contact": plant.contacts,
            "sample": np.arange(samples),
            "pole": plant.numbers,
            **mesh_coordinates,
        },
        {"not_run": plant.obstacle or ""}
        | ({"interrupted": _interrupted(plant, settled)} if stop_is_asked() else {}),
    )


def _told_before(plant: Plant, count: int, seconds: float, how: Running) -> str:
    """Return the name of the stage of runs: with its time, if it is long, and what shortens it."""
    told = f"runs of {count} starts in {plant.size} modes"
    if not how.cost:
        return told
    workers = how.workers or 1
    processes = f" on {workers} processes" if workers > 1 else ""
    told += f": about {duration(seconds / workers)}{processes}"
    of_face = any(contact.origin is not None for contact in plant.structure.contacts)
    fewer = "fewer samples" + (
        ", or fewer contacts of a face (points: 12 in its YAML, points=12 in Python) if "
        "complex modes then grow as fast"
        if of_face
        else ""
    )
    partial_answer(lambda: f"{told}; shorter with {fewer}")
    return told


def _interrupted(plant: Plant, settled: list[SettledRun]) -> str:
    """Say what the runs had come to when their end was asked for."""
    if not settled:
        return "yes"
    elapsed = max(run.elapsed for run in settled)
    return so_far(plant, settled, len(settled), elapsed)


def _verdict(
    plant: Plant, first: int, modes: list[Described], motions: np.ndarray
) -> Verdict:
    """Return what the push along the least stable mode tells about the whole structure.

    Args:
        first: attractor that the push ends in.
        motions: verdict on each attractor.
    """
    # a push lasts where nothing damps it, in the modes that are run and in the whole
    decided = plant.unstable.size or (plant.decays and plant.agreement.decays)
    if not decided or not plant.agreement.holds or first == NO_ATTRACTOR:
        return Verdict.undetermined
    if modes[first].kind is Kind.undetermined:
        return Verdict.undetermined
    # within the band the same modes grow; a motion beyond it may be one that the whole has not
    if motions[first] != Verdict.quiet and np.isfinite(modes[first].frequency):
        away = np.abs(plant.frequencies - modes[first].frequency)[plant.unstable]
        if away.size and plant.unstable[away.argmin()] in plant.agreement.unsure:
            return Verdict.undetermined
    return Verdict(int(motions[first]))


def _of_whole(plant: Plant) -> dict[str, Any]:
    """Return variables on how far the modes run agree with those of the whole structure."""
    agreement, origin = plant.agreement, plant.structure.reduced_from
    unstable = plant.unstable
    return {
        "mode_frequency_error": agreement.frequency_errors[unstable],
        "mode_growth_rate_error": agreement.growth_errors[unstable],
        "mode_is_sure": ~np.isin(unstable, agreement.unsure),
        "pole_frequency_error": agreement.frequency_errors,
        "pole_growth_rate_error": agreement.growth_errors,
        "missing_frequency": agreement.missing.imag / (2.0 * np.pi),
        "missing_growth_rate": agreement.missing.real,
        "same_modes_grow": agreement.holds,
        "whole_decays": agreement.decays,
        "modes_that_would_do": plant.enough or 0,
        "degrees_of_freedom": plant.size if origin is None else origin.whole.size,
        "frequency_max": np.nan
        if origin is None or origin.frequency_max is None
        else origin.frequency_max,
        "damping_beyond_band": plant.damping_beyond,
        "is_undamped": plant.is_undamped,
        "n_modes": plant.size,
        "static_responses": plant.structure.record.get("static_responses", 0),
        "frequency_error": agreement.errors.frequency,
        "growth_rate_error": agreement.errors.growth,
        "sliding_force": plant.sliding_forces,
    }


def _attractors(
    plant: Plant,
    settled: list[SettledRun],
    pushes: int,
    t_end: float | None,
    how: Running,
) -> tuple[list[SettledRun], np.ndarray, list[Described]]:
    """Return settled runs, the number of the attractor of each, and all attractors.

    Runs whose motion leaves what repels it, as a cycle that a second mode destabilizes, go on: of
    each motion one first, the others where that one has left.
    """
    known: dict[int, Described] = {}

    def of(run: SettledRun) -> Described:
        if id(run) not in known:
            known[id(run)] = described(plant, run, how)
        return known[id(run)]

    # a run is continued because it leaves what it seemed to have settled to; one that does so
    # again and again is undetermined
    most_continuations = 4
    for turn in range(most_continuations + 1):
        numbers = grouped(settled, pushes)
        members = _members(plant, settled, numbers)
        modes = [of(runs[0]) for runs in members]
        done = turn == most_continuations or stop_is_asked()
        if done or not any(mode.leaves for mode in modes):
            break
        for runs, mode in zip(members, modes, strict=True):
            if not mode.leaves:
                continue
            (first,) = settle_on(plant, runs[:1], t_end, how)
            going = [first]
            if first.agrees:
                known[id(first)] = described(plant, first, how, mode.late_growth)
            if not first.agrees or not is_same(runs[0], first):
                going += settle_on(plant, runs[1:], t_end, how) if runs[1:] else []
            for old, new in zip(runs, going, strict=False):
                place = next(at for at, run in enumerate(settled) if run is old)
                settled[place] = new
    return settled, numbers, modes


def _members(
    plant: Plant, settled: list[SettledRun], numbers: np.ndarray
) -> list[list[SettledRun]]:
    """Return the runs of each attractor, the longest first: least of a transient is left in it.

    Of an irregular motion the run whose neighbours were followed until they were lost comes first,
    whatever its length: they need not be followed again.
    """
    followed = {id(run) for run, apart in plant.neighbours if apart.loses_neighbours}
    return [
        sorted(
            (run for run, at in zip(settled, numbers, strict=True) if at == number),
            key=lambda run: (id(run) not in followed, -run.elapsed),
        )
        for number in range(numbers.max(initial=NO_ATTRACTOR) + 1)
    ]


def _of_modes(
    plant: Plant, settled: list[SettledRun], numbers: np.ndarray, found: list[Described]
) -> dict[str, Any]:
    """Return, for each unstable mode, the attractor that a small push along it settles on.

    Args:
        settled: runs of the pushes, in the order of the modes.
    """
    frequency = plant.frequencies[plant.unstable]
    count = len(frequency)
    # the unstable ones are sorted: those beyond the band, which are not pushed, are last
    pushed = min(count, len(settled))
    ends = np.full(count, NO_ATTRACTOR)
    ends[:pushed] = numbers[:pushed]
    squeals = np.zeros(count, bool)
    for index, number in enumerate(ends):
        if number != NO_ATTRACTOR and np.isfinite(found[number].frequency):
            away = np.abs(found[number].frequency - frequency)
            squeals[index] = away.argmin() == index
    unbounded = np.zeros(count, bool)
    unbounded[:pushed] = [run.unbounded for run in settled[:pushed]]
    stuck = np.zeros(count, bool)
    stuck[:pushed] = [run.sticks_for_good for run in settled[:pushed]]
    times = np.full(count, np.nan)
    for index, run in enumerate(settled[:pushed]):
        if run.agrees and not run.quiet:
            times[index] = arrival(run)
    return {
        "growth_rate": plant.spectrum.values.real[plant.unstable],
        "frequency": frequency,
        "critical_mu": plant.critical_mu[plant.unstable],
        "ends_in": ends,
        "squeals": squeals,
        **({"grows_without_bound": unbounded} if unbounded.any() else {}),
        **({"sticks_for_good": stuck} if stuck.any() else {}),
        "time_to_squeal": times,
    }


def _of_attractors(
    plant: Plant, members: list[list[SettledRun]], found: list[Described]
) -> dict[str, Any]:
    """Levels, shares of time, frequencies and multipliers; statistics are means over all runs."""
    count = len(members)
    shape = count, len(plant.contacts)  # also where no start has settled
    rows = [_window(plant, *each) for each in zip(members, found, strict=True)]
    frequency = np.array([each.frequency for each in found])
    near = [nearest(plant, each) for each in frequency]
    multipliers = np.full((count, len(plant.sliding)), np.nan, complex)
    largest = np.full(count, np.nan)
    for index, each in enumerate(found):
        if each.cycle is not None:
            values = each.cycle.multipliers
            multipliers[index] = values
            trivial = np.abs(values - 1.0).argmin()
            largest[index] = np.abs(np.delete(values, trivial)).max()
    force = _table(rows, "forces", shape)
    # a contact that is open in steady sliding has no force to compare with
    at_rest = np.where(plant.spectrum.state.force > 0, plant.pressed, np.nan)
    landings = _table(rows, "landings", shape)
    landings = landings / np.array([row.length for row in rows]).reshape(-1, 1)
    lines, spectra = _spectra(found)
    states = np.array([row.final for row in rows], float)
    states = states.reshape(count, len(plant.sliding))
    sprung = plant.structure.tangential_stiffnesses > 0
    stretch = np.zeros(shape)
    stretch[:, sprung] = states[:, 2 * plant.size :]
    motion = [
        heard(row.losses, quiet=runs[0].quiet)
        for runs, row in zip(members, rows, strict=True)
    ]
    moves = np.array([not runs[0].quiet for runs in members], bool)
    modes = plant.frequencies[near] if count else np.empty(0)
    speed = _table(rows, "speed", shape)
    return {
        "kind": np.array([each.kind for each in found], int),
        "motion": np.array(motion, int),
        "dominant_frequency": frequency,
        "frequency_resolution": np.array([each.resolution for each in found]),
        "nearest_mode": np.where(moves, plant.numbers[near], 0) if count else [],
        "frequency_shift": frequency - modes,
        "period": np.array(
            [np.nan if each.cycle is None else each.cycle.period for each in found]
        ),
        "events_per_period": np.array(
            [0 if each.cycle is None else len(each.cycle.events) for each in found], int
        ),
        "largest_multiplier": largest,
        "multiplier_real": multipliers.real,
        "multiplier_imag": multipliers.imag,
        "divergence_rate": np.array([each.exponent for each in found]),
        "velocity_rms": np.sqrt((speed**2).mean(axis=1)),
        "velocity_peak": np.array([float(row.peak_speed) for row in rows]),
        "kinetic_energy": np.array([0.5 * row.total**2 for row in rows]),
        "contact_velocity_rms": speed,
        "separated_fraction": _table(rows, "separated", shape),
        "stick_fraction": _table(rows, "stuck", shape),
        "peak_force": force / at_rest,
        "peak_normal_force": force,
        "impacts_per_period": landings
        / np.where(np.isfinite(frequency), frequency, np.inf)[:, None],
        "displacement": states[:, : plant.size],
        "velocity": states[:, plant.size : 2 * plant.size],
        **({"stretch": stretch} if sprung.any() else {}),
        "line_frequency": lines,
        "spectrum": spectra,
        "outcome": np.array(
            [
                Outcome.unresolved
                if each.kind is Kind.undetermined
                else Outcome.converged
                for each in found
            ],
            int,
        ),
    }


def _window(plant: Plant, runs: list[SettledRun], found: Described) -> StructureWindows:
    """Return the window of an attractor: of one run after settling, or of all irregular ones.

    The last window of a run may begin with the end of a transient. Only in an irregular motion does
    scatter hide that. A run that was ended as soon as it had come to such a motion counts with the
    last of the windows by which that was seen, if there were several.
    """
    if found.window is None:
        return still(plant)
    if found.kind in (Kind.cycle, Kind.torus):
        return found.window
    parts = [run.last for run in runs if not run.arrived]
    parts += [
        run.windows[-1]
        for run in runs
        if run.arrived and run.last.length > run.windows[-1].length
    ]
    return merged([found.window, *parts[::-1]])


def _table(
    rows: list[StructureWindows], name: str, shape: tuple[int, int]
) -> np.ndarray:
    return np.array([getattr(row, name) for row in rows], float).reshape(shape)


def nearest(plant: Plant, frequency: float) -> int:
    """Place of the mode nearest to a frequency; an unstable one where one is close to it."""
    away = np.abs(plant.frequencies - np.nan_to_num(frequency))
    unstable = plant.unstable
    # a frequency within this share of an unstable mode's is that mode's
    same_frequency = 0.02
    if unstable.size and away[unstable].min() <= same_frequency * frequency:
        return int(unstable[away[unstable].argmin()])
    near = int(away.argmin())
    # two modes that have met ring alike: the one that grows is meant
    at = plant.frequencies[near]
    twins = unstable[np.abs(plant.frequencies[unstable] - at) <= same_frequency * at]
    return int(twins[away[twins].argmin()]) if twins.size else near


def _spectra(found: list[Described]) -> tuple[np.ndarray, np.ndarray]:
    """Spectra on common lines, each the largest of those that it stands for."""
    moving = [each for each in found if each.lines.size]
    if not moving:
        return np.empty(0), np.empty((len(found), 0))
    top = min(each.lines[-1] for each in moving)
    lines_kept = 1024
    edges = np.linspace(0.0, top, lines_kept + 1)
    spectra = np.full((len(found), lines_kept), np.nan)
    for index, each in enumerate(found):
        if each.lines.size:
            within = np.clip(np.searchsorted(edges, each.lines) - 1, 0, lines_kept - 1)
            held = np.zeros(lines_kept)
            np.maximum.at(held, within, each.amplitudes)
            spectra[index] = held / np.sqrt((each.amplitudes**2).sum())
    return 0.5 * (edges[1:] + edges[:-1]), spectra


def _shares(ends: np.ndarray, count: int) -> dict[str, Any]:
    """Share of random starts that end in each attractor, with its interval."""
    counts = np.array([(ends == number).sum() for number in range(count)], int)
    intervals = np.array([wilson_interval(int(n), ends.size) for n in counts])
    intervals = intervals.reshape(count, 2)
    return {
        "count": counts,
        "share": counts / max(ends.size, 1),
        "share_low": intervals[:, 0],
        "share_high": intervals[:, 1],
        "share_undetermined": float((ends == NO_ATTRACTOR).mean())
        if ends.size
        else 0.0,
    }
