"""A structure without switches: friction and loss of contact are smoothed, scipy integrates.

Friction is μ(|w|) tanh(w/ε) N, and the corner of N = max(p, 0), p = preload − k nᵀq, is rounded to
½ (p + √(p² + s²)). Nothing sticks: a contact that should creeps at a part of ε. Nothing opens
wholly: at p = 0 the force is ½ s.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import odeint

from squealpipe.structures.dynamics import Numbers
from squealpipe.structures.squeal.plant import Plant


@dataclass(frozen=True)
class Samples:
    """Samples of a run at the instants asked for, without the start.

    Attributes:
        states: (instants, 2 n), displacements and velocities.
        pressing: p of each contact, (instants, contacts), N.
        forces: normal force N of each, likewise, N.
        sliding: sliding speed w of each, likewise, m/s.
        evaluations: calls of the field.
        finished: whether the solver reached the end.
    """

    states: np.ndarray
    pressing: np.ndarray
    forces: np.ndarray
    sliding: np.ndarray
    evaluations: int
    finished: bool


class Smoothed:
    """The equations of motion of a plant without switches.

    Args:
        friction_width: ε, m/s.
        contact_width: s of each contact, N; 0 keeps the corner.
    """

    def __init__(
        self, plant: Plant, friction_width: float, contact_width: np.ndarray
    ) -> None:
        self.plant = plant
        structure = plant.structure
        self.numbers = Numbers.of(structure)
        self.size, self.frictions = plant.size, structure.frictions
        self.stiffnesses = structure.stiffnesses
        self.belt = structure.speeds * structure.belt_speed
        self.friction_width = friction_width
        self.contact_width = contact_width

    def pressing(self, q: np.ndarray) -> np.ndarray:
        """Return p of each contact at displacements (…, n), N."""
        return self.plant.structure.pressing(q @ self.numbers.normals)

    def sliding(self, v: np.ndarray) -> np.ndarray:
        """Return the sliding speed w of each contact at velocities (…, n), m/s."""
        return np.asarray(self.belt - v @ self.numbers.tangentials)

    def forces(self, pressing: np.ndarray) -> np.ndarray:
        """Return the normal force of each contact from its p, N."""
        if not self.contact_width.any():
            return np.asarray(np.maximum(pressing, 0.0))
        return np.asarray(0.5 * (pressing + np.hypot(pressing, self.contact_width)))

    def rates(self, _: float, state: np.ndarray) -> np.ndarray:
        """Return ẋ of x = (q, v), (2 n,)."""
        numbers, q, v = self.numbers, state[: self.size], state[self.size :]
        pressing, speed = self.pressing(q), self.sliding(v)
        normal = self.forces(pressing)
        coefficient = np.array(
            [
                law.coefficient(each)
                for law, each in zip(self.frictions, np.abs(speed), strict=True)
            ]
        )
        drag = coefficient * normal * np.tanh(speed / self.friction_width)
        # the springs of closed contacts are part of the stiffness
        lifted = normal + self.stiffnesses * (q @ numbers.normals)
        rate = numbers.load + numbers.pushes @ lifted + numbers.drags @ drag
        return np.concatenate([v, rate - numbers.stiffness @ q - numbers.damping @ v])

    def run(self, start: np.ndarray, times: np.ndarray, tol: float) -> Samples:
        """Integrate by LSODA (ODEPACK), which changes between methods for stiff and other systems.

        Args:
            start: state (2 n,) at the first of the times.
            times: that of the start, and then the instants of the samples, s.
            tol: tolerance, relative and over the sizes of the coordinates.
        """
        # random states whose spread is the size of each coordinate
        spread = self.plant.random_states(64, 0) - self.plant.sliding
        states, told = odeint(
            self.rates,
            start,
            times,
            rtol=tol,
            atol=tol * spread.std(axis=0),
            tfirst=True,
            full_output=True,
            mxstep=10**8,
            printmessg=False,
        )
        states = states[1:]
        pressing = self.pressing(states[:, : self.size])
        return Samples(
            states=states,
            pressing=pressing,
            forces=self.forces(pressing),
            sliding=self.sliding(states[:, self.size :]),
            evaluations=int(told["nfe"][-1]),
            finished=told["message"] == "Integration successful."
            and bool(np.isfinite(states).all()),
        )
