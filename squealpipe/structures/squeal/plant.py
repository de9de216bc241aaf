"""A structure as it is run: its system, its steady sliding, its modes, and a measure of states."""

import copy
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg as la
import scipy.sparse as sp
from scipy.optimize import linear_sum_assignment

from squealpipe.laws.friction_laws import COULOMB
from squealpipe.structures.agreement import Agreement, Truth, exact
from squealpipe.structures.complex_modes import complex_modes
from squealpipe.structures.definition import ContactStructure, ReducedFrom
from squealpipe.structures.modes import audible_band, free_degrees, modes_at_rest
from squealpipe.structures.motion_system import system
from squealpipe.structures.pencil import DENSE
from squealpipe.structures.reduction import (
    agreement_of,
    fewest_modes,
    fitted,
    modes_that_would_do,
    reduce,
)
from squealpipe.structures.schema.squealing import SquealLimits
from squealpipe.structures.sliding import steady_sliding
from squealpipe.structures.spectrum import Limits, Solver, Spectrum
from squealpipe.systems.linear.matrices import Caps
from squealpipe.systems.one_thread import one_thread
from squealpipe.systems.system import System
from squealpipe.systems.trace import TIME

PUSH_OF_A_MODE = 0.01
"""Push along a mode, over the deformation whose energy is that of the preload."""


def carried(
    structure: ContactStructure, frequency_max: float | None = None
) -> ContactStructure:
    """Return a structure of as few modes as give the answer, and no more than a run can have.

    Args:
        frequency_max: unstable modes up to there count, Hz; None: as it was reduced, or all.

    Returns:
        The structure itself where it is small and no penalty fixes a part of it, or where it has
        too many contacts to be run.
    """
    if not structure.contacts:
        raise ValueError("the structure has no contacts: nothing rubs")
    if structure.size <= SquealLimits.most_modes:
        free = free_degrees(structure)
        if frequency_max is None and free == structure.size:
            return structure
        number = max(free, fewest_modes(structure))
        return reduce(structure, n_modes=number, frequency_max=frequency_max)
    if structure.reduced_from is not None and structure.size <= Caps().modes:
        return structure  # reduced by hand
    origin = structure.reduced_from or ReducedFrom(structure, frequency_max)
    whole, band = origin.whole, origin.frequency_max
    count = len(whole.contacts)
    if count > Caps().contacts:
        # nothing will be run: the modes of the structure itself are reported
        return (
            structure if structure.size <= DENSE else reduce(whole, frequency_max=band)
        )
    # each contact has a static deflection of its own, which takes a few modes
    return fitted(
        whole, band, min(max(SquealLimits.most_modes, 4 * count), Caps().modes)
    )


def band_of(structure: ContactStructure, frequency_max: float | None) -> float | None:
    """Return the end of the band in which modes of a structure in a file count, Hz; None: all.

    Args:
        frequency_max: as it is asked for; None: the end of hearing, where modes lie beyond it.

    Returns:
        None for a structure that is run whole.
    """
    if frequency_max is not None or structure.size <= SquealLimits.most_modes:
        return frequency_max
    return audible_band(structure)


@one_thread()
def in_modes(
    structure: ContactStructure, n_modes: int | None, frequency_max: float | None
) -> ContactStructure:
    """Return a structure in so many modes, or in as few as give the answer where None is asked.

    Args:
        frequency_max: unstable modes up to there count, Hz; None: as it was reduced, or all.

    Raises:
        ValueError: more modes than a run can have, or what the reduction refuses.
    """
    if n_modes is None:
        return carried(structure, frequency_max)
    if n_modes > Caps().modes:
        raise ValueError(
            f"n_modes = {n_modes}: a structure can be run in {Caps().modes}; leave it out for the "
            "fewest that answer"
        )
    return reduce(structure, n_modes=n_modes, frequency_max=frequency_max)


def damped_beyond(
    structure: ContactStructure, limit: float, ratio: float
) -> ContactStructure:
    """Return a reduced structure whose coordinates beyond a frequency have more damping.

    Args:
        structure: in coordinates of which the mass is 1 and the stiffness at rest diagonal.
        limit: rad/s.
        ratio: damping ratio that is added.
    """
    if ratio == 0.0:
        return structure
    omega = np.sqrt(np.maximum(structure.stiffness_at_rest.diagonal(), 0.0))
    added = sp.diags_array(2.0 * ratio * omega * (omega > limit))
    other = copy.copy(structure)
    other.given_damping = sp.csr_array(structure.given_damping + added)
    other.assemble()
    return other


def _spectrum(structure: ContactStructure) -> Spectrum:
    """Return the complex modes about steady sliding."""
    solver = Solver(structure, Limits(None, None), structure.belt_speed)
    return solver.at(structure.mu)


class Plant:
    """A structure of few degrees of freedom, about its steady sliding.

    States are (q, v) side by side, (2 n,), and the stretches of tangential springs. Their size is
    √E of the deviation from steady sliding, E = ½ vᵀ M v + ½ qᵀ (K + Σ kᵢ nᵢnᵢᵀ) q.

    Modes beyond the band that a reduced structure was made for are no answer, since truncated
    coordinates make some grow that decay in the whole. Where one grows, coordinates beyond the band
    are damped until none does.

    Args:
        structure: of any size; one that is larger than a system can carry is reduced.
        is_ready: whether it is run as it is, whatever its size.
        band: end of the band, rad/s; None: that for which it was reduced.

    Attributes:
        band: end of the band, rad/s; infinite without one.
        damping_beyond: damping ratio that coordinates beyond the band have been given.
        neighbours: settled runs, each with how far its neighbours separate: see :mod:`.kinds`.

    Raises:
        NoSlidingError: there is no steady sliding.
        ValueError: no contact; or beyond 1000 degrees of freedom, which are to be reduced by hand.
    """

    def __init__(
        self,
        structure: ContactStructure,
        *,
        is_ready: bool = False,
        band: float | None = None,
    ) -> None:
        self.structure = structure if is_ready else carried(structure)
        origin = self.structure.reduced_from
        limit = None if origin is None else origin.frequency_max
        self.band = np.inf if limit is None else 2.0 * np.pi * limit
        if band is not None:
            self.band = band
        self.size = self.structure.size
        self.damping_beyond = 0.0
        self.neighbours: list[tuple[Any, Any]] = []
        self.spectrum = _spectrum(self.structure)
        reduced = self.structure
        # the first that suffices: more would reach into the band
        for ratio in (0.05, 0.1, 0.2, 0.5) if np.isfinite(self.band) else ():
            if not self._grows_beyond:
                break
            self.damping_beyond = ratio
            self.structure = damped_beyond(reduced, self.band, ratio)
            self.spectrum = _spectrum(self.structure)
        self.sliding = self.with_stretches(
            np.concatenate([self.spectrum.state.displacement, np.zeros(self.size)])
        )

    @property
    def is_undamped(self) -> bool:
        """Tell whether nothing damps the structure itself, whatever damping its reduction has."""
        origin = self.structure.reduced_from
        whole = self.structure if origin is None else origin.whole
        return not whole.damping.nnz and not whole.modal_damping.any()

    @property
    def _grows_beyond(self) -> bool:
        """Tell whether a mode beyond the band grows."""
        beyond = self.spectrum.values.imag > self.band
        growth = self.spectrum.values.real - self.spectrum.growth_errors
        return bool((growth[beyond] > 0.0).any())

    @cached_property
    def obstacle(self) -> str | None:
        """Reason why the structure cannot be run, with a remedy; None if it can."""
        count = len(self.structure.contacts)
        caps = Caps()
        if count > caps.contacts:
            return (
                f"{count} contacts are more than the {caps.contacts} that runs can have "
                "(merge neighbours: `points` of a face, or with_points)"
            )
        if self.size > caps.modes:
            return (
                f"{self.size} modes are more than the {caps.modes} that runs can have "
                f"(reduce it with n_modes={caps.modes} or fewer)"
            )
        if not self.agreement.holds:
            # any motion of these modes would leave the verdict on the whole structure undetermined
            return self._disagreement()
        return None

    def _disagreement(self) -> str:
        """Say in which modes these and the whole structure differ, with a remedy."""
        lost, kept = self.agreement.missing, f"the {self.size} modes kept"
        remedy = (
            "look at a narrower band with a smaller frequency_max"
            if self.enough is None
            else f"n_modes={self.enough} would do"
        )
        if not lost.size:
            return f"the errors leave open which modes of {kept} grow ({remedy})"
        lowest = lost.imag.min() / (2.0 * np.pi)
        return (
            f"{kept} lack {lost.size} unstable mode{'s' * (lost.size > 1)} of the whole "
            f"structure, the lowest at {lowest:.4g} Hz ({remedy})"
        )

    @cached_property
    def agreement(self) -> Agreement:
        """Agreement of its modes with those of the structure that it was reduced from."""
        if self.truth is None or self.structure.modes is None:
            return exact(self.spectrum)
        return agreement_of(self.truth, self.spectrum, self.structure.modes)

    @cached_property
    def truth(self) -> Truth | None:
        """Modes of the structure that it was reduced from."""
        origin = self.structure.reduced_from
        if origin is None:
            return None
        return origin.truth or Truth.of(origin.whole, origin.frequency_max)

    @cached_property
    def sliding_forces(self) -> np.ndarray:
        """Contact forces of steady sliding, N; of the whole where this is reduced from one.

        Modes at rest without static responses lack a part of each contact's compliance.
        """
        origin, state = self.structure.reduced_from, self.spectrum.state
        if origin is None:
            return state.force
        mu = self.structure.mu_of_contacts
        return steady_sliding(origin.whole, mu, state.belt_speed).force

    @cached_property
    def enough(self) -> int | None:
        """Number of modes that would agree with the whole where these do not; None if not known."""
        if self.truth is None or self.agreement.holds:
            return None
        return modes_that_would_do(self.structure, self.truth, Caps().modes)

    def truth_at(self, mu: float) -> Truth:
        """Modes of the whole, or of the structure itself, at another friction."""
        origin = self.structure.reduced_from or ReducedFrom(self.structure, None)
        return Truth.of(origin.whole.with_(mu=mu), origin.frequency_max)

    @cached_property
    def system(self) -> System:
        """Return the structure as a system, whose states are those of the plant."""
        return system(self.structure)

    @cached_property
    def regimes_at_rest(self) -> np.ndarray:
        """Regime of each component in steady sliding."""
        system = self.system
        values = dict(zip(system.states, self.sliding[:, None], strict=True))
        parameters = {name: np.full(1, at) for name, at in system.parameters.items()}
        named = {**values, **parameters, TIME: np.zeros(1)}
        return np.asarray(system.first_regimes(named, 1)[0])

    @cached_property
    def traced_system(self) -> System | None:
        """Return the system of components, for exact cycles; None if it is too large."""
        try:
            return getattr(self.system, "general", self.system)
        except ValueError:
            return None

    @property
    def contacts(self) -> list[str]:
        """Names."""
        return [contact.name for contact in self.structure.contacts]

    @cached_property
    def unstable(self) -> np.ndarray:
        """Places of the unstable modes in the spectrum, the fastest first; beyond the band last."""
        growth = self.spectrum.values.real
        places = np.flatnonzero(growth > self.spectrum.growth_errors)
        beyond = self.spectrum.values.imag[places] > self.band
        return places[np.lexsort((-growth[places], beyond))]

    @property
    def asked(self) -> np.ndarray:
        """Places of the unstable modes that are pushed: within the band, or the fastest beyond."""
        within = self.spectrum.values.imag[self.unstable] <= self.band
        return self.unstable[: max(int(within.sum()), 1)]

    @cached_property
    def decays(self) -> bool:
        """True if small motions about steady sliding die out."""
        return bool((self.spectrum.values.real < -self.spectrum.growth_errors).all())

    @property
    def rate(self) -> float:
        """Growth rate of small motions, 1/s; 0 where its sign is not known."""
        if not self.unstable.size and not self.decays:
            return 0.0
        return float(self.spectrum.values.real.max())

    @property
    def is_linear(self) -> bool:
        """True if motions during which no contact switches are linear: friction is constant."""
        return all(
            friction.friction_law == COULOMB for friction in self.structure.frictions
        )

    @cached_property
    def rest(self) -> tuple[np.ndarray, np.ndarray]:
        """ω (n,) and Φ (n, n) of the modes at rest, ΦᵀMΦ = 1."""
        return modes_at_rest(self.structure)

    @property
    def pressed(self) -> np.ndarray:
        """Preload of each contact, or where it has none its force in steady sliding, N."""
        preloads = self.structure.preloads
        force = np.where(preloads > 0, preloads, self.spectrum.state.force)
        return np.where(force > 0, force, np.nan)

    @cached_property
    def energy(self) -> float:
        """Return the energy that the preloads store in the contact springs, J."""
        contacts = self.structure.contacts
        if not self.structure.preloads.any():
            forces = self.spectrum.state.force
            contacts = tuple(
                replace(contact, preload=float(force))
                for contact, force in zip(contacts, forces, strict=True)
            )
        return sum(contact.energy_at_preload for contact in contacts)

    @cached_property
    def _roots(self) -> tuple[np.ndarray, np.ndarray]:
        """Square roots of ½ M and ½ (K + Σ k nnᵀ)."""
        omega, modes = self.rest
        mass = self.structure.mass.toarray()
        to_modes = modes.T @ mass
        return to_modes / np.sqrt(2.0), omega[:, None] * to_modes / np.sqrt(2.0)

    def coordinates(self, deviation: np.ndarray) -> np.ndarray:
        """Coordinates of deviations (…, 2 n) whose squares sum to E, √J."""
        kinetic, elastic = self._roots
        q, v = deviation[..., : self.size], self._velocities(deviation)
        return np.concatenate([v @ kinetic.T, q @ elastic.T], axis=-1)

    def sizes(self, deviation: np.ndarray) -> np.ndarray:
        """√E of deviations (…, 2 n), √J."""
        return np.asarray(np.linalg.norm(self.coordinates(deviation), axis=-1))

    def modal_velocities(self, states: np.ndarray) -> np.ndarray:
        """Velocities of the modes at rest, (…, n); half their squares sum to kinetic energy."""
        kinetic, _ = self._roots
        return np.asarray(self._velocities(states) @ kinetic.T * np.sqrt(2.0))

    def _velocities(self, states: np.ndarray) -> np.ndarray:
        return states[..., self.size : 2 * self.size]

    def with_stretches(self, motion: np.ndarray) -> np.ndarray:
        """Return states whose tangential springs are as slip would stretch them.

        Args:
            motion: displacements and velocities, (…, 2 n).
        """
        structure = self.structure
        springs = structure.tangential_stiffnesses
        if not springs.any():
            return motion
        nearing = motion[..., : self.size] @ structure.normals
        force = np.maximum(structure.pressing(nearing), 0.0)
        direction = np.sign(self.belt)
        friction = direction * structure.mu_of_contacts * force
        chosen = springs > 0.0
        stretches = friction[..., chosen] / springs[chosen]
        return np.concatenate([motion, stretches], axis=-1)

    @property
    def belt(self) -> np.ndarray:
        """Velocity of the belt along the tangential direction of each contact, m/s."""
        return self.structure.speeds * self.structure.belt_speed

    def contact_speeds(self, states: np.ndarray) -> np.ndarray:
        """Speed of vibration of each contact point, (…, contacts), m/s."""
        v = self._velocities(states)
        along, across = v @ self.structure.tangentials, v @ self.structure.normals
        return np.asarray(np.hypot(along, across))

    def contact_motions(self, amplitudes: np.ndarray) -> np.ndarray:
        """Displacements or velocities along and across the belt, (…, contacts, 2)."""
        along = amplitudes @ (self.structure.tangentials * np.sign(self.belt))
        across = amplitudes @ self.structure.normals
        return np.stack([along, across], axis=-1)

    def normal_forces(self, states: np.ndarray) -> Any:
        """Forces of the contacts where they are closed, (…, contacts), N."""
        nearing = states[..., : self.size] @ self.structure.normals
        return self.structure.pressing(nearing)

    @cached_property
    def modes(self) -> Any:
        """Complex modes as a dataset, for numbers and critical friction."""
        return complex_modes(self.structure)

    @cached_property
    def _places(self) -> np.ndarray:
        """Place in that dataset of each mode of the spectrum, by its eigenvalue."""
        omega = 2.0 * np.pi * self.modes.frequency.values
        values = self.modes.growth_rate.values + 1j * omega
        away = np.abs(self.spectrum.values[:, None] - values)
        return np.asarray(linear_sum_assignment(away)[1])

    @property
    def numbers(self) -> np.ndarray:
        """Number of each mode of the spectrum."""
        return np.asarray(self.modes.mode.values[self._places])

    @property
    def critical_mu(self) -> np.ndarray:
        """Friction from which each grows, NaN if none."""
        return np.asarray(self.modes.critical_mu.values[self._places])

    @cached_property
    def frequencies(self) -> np.ndarray:
        """Return the frequencies of the modes about steady sliding, Hz."""
        return np.asarray(self.spectrum.values.imag / (2.0 * np.pi))

    @cached_property
    def slowest(self) -> float:
        """The lowest frequency that a run must resolve: of an unstable mode, or of any, Hz."""
        places = self.unstable if self.unstable.size else slice(None)
        chosen = self.frequencies[places]
        chosen = chosen[chosen > 0]
        if not chosen.size:
            chosen = self.rest[0][self.rest[0] > 0] / (2.0 * np.pi)
        return float(chosen.min())

    @cached_property
    def fastest(self) -> float:
        """The highest frequency of a mode, Hz."""
        return float(max(self.frequencies.max(), self.rest[0].max() / (2.0 * np.pi)))

    def random_states(self, number: int, seed: int) -> Any:
        """States uniform in the ball of the preload's energy about steady sliding."""
        rng = np.random.default_rng(seed)
        dims = 2 * self.size
        direction = rng.standard_normal((number, dims))
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        radius = np.sqrt(self.energy) * rng.random((number, 1)) ** (1.0 / dims)
        deviation = (direction * radius) @ self._from_ball.T
        return self.with_stretches(self.sliding[:dims] + deviation)

    @cached_property
    def _from_ball(self) -> np.ndarray:
        """Turn coordinates whose squares sum to the energy into states."""
        omega, modes = self.rest
        # a rigid body moves without energy: its place is not drawn, its velocity is
        along = np.where(omega > 0, 1.0 / np.where(omega > 0, omega, 1.0), 0.0)
        return np.asarray(np.sqrt(2.0) * la.block_diag(modes * along, modes))

    def pushed(self, place: int, share: float) -> np.ndarray:
        """Steady sliding pushed along a mode of the spectrum, by a share of √energy."""
        shape = self._push(place, share)
        velocity = self.spectrum.pairs[place].value * shape
        away = np.concatenate([shape.real, velocity.real])
        return self.with_stretches(self.sliding[: 2 * self.size] + away)

    def push_switches_nothing(self, place: int) -> bool:
        """Tell whether a push of a mode surely dies out with every contact as in steady sliding.

        The motion is then the decaying mode itself, and its first amplitude bounds it. False where
        the mode does not decay or a law of contact or friction is not linear.
        """
        structure, pair = self.structure, self.spectrum.pairs[place]
        is_plain = all(
            contact.law is None and contact.tangential_stiffness is None
            for contact in structure.contacts
        )
        error = float(self.spectrum.growth_errors[place])
        if not (is_plain and self.is_linear and pair.value.real < -error):
            return False
        shape = self._push(place, PUSH_OF_A_MODE)
        nearing = self.sliding[: self.size] @ structure.normals
        presses = np.abs(structure.preloads - structure.stiffnesses * nearing)
        normal = structure.stiffnesses * np.abs(shape @ structure.normals)
        along = np.abs(pair.value) * np.abs(shape @ structure.tangentials)
        belt = np.abs(structure.speeds * structure.belt_speed)
        # round-off must not decide
        return bool((normal < 0.99 * presses).all() and (along < 0.99 * belt).all())

    def _push(self, place: int, share: float) -> np.ndarray:
        """Return the complex amplitudes of a push along a mode: its displacement is largest now."""
        pair = self.spectrum.pairs[place]
        shape = pair.right
        turned = shape * np.exp(-0.5j * np.angle((shape**2).sum()))
        state = np.concatenate([turned.real, (pair.value * turned).real])
        size = share * np.sqrt(self.energy) / float(self.sizes(state))
        return np.asarray(turned * size)
