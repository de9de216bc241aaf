"""Many runs of contacts on a belt, as the compiled loop of linear structures reads them."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from squealpipe.systems.integrate import Batch, table_of
from squealpipe.systems.linear.loop import functions, loop
from squealpipe.systems.linear.matrices import COULOMB, TABLE, ContactMatrices
from squealpipe.systems.linear.numbering import MARGIN, Numbering
from squealpipe.systems.linear.plan import plan


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
    for law, (mu, static, speed) in zip(matrices.laws, coefficients, strict=True):
        # of a table μ is a factor
        at_rest = matrices.pieces[0, 2] if law == TABLE else 1.0
        columns += [
            values[mu],
            values[mu] * at_rest if static is None else values[static],
            values[speed] if isinstance(speed, str) else speed,
        ]
    numbers = table_of(len(unit), *columns, unit)
    numbers[:, 0] = np.array([address], np.int64).view(float)[0]
    return numbers


class LinearBatch(Batch):
    """Runs of one set of matrices; see :class:`squealpipe.systems.integrate.Batch`."""

    loop = staticmethod(loop)

    def _parameters(self, values: Mapping[str, np.ndarray]) -> np.ndarray:
        system: Any = self.system
        self.plan = plan(system.matrices, system.integrated)
        address = self.plan.pointer.value or 0
        return numbers_of_runs(
            system.matrices, system.coefficients, values, self.unit, address
        )

    def _compile(self) -> None:
        system: Any = self.system
        numbering, matrices = system.integrated, system.matrices
        called = functions()
        self.code = {
            name: called[name].address for name in ("gauge", "change", "settle")
        }
        n, c = matrices.n_modes, matrices.n_contacts
        events = len(numbering.surfaces) + len(numbering.outputs)
        self.n_series = 2 * n + events
        smooth = np.isin(matrices.laws, [COULOMB, TABLE]).all()
        # rates that are no polynomials, and friction in stick beside them or beside cubics
        self.steep = np.repeat([0, int(not smooth)], n)
        self.bent = np.zeros(events, np.int64)
        self.bent[MARGIN * c : (MARGIN + 2) * c] = matrices.curved

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
    each = len(numbering.regime_names)
    own = np.where(chosen < 0, -1, chosen % each)
    numbers = np.tile(own, (len(states), 1)).astype(np.int64)
    unit = np.ones(len(states))
    given = numbers_of_runs(matrices, coefficients, values, unit, 0)
    table = plan(matrices, numbering, np.hstack([given, states]), numbers)
    address = table.pointer.value or 0
    functions()["starts"].ctypes(address)
    return numbers + each * np.arange(matrices.n_contacts)
