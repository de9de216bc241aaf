"""Operating points of a structure: check what is asked, run each point, and make the map.

Idea: nothing but preload, speed and friction changes from point to point, so that the structure is
reduced once, to the modes that its largest friction needs. Where small motions die out and no
contact opens or sticks in a first window, forces are linear and the point is quiet; only the others
are run until they have settled.

Invariant: points are independent; in any order and in any number of processes, or in parts
on several machines, the map is the same, and each has the answer of ``assess``. Cost: 0.02 s of CPU
where a point is quiet; for 12 modes and 4 contacts 0.2 s where a motion repeats, and 5 to 30 s
where it is irregular.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Self

import numpy as np
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.ranges import parse_range
from squealpipe.schema import Outcome, build
from squealpipe.structures.assess.cures import with_preload
from squealpipe.structures.assess.designs import Design, Structures, pushed
from squealpipe.structures.assess.measured import matched, read_noises
from squealpipe.structures.assess.operating_units import FrictionTable, OperatingUnits
from squealpipe.structures.assess.records import levels
from squealpipe.structures.definition import ContactStructure
from squealpipe.structures.schema.operating_map import (
    QUANTITIES,
    operating_map_schema,
    over_temperature_schema,
)
from squealpipe.structures.squeal.plant import Plant, in_modes
from squealpipe.structures.squeal.windows import Running
from squealpipe.systems.inputs.values import brief
from squealpipe.systems.inputs.words import suggestion
from squealpipe.vibration.schema import MEAN_SQUARES, error_of
from squealpipe.vibration.settling import settling_of_numbers

_MEASURED = ("frequency", "velocity_rms")
VALUES = (
    *_MEASURED,
    *map(error_of, _MEASURED),
    *("separated_fraction", "growth_rate", "leading_frequency", "friction"),
)
FLAGS = ("verdict", "unstable_modes", "outcome")


@dataclass(frozen=True, kw_only=True)
class OperatingPoints:
    """Operating points of a structure.

    Attributes:
        structure: at its own preload; once :meth:`reduced`, in the modes in which it is run.
        axes: values of each dimension of the map.
        tables: tables of friction, each over one quantity.
        factor: factor of friction, the value of ``mu`` if that is no dimension.
        units: units of pressures and speeds.
        noises: file of measured noises, or None.
        frequency_band: largest difference of frequencies of one noise, over the measured one.
        band_edges: edges of the bands of occurrence, Hz; None: third octaves.
        tol: tolerance of the runs.
    """

    structure: ContactStructure
    axes: Mapping[str, np.ndarray]
    tables: Sequence[FrictionTable]
    factor: float
    units: OperatingUnits
    noises: Any = None
    frequency_band: float = 0.05
    band_edges: Any = None
    tol: float = 1e-12

    @classmethod
    def of(
        cls,
        structure: ContactStructure,
        *,
        pressure: Any = (1.0,),
        speed: Any = None,
        mu: Any = None,
        temperature: Any = None,
        mu_of: Any = None,
        measured: Any = None,
        frequency_band: float = 0.05,
        band_edges: Any = None,
        tol: float = 1e-12,
    ) -> Self:
        """Check what is asked of a structure, which is not reduced yet.

        Arguments are those of :func:`.operating_map`.

        Raises:
            FileNotFoundError: a file is missing.
            ValueError: an argument.
        """
        whole = structure.with_common_mu()
        units = OperatingUnits.of(whole)
        tables = _tables(mu_of, units)
        varies = mu is not None or bool(tables)
        if varies and whole.contacts and whole.has_own_mu.all():
            raise ValueError(
                f"{'mu' if mu is not None else 'mu_of'}: every contact has a mu of its own, "
                "which this would not change; remove those from the contacts"
            )
        # with tables, which are coefficients, the factor is 1 by default
        common = 1.0 if tables else whole.mu
        axes = {
            "pressure": _axis("pressure", pressure, units),
            "speed": _axis(
                "speed", whole.belt_speed if speed is None else speed, units
            ),
            "mu": _axis("mu", common if mu is None else mu, units),
        }
        factor = 1.0
        if temperature is not None:
            if "temperature" not in {table.quantity for table in tables}:
                raise ValueError(
                    "temperature: only friction depends on it; give mu_of={'temperature': table}"
                )
            if axes["mu"].size > 1:
                raise ValueError(
                    f"mu = {brief(mu)}: friction is a table over temperature; give one mu, a "
                    "factor of the table, or none"
                )
            factor = float(axes.pop("mu")[0])
            axes["temperature"] = _axis("temperature", temperature, units)
        for table in tables:
            if table.quantity not in axes:
                raise ValueError(
                    f"mu_of: {table.quantity}: give {table.quantity}=[…], the values at which "
                    "friction is looked up"
                )
            table.at(axes[table.quantity])  # values beyond the table
        # an unreadable list raises before anything is computed
        if measured is not None:
            read_noises(measured, units)
        edges = None if band_edges is None else _edges(band_edges)
        asked = cls(
            structure=whole,
            axes=axes,
            tables=tables,
            factor=factor,
            units=units,
            noises=None if measured is None else str(measured),
            frequency_band=frequency_band,
            band_edges=edges,
            tol=tol,
        )
        largest = float(asked.frictions.max())
        if varies and largest > whole.largest_mu:
            raise ValueError(
                f"mu = {largest:g} is above {whole.largest_mu:g}, which mu_static allows"
            )
        return asked

    def reduced(
        self, n_modes: int | None = None, frequency_max: float | None = None
    ) -> Self:
        """Return the same points of the structure reduced to the modes in which it is run.

        These are the modes needed at the largest friction, at which most modes grow.

        Args:
            n_modes, frequency_max: limits of the reduction; None: as many modes as are needed.

        Raises:
            ValueError: no contacts; a structure that is too large.
        """
        reference = self.structure.with_(mu=float(self.frictions.max()))
        running = Plant(in_modes(reference, n_modes, frequency_max))
        if running.obstacle:
            raise ValueError(f"the structure cannot be run: {running.obstacle}")
        # without the whole structure, which would be handed to every process
        bare = running.structure.with_(contacts=running.structure.contacts)
        return replace(self, structure=bare)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each dimension."""
        return tuple(len(values) for values in self.axes.values())

    @property
    def count(self) -> int:
        """Number of points."""
        return int(np.prod(self.shape))

    @property
    def frictions(self) -> np.ndarray:
        """Friction at all points of the contacts without a coefficient of their own, (axes…)."""
        grids = dict(
            zip(self.axes, np.meshgrid(*self.axes.values(), indexing="ij"), strict=True)
        )
        friction = grids.get("mu", np.full(self.shape, self.factor))
        for table in self.tables:
            friction = friction * table.at(grids[table.quantity])
        return np.asarray(friction)

    def run(self, place: int) -> dict[str, Any]:
        """Return the results at one point; ``place`` counts points in the order of the dimensions.

        Each value is a number, or the code of a flag.
        """
        indices = np.unravel_index(place, self.shape)
        at = {
            name: float(values[int(index)])
            for (name, values), index in zip(self.axes.items(), indices, strict=True)
        }
        friction = float(self.frictions[indices])
        pressed = with_preload(self.structure, at["pressure"])
        design = Design(pressed.with_(belt_speed=at["speed"], mu=friction))
        return _of_point(design, Structures(self.tol, 0, 0, 1)) | {"friction": friction}

    def dataset(self, columns: Mapping[str, np.ndarray]) -> xr.Dataset:
        """Build the dataset from the results at all points, in order."""
        values = {
            name: np.reshape(columns[name], self.shape) for name in (*VALUES, *FLAGS)
        }
        with np.errstate(divide="ignore"):
            # reference of velocity levels in decibels, m/s
            reference_velocity = 5e-8
            level = 20.0 * np.log10(values["velocity_rms"] / reference_velocity)
        values["velocity_level"] = np.where(np.isfinite(level), level, np.nan)
        noisy = np.isin(values["verdict"], (Verdict.squeals, Verdict.hammers))
        schema = (
            over_temperature_schema
            if "temperature" in self.axes
            else operating_map_schema
        )
        noises = [] if self.noises is None else read_noises(self.noises, self.units)
        bands = self._bands(
            [*values["frequency"][noisy], *[n.frequency for n in noises]]
        )
        coordinates = {
            **self.axes,
            "band": bands.pop("band"),
            "contact": [contact.name for contact in self.structure.contacts],
        }
        known = {
            **values,
            **bands,
            "occurrence": _share(values["frequency"], bands),
            "share_noisy": float(noisy.mean()),
            "share_undetermined": float(
                (values["verdict"] == Verdict.undetermined).mean()
            ),
            "mean_pressure": self.units.mean_pressure,
            "n_modes": self.structure.size,
        }
        points = build(schema, known, coordinates)
        if not noises:
            return points
        compared = matched(points, noises, self.frequency_band)
        compared["measured_occurrence"] = _share(compared["measured_frequency"], bands)
        found = build(schema, {**known, **compared}, coordinates)
        named = {name for noise in noises for name in noise.point}
        if left_out := sorted(named - {*self.axes}):
            found.attrs["not_compared"] = ", ".join(left_out)
        return found

    def _bands(self, frequencies: Sequence[float]) -> dict[str, np.ndarray]:
        """Return middles and edges of the bands, Hz.

        Third octaves are those of IEC 61260 with base 10: middles 1000 · 10^(k/10) Hz, edges half a
        band away; all from the lowest to the highest that is heard.
        """
        if self.band_edges is not None:
            low, high = self.band_edges[:-1], self.band_edges[1:]
            return {"band": np.sqrt(low * high), "band_low": low, "band_high": high}
        known = np.array(
            [frequency for frequency in frequencies if np.isfinite(frequency)]
        )
        numbers = np.rint(10.0 * np.log10(known / 1000.0)).astype(int)
        first, last = (numbers.min(), numbers.max()) if known.size else (0, -1)
        middle = 1000.0 * 10.0 ** (np.arange(first, last + 1) / 10.0)
        half = 10.0**0.05
        return {"band": middle, "band_low": middle / half, "band_high": middle * half}


def _share(frequencies: np.ndarray, bands: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the share of frequencies in each band; NaN ones, which are quiet, count as well."""
    every = np.ravel(frequencies)
    low, high = bands["band_low"][:, None], bands["band_high"][:, None]
    return np.asarray(((every >= low) & (every < high)).mean(axis=1))


def _tables(mu_of: Any, units: OperatingUnits) -> tuple[FrictionTable, ...]:
    """Read tables of friction by the name of their quantity."""
    if mu_of is None:
        return ()
    if not isinstance(mu_of, Mapping) or not mu_of:
        raise ValueError(
            f"mu_of = {brief(mu_of)}: {{'temperature': table}} is needed, or one over pressure or "
            "speed"
        )
    known = [name for name in QUANTITIES if name != "mu"]
    for name in mu_of:
        if name not in known:
            raise ValueError(f"mu_of: {name!r}: {suggestion(str(name), known)}")
    return tuple(FrictionTable.read(name, mu_of[name], units) for name in mu_of)


def _axis(name: str, values: Any, units: OperatingUnits) -> np.ndarray:
    """Return the values of one dimension, each once.

    Raises:
        ValueError: names the value.
    """
    if isinstance(values, str):  # a range, as on the command line
        several = parse_range(values, partial(units.number, name, name))
    else:
        several = [values] if np.ndim(values) == 0 else [*values]
    numbers = np.array([units.number(name, name, each) for each in _plain(several)])
    if not numbers.size or len(np.unique(numbers)) < numbers.size:
        raise ValueError(
            f"{name} = {brief(values)}: one or more values, each once, are needed"
        )
    if name == "pressure" and not (numbers > 0.0).all():
        raise ValueError(f"pressure = {numbers.min():g}: it must be greater than 0")
    if name == "mu" and not (numbers >= 0.0).all():
        raise ValueError(f"mu = {numbers.min():g}: it must not be negative")
    if name == "speed" and not numbers.all():
        raise ValueError("speed = 0: nothing slides; leave it out")
    return numbers


def _plain(values: Sequence[Any]) -> Iterator[Any]:
    """Yield numbers of numpy as Python's."""
    for value in values:
        yield value.item() if isinstance(value, np.generic) else value


def _edges(written: Any) -> np.ndarray:
    """Return the edges of bands, Hz."""
    read = partial(OperatingUnits("", np.nan).number, "band_edges", "frequency")
    if isinstance(written, str):
        written = parse_range(written, read)
    several = [written] if np.ndim(written) == 0 else [*written]
    edges = np.array([read(each) for each in _plain(several)])
    if len(edges) < 2 or not (edges > 0.0).all() or not (np.diff(edges) > 0.0).all():
        raise ValueError(
            f"band_edges = {brief(written)}: two or more ascending frequencies above 0 Hz are "
            "needed"
        )
    return edges


def _of_point(design: Design, family: Structures) -> dict[str, Any]:
    """Return the results at one operating point."""
    nothing = dict.fromkeys(VALUES, np.nan)
    start = pushed(design)
    plant = design.plant
    if start is None or plant is None:
        undetermined = {"verdict": Verdict.undetermined, "unstable_modes": 0}
        return nothing | undetermined | {"outcome": Outcome.no_sliding_state}
    (run,) = family.settled([start], settling_of_numbers)
    known: dict[str, Any] = {
        "verdict": run.verdict,
        "growth_rate": float(plant.spectrum.values.real.max()),
        "leading_frequency": float(
            plant.frequencies[plant.spectrum.values.real.argmax()]
        ),
        "unstable_modes": plant.unstable.size,
        "outcome": Outcome.converged if run.agrees else Outcome.unresolved,
    }
    if run.unbounded:
        known["outcome"] = Outcome.not_finite
    if run.quiet:
        still = ("velocity_rms", "separated_fraction", *map(error_of, _MEASURED))
        return nothing | known | dict.fromkeys(still, 0.0)
    if not run.agrees:
        return nothing | known
    scalars, _ = levels(design, run, how=Running(family.tol, family.seed, 1))
    measured = {
        name: scalars[name]
        for name in ("frequency", error_of("frequency"), "separated_fraction")
    }
    return nothing | known | measured | _of_all_directions(scalars)


def _of_all_directions(scalars: Mapping[str, Any]) -> dict[str, float]:
    """Return the level of both directions together, with its error, m/s."""
    total = float(np.hypot(*(scalars[name] for name in MEAN_SQUARES)))
    # errors of one motion are not independent: the bound is their sum
    error = (
        sum(scalars[name] * scalars[error_of(name)] for name in MEAN_SQUARES) / total
    )
    return {"velocity_rms": total, error_of("velocity_rms"): float(error)}
