"""Contacts on a belt as a system: its names, and the verbs, on the loop of linear structures."""

import copy
import hashlib
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, Self

import numpy as np
import xarray as xr

from squealpipe.systems.joint import Joint
from squealpipe.systems.linear.batch import LinearBatch, first_regimes
from squealpipe.systems.linear.flow import LinearFlow
from squealpipe.systems.linear.matrices import Caps, ContactMatrices, regime_constant
from squealpipe.systems.linear.numbering import Numbering, surface_number
from squealpipe.systems.system import System

WRITTEN = 4096
"""Numbers of a matrix up to which a dataset holds them; of larger ones it holds a digest."""


class ContactJoint(Joint):
    """Regimes of all contacts at once."""

    def __init__(self, numbering: Any) -> None:
        super().__init__(numbering, ())
        self.numbering: Numbering = numbering

    def _stuck(self, number: int) -> np.ndarray:
        """(contact,) whether it, or the slider of its tangential spring, sticks."""
        own = list(self.regimes(number))
        constants = self.numbering.constants_of_regimes[own, regime_constant.is_stuck]
        return np.asarray(constants > 0.0)

    def _of_surfaces(self, rows: Sequence[int], contacts: np.ndarray) -> np.ndarray:
        """(surface,) those of some contacts."""
        shape = self.numbering.surfaces_of_a_contact, len(contacts)
        chosen = np.zeros(shape, dtype=bool)
        chosen[list(rows)] = contacts
        return chosen.ravel()

    def _held(self, number: int) -> np.ndarray:
        """(surface,) the sliding speeds of contacts that stick."""
        stuck = self._stuck(number)
        # a tangential spring lets the contact move while its slider sticks
        stuck[[*self.numbering.sliders]] = False
        return self._of_surfaces([surface_number.lag], stuck)

    def sticks(self, number: int) -> np.ndarray:
        """(surface,) the sliding speeds of contacts and sliders that stick."""
        return self._of_surfaces([surface_number.lag], self._stuck(number))

    def begins_at_zero(self, before: int, after: int) -> np.ndarray:
        """(surface,) limits of friction of a slider that sticks from a landing or from slip."""
        begins = np.zeros(self.numbering.n_components, bool)
        sliders = [*self.numbering.sliders]
        begins[sliders] = (self._stuck(after) & ~self._stuck(before))[sliders]
        margins = surface_number.margin, surface_number.margin_back
        return self._of_surfaces(margins, begins)


class LinearSystem(System):
    """Linear structure with contacts on a belt, as a :class:`squealpipe.System`.

    Args:
        name: for titles and files.
        states: name → (unit, typical size): n displacements, their velocities, and the stretch of
            each tangential spring.
        parameters: name → default: ``mu``, ``belt_speed``, ``preload`` and what the law reads.
        matrices: of the equations of motion.
        contacts: names.
        coefficients: of each contact, its parameters of friction; see
            :func:`.batch.numbers_of_runs`.
        outputs: name → unit, after those of the contacts.
        time_scale: typical time, s.

    Raises:
        ValueError: a name is taken.
    """

    batch = LinearBatch
    most_states, most_regimes = 2 * Caps().modes, 1 << 40

    def __init__(
        self,
        name: str,
        *,
        states: Mapping[str, tuple[str, float]],
        parameters: Mapping[str, float],
        matrices: ContactMatrices,
        contacts: Sequence[str],
        coefficients: Sequence[tuple[str, str | None, Any]],
        outputs: Mapping[str, str],
        time_scale: float,
    ) -> None:
        numbering: Any = Numbering(
            tuple(contacts),
            matrices.n_modes,
            matrices.pieces,
            matrices.presses,
            len(outputs),
            tuple(matrices.sliders),
        )
        self.name, self.matrices = name, matrices
        self.units = {key: unit for key, (unit, _) in states.items()}
        self.typical_sizes = {key: size for key, (_, size) in states.items()}
        self.coefficients = coefficients
        self.parameters = dict(parameters)
        self.start = dict.fromkeys(states, 0.0)
        self.period, self.time_scale, self.stops = None, time_scale, {}
        self.numbering: Numbering = numbering
        self.composition = numbering.composition
        self.regimes = self.composition.regimes
        self.switches = numbering.switches
        self.outputs: dict[str, Any] = {}
        for contact in contacts:
            self.outputs[f"{contact}_normal_force"] = ("N", None)
            self.outputs[f"{contact}_speed"] = ("m s-1", None)
        self.outputs |= {key: (unit, None) for key, unit in outputs.items()}
        self._check_names()
        self.traced = self.integrated = numbering
        self.form = self

    @property
    def exponents(self) -> tuple[str, ...]:
        """No parameter is an exponent."""
        return ()

    def for_exponents(self, values: Mapping[str, Any]) -> Self:
        """Return the system with the matrices of the belt's speed, which all runs share.

        Raises:
            ValueError: several speeds, where the matrices change with it.
        """
        if not self.matrices.by_speed:
            return self
        speeds = np.unique(np.asarray(values["belt_speed"], float))
        if len(speeds) > 1:
            raise ValueError(
                f"belt_speed = {speeds[0]:g} to {speeds[-1]:g}: matrices change with it, so that "
                "runs side by side share one speed; run one after another"
            )
        if speeds[0] == self.parameters["belt_speed"]:
            return self
        other = copy.copy(self)
        other.matrices = self.matrices.at(float(speeds[0]))
        other.parameters = {**self.parameters, "belt_speed": float(speeds[0])}
        other.form = other
        return other

    @cached_property
    def joint(self) -> Joint:
        """The regimes of all contacts at once."""
        return ContactJoint(self.numbering)

    def flow(self, followed: Sequence[str] = (), scales: Any = None) -> Any:
        """Return the motion along legs, with derivatives; see :class:`.cycles.flow.Flow`."""
        return LinearFlow(self, followed, scales)

    @cached_property
    def text(self) -> dict[str, str]:
        """Return the equations and their matrices as text, for the attributes of datasets."""
        matrices = self.matrices
        written = {
            "equations": "dq/dt = v; dv/dt = preload^balanced load - stiffness q - damping v "
            "+ sum over contacts of push P + drag T; P = preload_i preload in contact, else "
            "spring_i normal_i.q; normal force N = preload_i preload - spring_i normal_i.q, in "
            "contact while N > 0; w = speed_i belt_speed - tangential_i.v; T = mu(|w|) N sgn w in "
            "slip, |T| <= mu_static N in stick, where w = 0"
        }
        if self.numbering.has_presses:
            written["equations"] += (
                "; where presses has several rows (start, end, force, slope), N = force + slope "
                "(d - start) of the row in which the compression d = d_i - normal_i.q is, with "
                "d_i where N = preload_i preload, P = N + spring_i normal_i.q"
            )
        if self.numbering.sliders:
            written["equations"] += (
                "; where tangential_springs is not 0, T = tangential_springs s of the stretch s: "
                "ds/dt = w in stick, s = mu N sgn(w') / tangential_springs in slip with the "
                "slider's w' = w - ds/dt, s = 0 out of contact"
            )
        for name in (
            *(
                "stiffness",
                "damping",
                "load",
                "normals",
                "tangentials",
                "pushes",
                "drags",
            ),
            *("springs", "preloads", "speeds", "laws", "pieces"),
            *["presses"] * self.numbering.has_presses,
            *["tangential_springs"] * bool(self.numbering.sliders),
        ):
            array = getattr(matrices, name)
            of_pieces = name in {"pieces", "presses"}
            array = np.vstack(array) if of_pieces else np.asarray(array)
            digest = hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()
            small = array.size <= WRITTEN
            written[name] = str(array.tolist()) if small else f"sha256 {digest}"
        written["balanced"] = str(matrices.balanced)
        n = matrices.n_modes
        for place, (q, v) in enumerate(
            zip(self.states[:n], self.states[n : 2 * n], strict=True), 1
        ):
            written |= {f"d{q}/dt": v, f"d{v}/dt": f"row {place} of the equations"}
        stretches = (f"d{name}/dt" for name in self.states[2 * n :])
        written |= dict.fromkeys(stretches, "see the equations")
        written |= dict.fromkeys(self.outputs, "see the equations")
        for name, constants in self.regimes.items():
            pairs = (f"{key}={value:g}" for key, value in constants.items())
            written[f"regime {name}"] = ", ".join(pairs)
        return written

    def first_regimes(
        self,
        values: Mapping[str, Any],
        size: int,
        chosen: Any = None,
        *,
        in_scales: bool = False,  # noqa: ARG002 (it states none)
    ) -> np.ndarray:
        """Return the regime of each contact in which each run starts, (size, contacts)."""
        chosen = self.start.get("regime") if chosen is None else chosen
        numbers = self.composition.numbers(chosen)
        states = np.stack([np.broadcast_to(values[n], size) for n in self.states], 1)
        given = {n: np.broadcast_to(values[n], size) for n in self.parameters}
        matrices = self.for_exponents(given).matrices
        return first_regimes(
            matrices, self.numbering, self.coefficients, given, states, numbers
        )

    def outputs_along(
        self,
        values: Mapping[str, float],
        times: np.ndarray,  # noqa: ARG002
        path: np.ndarray,
        regimes: np.ndarray,
    ) -> Sequence[Any]:
        """Return each output at the instants of a run; see :meth:`TracedSystem.outputs_along`."""
        m = self.matrices
        q, v = np.split(path, [m.n_modes, 2 * m.n_modes], axis=1)[:2]
        constants = self.numbering.constants_of_regimes[np.maximum(regimes, 0)]
        stiffness, at_rest = m.lines(constants, values["preload"])
        force = constants[..., regime_constant.is_closed] * (
            at_rest - (q @ m.normals) * stiffness
        )
        speed = m.speeds * values["belt_speed"] - v @ m.tangentials
        pairs = np.stack([force, speed], 2).reshape(len(path), -1)
        return [*pairs.T, *(q @ m.shapes.T).T]

    def ensemble(self, *args: Any, **options: Any) -> xr.Dataset:
        """Many runs; see :func:`squealpipe.systems.runs.ensemble`."""
        speeds = options.get("belt_speed", self.parameters["belt_speed"])
        if not self.matrices.by_speed or np.ndim(speeds) != 1:
            return super().ensemble(*args, **options)
        # runs side by side share their matrices: one speed after another
        found = [
            super(LinearSystem, self).ensemble(
                *args, **{**options, "belt_speed": [each]}
            )
            for each in np.asarray(speeds, float)
        ]
        return xr.concat(found, "belt_speed", data_vars="minimal")
