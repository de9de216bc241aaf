"""Parts of damping and stiffness that change with the speed of a rotation or of a belt."""

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import scipy.sparse as sp

from squealpipe.structures.matrices import real_square
from squealpipe.systems.inputs.values import brief, is_whole_number, numbers_in_si
from squealpipe.systems.inputs.words import suggestion

TERM_UNITS = {"damping": "N s m-1", "stiffness": "N m-1"}
"""Matrix that speed terms are parts of → its CF unit."""


@dataclass(frozen=True, eq=False)
class SpeedTerms:
    """Matrices that are added to damping and stiffness, each times (Ω/Ω₀)^power.

    Attributes:
        reference: Ω₀, rad/s or m/s.
        damping, stiffness: pairs of a sparse matrix (n, n) and its whole power.
    """

    reference: float
    damping: tuple[tuple[Any, int], ...] = ()
    stiffness: tuple[tuple[Any, int], ...] = ()

    @classmethod
    def of(cls, given: Any, size: int, reference: float) -> Self:
        """Check what a structure is given.

        Args:
            given: None, a mapping of ``damping`` and ``stiffness`` to pairs of a matrix and a
                power, or terms that are checked already.
            size: degrees of freedom.
            reference: Ω₀ of a mapping.

        Raises:
            ValueError: names the entry.
        """
        if isinstance(given, cls):
            return given
        if given is None:
            return cls(reference)
        if not isinstance(given, Mapping):
            raise ValueError(  # noqa: TRY004 (of all arguments mistakes are values)
                f"speed_terms = {brief(given)}: a mapping is needed, like "
                "{'damping': [(matrix, 1)]}"
            )
        terms = {}
        for name, entries in given.items():
            if name not in TERM_UNITS:
                raise ValueError(
                    f"speed_terms: {name!r}: {suggestion(str(name), TERM_UNITS)}"
                )
            terms[name] = tuple(_terms(name, entries, size))
        made = cls(reference, **terms)
        if reference == 0 and any(power for _, power in made.all):
            raise ValueError(
                "speed_terms: the speed Ω₀ at which their matrices hold is 0; give the structure "
                "a belt_speed, or a rotation with a speed, other than 0"
            )
        return made

    @property
    def all(self) -> list[tuple[Any, int]]:
        """Pairs of both kinds."""
        return [*self.damping, *self.stiffness]

    def __bool__(self) -> bool:
        """Tell whether there are any."""
        return bool(self.all)

    @property
    def vary(self) -> bool:
        """Tell whether any changes with speed."""
        return any(power for _, power in self.all)

    def factor(self, power: int, speed: float) -> float:
        """Return (Ω/Ω₀)^power.

        Raises:
            ValueError: a speed of 0 and a negative power.
        """
        if power == 0:
            return 1.0
        if speed == 0 and power < 0:
            raise ValueError(
                f"belt_speed = 0: a speed term of power {power} has no value there; choose another "
                "speed"
            )
        return float((speed / self.reference) ** power)

    def at(self, what: str, speed: float) -> Any:
        """Return the sum of the terms of ``damping`` or ``stiffness`` at a speed, (n, n) or 0."""
        return sum(
            self.factor(power, speed) * each for each, power in getattr(self, what)
        )

    def still(self, what: str) -> Any:
        """Return the sum of the terms that do not change with speed, (n, n) or 0."""
        return sum(each for each, power in getattr(self, what) if power == 0)

    def mapped(self, change: Callable[[Any], Any], *what: str) -> Self:
        """Return the terms with every matrix changed, or those of ``what`` alone."""
        parts = {name: getattr(self, name) for name in TERM_UNITS}
        for name in what or tuple(TERM_UNITS):
            parts[name] = tuple(
                (sp.csr_array(change(each)), power) for each, power in parts[name]
            )
        return type(self)(self.reference, parts["damping"], parts["stiffness"])

    def as_list(self) -> list[dict[str, Any]]:
        """Return the terms as JSON takes them; of the matrices a hash."""
        rows = []
        for what in TERM_UNITS:
            for matrix, power in getattr(self, what):
                content = hashlib.sha256()
                for part in (matrix.indptr, matrix.indices, matrix.data):
                    content.update(np.ascontiguousarray(part).tobytes())
                rows.append(
                    {"of": what, "power": power, "matrix": content.hexdigest()[:16]}
                )
        return rows


def _terms(name: str, entries: Any, size: int) -> Any:
    """Yield the pairs of one kind, checked."""
    if not isinstance(entries, Sequence) or isinstance(entries, str):
        raise ValueError(  # noqa: TRY004
            f"speed_terms: {name} = {brief(entries)}: a list of pairs is needed, matrix and power"
        )
    for entry in entries:
        if not isinstance(entry, Sequence) or len(entry) != 2:
            raise ValueError(
                f"speed_terms: {name}: {brief(entry)} is no pair of a matrix and a power"
            )
        matrix, power = entry
        if not is_whole_number(power):
            raise ValueError(
                f"speed_terms: {name}: power = {brief(power)}: a whole number is needed"
            )
        what = f"speed_terms: {name}"
        yield (
            real_square(what, numbers_in_si(what, matrix, TERM_UNITS[name]), size),
            int(power),
        )
