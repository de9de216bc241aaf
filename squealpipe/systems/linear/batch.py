"""Many runs of contacts on a belt, as the compiled loop of linear structures reads them."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from squealpipe.systems.cycles.sensitivity import growth
from squealpipe.systems.integrate import Batch, RunOptions, table_of
from squealpipe.systems.linear.loop import functions, loop
from squealpipe.systems.linear.matrices import ContactMatrices, friction_number
from squealpipe.systems.linear.numbering import Numbering, surface_number
from squealpipe.systems.linear.plan import plan
from squealpipe.systems.record import single_run
from squealpipe.systems.taylor.lanes import invoke


def coefficients_of_contacts(
    matrices: ContactMatrices,
    coefficients: Sequence[tuple[str, str | None, Any]],
    values: Mapping[str, Any],
) -> Iterator[tuple[Any, Any, Any, Any]]:
    """Yield the numbers of each contact: see :data:`.numbering.OF_CONTACT`.

    Args:
        coefficients: see :func:`numbers_of_runs`.
    """
    compressions = matrices.compressions(values["preload"])
    for at_rest, compression, (mu, static, speed) in zip(
        _over_mu_at_rest(matrices), compressions, coefficients, strict=True
    ):
        yield (
            values[mu],
            values[mu] * at_rest if static is None else values[static],
            values[speed] if isinstance(speed, str) else speed,
            compression,
        )


def _over_mu_at_rest(matrices: ContactMatrices) -> list[float]:
    """Return the coefficient of each contact at speed 0 over its μ, which a table multiplies."""
    return [
        float(pieces[0, 2]) if law == friction_number.table else 1.0
        for law, pieces in zip(matrices.laws, matrices.pieces, strict=True)
    ]


def refuse_weak_stick(
    matrices: ContactMatrices,
    coefficients: Sequence[tuple[str, str | None, Any]],
    values: Mapping[str, np.ndarray],
) -> None:
    """Raise if a static limit is below the coefficient at speed 0: neither stick nor slip lasts.

    Args:
        coefficients: see :func:`numbers_of_runs`.
        values: parameters by name, (runs,) each.
    """
    for at_rest, (mu, static, _) in zip(
        _over_mu_at_rest(matrices), coefficients, strict=True
    ):
        if static is None:
            continue
        excess = np.asarray(values[mu]) * at_rest - values[static]
        run = int(excess.argmax())
        if excess[run] > 1e-12 * values[static][run]:
            needed = values[mu][run] * at_rest
            raise ValueError(
                f"{mu} = {values[mu][run]:g}: {static} = {values[static][run]:g} is below the "
                f"coefficient at speed 0; give {static} = {needed:g} or more, or a smaller {mu}"
            )


def numbers_of_runs(
    matrices: ContactMatrices,
    coefficients: Sequence[tuple[str, str | None, Any]],
    values: Mapping[str, np.ndarray],
    unit: np.ndarray,
    address: int,
) -> np.ndarray:
    """Return the parameters of runs by their rows, the address of their plan first.

    Args:
        coefficients: of each contact, the names of μ and its static limit (None: μ at speed 0), and
            the name or the value of its reference speed.
        values: parameters by name, (runs,) each.
    """
    columns: list[Any] = [0.0, values["belt_speed"], values["preload"]]
    for each in coefficients_of_contacts(matrices, coefficients, values):
        columns += each
    numbers = table_of(len(unit), *columns, unit)
    numbers[:, 0] = np.array([address], np.int64).view(float)[0]
    return numbers


class LinearBatch(Batch):
    """Runs of one set of matrices; see :class:`squealpipe.systems.integrate.Batch`."""

    loop = staticmethod(loop)

    def __init__(
        self,
        system: Any,
        values: Mapping[str, np.ndarray],
        t_end: np.ndarray,
        options: RunOptions,
        tol: float,
    ) -> None:
        # the loop carries no perturbation: its growth follows from the events of each run
        super().__init__(system, values, t_end, replace(options, tangent=False), tol)
        self.asked, self.values, self.t_end = options, values, t_end

    def named(
        self, arrays: dict[str, np.ndarray], clock: Any = 1.0
    ) -> dict[str, np.ndarray]:
        """Return the results by name."""
        raw = super().named(arrays, clock)
        if self.asked.tangent:
            each = [self._growth(run) for run in range(self.size)]
            raw["log_growth"], raw["horizon"] = np.array(each).reshape(-1, 2).T
        return raw

    def _growth(self, run: int) -> tuple[float, float]:
        """Return the growth of a perturbation of a run, and its horizon, s."""
        system: Any = self.system
        values = {
            name: float(np.broadcast_to(self.values[name], self.size)[run])
            for name in (*system.states, *system.parameters)
        }
        t_end = float(self.t_end[run])
        # a perturbation is looked at once a unit of time, in at most so many instants
        count = 1 + math.ceil(min(t_end / float(self.unit[run]), 1e4))
        times = np.linspace(0.0, t_end, count)
        options = RunOptions(
            regime=self.regimes[run : run + 1],
            times=times,
            most_steps=self.asked.most_steps,
        )
        motion = single_run(system, values, t_end, options, tol=self.tol)
        return growth(system.flow(), values, motion, times, self.tol)

    def _parameters(self, values: Mapping[str, np.ndarray]) -> np.ndarray:
        system: Any = self.system
        refuse_weak_stick(system.matrices, system.coefficients, values)
        self.plan = plan(system.matrices, system.integrated, functions())
        address = self.plan.pointer.value or 0
        return numbers_of_runs(
            system.matrices, system.coefficients, values, self.unit, address
        )

    def _compile(self) -> None:
        system: Any = self.system
        numbering, matrices = system.integrated, system.matrices
        # the last in the place of what limits the steps of traced systems
        self.code = {**functions(), "longest": functions()["take"]}
        c, n_states = matrices.n_contacts, numbering.size
        events = len(numbering.surfaces) + len(numbering.outputs)
        self.n_series = n_states + events
        smooth = np.isin(
            matrices.laws, [friction_number.coulomb, friction_number.table]
        ).all()
        # rates that are no polynomials, and friction in stick beside them or beside cubics
        self.steep = np.zeros(n_states, np.int64)
        self.steep[matrices.n_modes : 2 * matrices.n_modes] = not smooth
        self.bent = np.zeros(events, np.int64)
        self.bent[surface_number.margin * c : (surface_number.margin + 2) * c] = (
            matrices.curved
        )

    def _series(self, n_terms: int) -> dict[str, Any]:
        return {
            "series": np.zeros((n_terms, self.n_series)),
            "inverses": self.plan.table.view(np.int64),
        }


def first_regimes(
    matrices: ContactMatrices,
    numbering: Numbering,
    coefficients: Sequence[tuple[str, str | None, Any]],
    values: Mapping[str, np.ndarray],
    states: np.ndarray,
    chosen: np.ndarray,
) -> np.ndarray:
    """Return the regime of each contact in which each run starts, (runs, contacts).

    Args:
        values: parameters, (runs,) each.
        states: (runs, states).
        chosen: (contacts,) regimes that are given; −1 of others.
    """
    first = numbering.first_regime[:-1]
    own = np.where(chosen < 0, -1, chosen - first)
    numbers = np.tile(own, (len(states), 1)).astype(np.int64)
    unit = np.ones(len(states))
    given = numbers_of_runs(matrices, coefficients, values, unit, 0)
    starts = np.hstack([given, states])
    table = plan(matrices, numbering, functions(), starts, numbers)
    address = table.pointer.value or 0
    table.arrays["starts"][:, 0] = np.array([address], np.int64).view(float)[0]
    invoke(functions()["starts"], address)
    return np.asarray(numbers + first)
