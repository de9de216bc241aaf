"""The sections of the study configuration: types, limits and the paper study's values."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    WithJsonSchema,
    create_model,
    field_validator,
    model_serializer,
    model_validator,
)

from squealpipe.inputs import read_distribution
from squealpipe.laws.tables import BETWEEN
from squealpipe.parameters import DEFAULTS, TABLE, Parameters, Row, without_defaults
from squealpipe.study.configuration.quantities import In
from squealpipe.substitutes import (
    SUBSTITUTES,
    Springs,
    became,
    check_together,
    equal_springs,
    stands_for,
    stood_for,
)


class Section(BaseModel):
    """A part of the configuration: unknown keys and text for numbers are mistakes."""

    model_config = ConfigDict(
        extra="forbid", strict=True, frozen=True, allow_inf_nan=False
    )


whole_validator = BeforeValidator(
    lambda value: (
        int(value) if isinstance(value, float) and value.is_integer() else value
    )
)
"""181.0 is 181, so that rewriting it changes nothing."""
Number = Annotated[float, Field(strict=True)]
Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
Points = Annotated[int, Field(ge=3, le=4001), whole_validator]
Time = Annotated[Positive, In("s", of_study=True)]
Length = Annotated[Positive, In("m", of_study=True)]
Speed = Annotated[Positive, In("m s-1", of_study=True)]
Ratio = Annotated[Positive, In("1")]


Stiffness = Annotated[float, Field(), In("N m-1")]


class StiffnessSection(Section):
    """Stiffness along the belt, across it without the contact, and the coupling of both."""

    along: Stiffness
    across: Stiffness
    coupling: Stiffness = 0.0

    @property
    def springs(self) -> Springs:
        """The two equal springs that have it."""
        return equal_springs(self.along, self.across, self.coupling)


class _ParametersBase(Section):
    """Physical parameters, in consistent units, or as texts with a unit."""

    @model_validator(mode="after")
    def _together(self) -> _ParametersBase:
        """Replace inputs that stand for parameters, and check parameters against one another."""
        if self.substitutes:
            check_together(sorted({*self.model_fields_set, *self.substitutes}))
            values = stood_for(self.substitutes, lambda name: getattr(self, name))
            self.__dict__.update(values)  # frozen for others
        Parameters(**{name: getattr(self, name) for name in TABLE})
        return self

    @property
    def substitutes(self) -> dict[str, Any]:
        """Inputs that stand for parameters, in SI."""
        inputs = {
            name: getattr(self, name)
            for name in sorted(self.model_fields_set)
            if stands_for(name) and getattr(self, name) is not None
        }
        return {
            name: value.model_dump() if isinstance(value, StiffnessSection) else value
            for name, value in inputs.items()
        }

    def became(self) -> list[str]:
        """Tell what each input that stands for parameters became."""
        return became(self.substitutes, lambda name: getattr(self, name))

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Extensions of the paper's model enter slices and ids only where they are used."""
        return without_defaults(write(self))


def _field_type(name: str, row: Row) -> Any:
    if row.allowed == "law":
        names = {"type": "string", "enum": list(row.laws.LAWS)}
        files = {
            "type": "object",
            "properties": {
                "table": {"type": "string"},
                "between": {"enum": list(BETWEEN)},
                f"{row.laws.own_law_rules.columns[0]}_column": {"type": "string"},
                "value_column": {"type": "string"},
                "python": {"type": "string"},
                **{key: {"type": "array"} for key in row.laws.own_law_rules.columns},
            },
            "additionalProperties": False,
        }
        text = {"type": "string", "pattern": f"^({'|'.join(BETWEEN)}) "}
        return Annotated[
            str,
            BeforeValidator(partial(row.check, name)),
            WithJsonSchema({"anyOf": [names, files, text]}),
        ]
    plain = (
        NUMBER_TYPES[row.allowed] | None if row.optional else NUMBER_TYPES[row.allowed]
    )
    return Annotated[plain, In(row.units)]


NUMBER_TYPES: dict[str, Any] = {
    "finite": Number,
    "positive": Positive,
    "not negative": NotNegative,
}
_OTHERS: dict[str, Any] = {
    name: (
        Annotated[NUMBER_TYPES[other.allowed] | None, In(other.units)],
        Field(None, exclude=True, description=other.meaning),
    )
    for name, other in SUBSTITUTES.items()
}


if TYPE_CHECKING:

    class ParametersSection(_ParametersBase):
        """Made from the table of parameters below."""

        stiffness: StiffnessSection | None = None

else:
    ParametersSection = create_model(
        "ParametersSection",
        __base__=_ParametersBase,
        __doc__=_ParametersBase.__doc__,
        **{
            name: (_field_type(name, row), DEFAULTS[name])
            for name, row in TABLE.items()
        },
        **_OTHERS,
        stiffness=(StiffnessSection | None, Field(None, exclude=True)),
    )
    ParametersSection.__annotations__ = {}  # the reference looks for them in the source


class LinearSection(Section):
    """Linear maps over both spring angles from 0 to π."""

    points: Points = 181


def _ascending(limits: tuple[float, float]) -> tuple[float, float]:
    if not limits[0] < limits[1]:
        raise ValueError(
            f"the lower limit {limits[0]} must be below the upper one {limits[1]}"
        )
    return limits


Range = Annotated[tuple[Ratio, Ratio], AfterValidator(_ascending)]


class InferenceSection(Section):
    """Quasi-random parameter sets that are judged by the paper's statements."""

    samples: Annotated[int, Field(ge=16, le=1_000_000), whole_validator] = 20_480
    seed: Annotated[int, Field(ge=0), whole_validator] = 2021
    kappa: Range = (0.3, 1.3)
    mu: Range = (0.02, 0.8)
    length_ratio: Range = (2.0, 100.0)
    speed_ratio: Range = (0.1, 316.0)


Harmonics = Annotated[int, Field(ge=1, le=512), whole_validator]


class HarmonicComparison(Section):
    """Harmonic balance over N_h, N/(2 N_h) and σ l_pre."""

    harmonics: Annotated[tuple[Harmonics, ...], Field(min_length=1)] = (
        4,
        8,
        16,
        32,
        64,
    )
    oversampling: Annotated[
        tuple[Annotated[int, Field(ge=1, le=256), whole_validator], ...],
        Field(min_length=1),
    ] = (1, 4, 16)
    sigmas: Annotated[
        tuple[Annotated[Positive, In("m-1", of_study=True)], ...], Field(min_length=1)
    ] = (10.0, 100.0, 1e3)
    repeats: Annotated[int, Field(ge=1, le=100), whole_validator] = 3


class BenchmarkComparison(Section):
    """Integrators with events: solvers, tolerances, and whether peers run too.

    Peers' answers are shipped with the package; one whose answers are not, or each of them with
    ``run_peers``, runs here, if it is installed.
    """

    solvers: Annotated[tuple[str, ...], Field(min_length=1)] = (
        *("squealpipe", "DOP853", "DOP853, bounded step", "DOP853, compiled field"),
        *("RK45", "LSODA", "heyoka", "CyRK", "SUNDIALS"),
        *("tanh, σ = 10", "tanh, σ = 1000", "tanh, σ = 1e+07", "Moreau–Jean"),
    )
    tolerances: Annotated[
        tuple[Annotated[float, Field(ge=1e-13, lt=1e-2), In("1")], ...],
        Field(min_length=1),
    ] = (1e-6, 1e-8, 1e-10, 1e-12)
    run_peers: bool = False


class LadderComparison(Section):
    """The cheapest adequate model over both angles; horizon in √(m/k1)."""

    points: Annotated[int, Field(ge=3, le=361), whole_validator] = 46
    tolerance: Annotated[float, Field(gt=0, lt=1), In("1")] = 0.05
    horizon: Time = 200.0


class ComparisonSection(Section):
    """Work–precision, and the model ladder."""

    benchmark: BenchmarkComparison = BenchmarkComparison()
    harmonic: HarmonicComparison = HarmonicComparison()
    ladder: LadderComparison = LadderComparison()


class DynamicsSection(Section):
    """Nonlinear runs; times in √(m/k1), amplitudes in l_pre, speeds in l_pre √(k1/m)."""

    tol: Annotated[float, Field(gt=1e-18, lt=1e-2), In("1")] = 1e-12
    validity_horizon: Time = 200.0
    validity_points: Points = 181
    refined_points: Points = 1441
    refined_coarse: Points = 91
    chart_horizon: Time = 25.0
    hammering_horizon: Time = 500.0
    hammering_points: Points = 91
    whirl_speeds: Annotated[tuple[Speed, Speed], AfterValidator(_ascending)] = (
        0.3,
        300.0,
    )
    whirl_count: Annotated[int, Field(ge=2, le=1000), whole_validator] = 31
    whirl_horizon: Time = 10_000.0
    transient_samples: Annotated[int, Field(ge=2, le=100_000), whole_validator] = 400
    transient_horizon: Time = 20_000.0


Angle = Annotated[float, Field(ge=-2.0, le=2.0), In("rad")]


class BackbonesSection(Section):
    """Periodic motions of A4; angles over π, lengths over l_pre."""

    coupled: dict[Annotated[str, Field(pattern=r"^[a-z]\w*$")], tuple[Angle, Angle]] = {
        "coupled": (0.3, 0.9),
        "slow": (0.2, 0.7),
    }
    y_peak_max: Length = 6.0
    x_amplitude_max: Length = 3.0
    n_harmonics: Harmonics = 32
    length_ratios: Annotated[tuple[Length, ...], Field(min_length=1)] = (
        5.0,
        15.0,
        100.0,
    )


dashpot_unit = In("N s m-1", of_study=True)


class CyclesSection(Section):
    """Limit cycles of the damped full model; angles over π, times in √(m/k1).

    ``damping`` is that of each dashpot over √(k1 m): twice the damping ratio of one spring.
    """

    damping: Annotated[Positive, dashpot_unit] = 0.02
    mu: Range = (0.01, 1.0)
    flutter: tuple[Angle, Angle] = (0.305, 0.07)
    points: Annotated[int, Field(ge=2, le=5000), whole_validator] = 150
    settle: Time = 6000.0
    extremes_mu: Annotated[int, Field(ge=2, le=1000), whole_validator] = 17
    extremes_starts: Annotated[int, Field(ge=1, le=1000), whole_validator] = 6
    extremes_horizon: Time = 2000.0


class Distribution(Section):
    """One uncertain parameter; which two numbers are needed depends on the distribution."""

    distribution: Literal["uniform", "normal", "lognormal"]
    low: Number | None = None
    high: Number | None = None
    mean: Number | None = None
    std: Number | None = None
    median: Number | None = None
    log_std: Annotated[Number, In("1")] | None = None

    @model_serializer(mode="wrap")
    def _written(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {name: value for name, value in write(self).items() if value is not None}


class RobustnessSection(Section):
    """Settings of the robustness of verdicts, and of propensities over uncertain parameters; angles
    over π.
    """

    random_starts: Annotated[int, Field(ge=2, le=100_000), whole_validator] = 200
    basin_points: Annotated[int, Field(ge=2, le=2001), whole_validator] = 41
    basin_extent: Speed = 12.0
    basin_horizon: Time = 300.0
    disturbance_directions: Annotated[int, Field(ge=8, le=100_000), whole_validator] = (
        64
    )
    disturbance_horizon: Time = 100.0
    critical_damping: tuple[
        Annotated[NotNegative, dashpot_unit], Annotated[NotNegative, dashpot_unit]
    ] = (0.02, 0.01)
    critical_points: Points = 61
    critical_extent: Annotated[Positive, dashpot_unit] = 0.1
    scene: tuple[Angle, Angle] = (0.305, 0.07)
    samples: Annotated[int, Field(ge=64, le=2**20), whole_validator] = 4096
    horizon: Time = 200.0
    spring_correlation: Annotated[float, Field(gt=-1, lt=1), In("1")] = 0.0
    distributions: Annotated[dict[str, Distribution], Field(min_length=1)] | None = None

    @field_validator("distributions", mode="before")
    @classmethod
    def _with_units(cls, written: Any) -> Any:
        """Numbers of each distribution in the units of its parameter."""
        if not isinstance(written, Mapping):
            return written
        return {
            name: read_distribution(name, numbers)
            if isinstance(numbers, Mapping)
            else numbers
            for name, numbers in written.items()
        }


class ContactPointsSection(Section):
    """An elastic pad on several contact points of equal total stiffness and preload."""

    points: Annotated[
        tuple[Annotated[int, Field(ge=1, le=16), whole_validator], ...],
        Field(min_length=1),
    ] = (1, 2, 4, 8)
    stiff_points: Annotated[int, Field(ge=1, le=16), whole_validator] = 4
    mu: NotNegative = 0.5
    modal_damping: Annotated[float, Field(ge=0, lt=1)] = 0.01
    n_modes: Annotated[int, Field(ge=2, le=32), whole_validator] = 20
    samples: Annotated[int, Field(ge=1, le=10_000), whole_validator] = 4
    t_end: Annotated[Positive, In("s")] = 0.06


class ExplorerSection(Section):
    """The click grid of the explorer page; times in √(m/k1)."""

    points: Annotated[int, Field(ge=3, le=61), whole_validator] = 31
    history_time: Time = 60.0
    spectrum_time: Time = 180.0
    samples: Annotated[int, Field(ge=16, le=2000), whole_validator] = 400
    branch_points: Annotated[int, Field(ge=2, le=200), whole_validator] = 24
