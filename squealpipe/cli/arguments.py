"""The option types that every command shares, and parameters taken from a study."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Group, Parameter

from squealpipe.inputs import STATE_NAMES, parse_angle, parse_number, reader
from squealpipe.parameters import SYMBOLS, Parameters
from squealpipe.ranges import parse_range
from squealpipe.substitutes import SUBSTITUTES
from squealpipe.systems.inputs.units import has_unit, in_si
from squealpipe.systems.inputs.words import as_number


def _reader(read: Callable[[str], Any]) -> Callable[[Any, Sequence[Any]], Any]:
    """Return the converter that cyclopts applies to one text."""
    return lambda _, tokens: read(tokens[0].value)


def _parse_whole(text: str) -> int:
    number = as_number(text)
    if not number.is_integer():
        raise ValueError(
            f"{text!r} is not a whole number; write for instance 100, without a unit"
        )
    return int(number)


_whole = _reader(_parse_whole)


def _signed(read: Callable[[str], Any], metavar: str, **further: Any) -> Parameter:
    """One text, which may begin with a minus sign."""
    return Parameter(
        converter=_reader(read),
        metavar=metavar,
        allow_leading_hyphen=True,
        n_tokens=1,
        **further,
    )


parse_share = partial(parse_number, units="1")
"""A number without a unit, or in per cent."""
Numbers = Annotated[
    list[float] | None,
    _signed(partial(parse_range, one=parse_share), "RANGE", negative=""),
]
"""A number, a list of them or first:last:count."""


def _parse_friction(text: str) -> list[float] | dict[str, list[float]]:
    """A range of the friction of a structure, or ``lining=0:0.6:13`` of one contact or face."""
    name, equals, values = text.rpartition("=")
    numbers = parse_range(values, one=parse_share)
    return {name.strip(): numbers} if equals else numbers


SpeedTexts = Annotated[str | None, _signed(str, "RANGE", negative="")]
"""A number, a list of them or first:last:count of speeds, read where their unit is known."""
Frictions = Annotated[Any, _signed(_parse_friction, "[NAME=]RANGE", negative="")]
"""Friction of a structure, or of one of its contacts or faces."""
Ranges = Annotated[list[str], Parameter(metavar="NAME=RANGE", negative="")]
Whole = Annotated[int, Parameter(converter=_whole, metavar="INT", n_tokens=1)]


def angle_of_spring(which: str) -> Parameter:
    """One angle, and how it is counted."""
    return _signed(
        parse_angle, "ANGLE", help=f"{which}: 0.4pi, 2pi/5, 72deg or radians."
    )


Angle1 = Annotated[
    float, angle_of_spring("angle of spring 1 to +x, the way a belt of V > 0 runs")
]
Angle2 = Annotated[float, angle_of_spring("angle of spring 2 to −x")]
OptionalAngle2 = Annotated[
    float | None, angle_of_spring("angle of spring 2 to −x (none for a structure)")
]


def _angle_or_file(text: str) -> float | Path:
    """Read the angle of spring 1, or the name of a structure's file."""
    is_file = Path(text).suffix.lower() in {".yaml", ".yml"} or Path(text).is_file()
    return Path(text) if is_file else parse_angle(text)


Angle1OrFile = Annotated[
    float | Path,
    _signed(
        _angle_or_file,
        "ANGLE|FILE",
        help="angle of spring 1 to +x, the way a belt of V > 0 runs: 0.4pi, 2pi/5, 72deg or "
        "radians; or the file of a structure.",
    ),
]
AngleRange = Annotated[
    list[float],
    _signed(
        partial(parse_range, one=parse_angle),
        "RANGE",
        negative="",
        show_default="0:pi:61",
        help="angles of this spring (alpha1 to +x, alpha2 to −x), first:last:count or a list.",
    ),
]
Time = Annotated[float, _signed(partial(parse_number, units="s"), "TIME")]
Length = Annotated[float, _signed(partial(parse_number, units="m"), "LENGTH")]
Speed = Annotated[float, _signed(partial(parse_number, units="m s-1"), "SPEED")]
Lengths = Annotated[
    list[float] | None,
    _signed(partial(parse_range, one=reader("x")), "RANGE", negative=""),
]
Speeds = Annotated[
    list[float] | None,
    _signed(partial(parse_range, one=reader("vx")), "RANGE", negative=""),
]
Frequency = Annotated[
    float | None, _signed(partial(parse_number, units="Hz"), "FREQUENCY", negative="")
]
StructureFile = Annotated[
    Path,
    Parameter(
        help="structure, a YAML file that names its matrices and contacts (see the gallery)."
    ),
]
ModesOfRuns = Annotated[
    int | None,
    Parameter(
        converter=_whole,
        metavar="INT",
        n_tokens=1,
        help="modes to reduce a structure to, at most 512; by default as many as errors below 1 % "
        "need, and no reduction up to 32 degrees of freedom.",
    ),
]
BandOfRuns = Annotated[
    float | None,
    _signed(
        partial(parse_number, units="Hz"),
        "FREQUENCY",
        negative="",
        help="end of the band whose unstable modes count, Hz: they are compared with those of the "
        "whole structure and decide how many modes are run. Runs also have modes beyond; a motion "
        "that ends there is marked. By default 20 kHz where modes lie beyond it, but needed beyond "
        "1000 degrees of freedom.",
    ),
]


def parse_state(text: str) -> list[float]:
    """Displacements and speeds from a text like ``0.1mm,0.2mm,0,50mm/s``."""
    parts = text.split(",")
    if len(parts) != len(STATE_NAMES):
        raise ValueError(
            f"{text!r} is not a state x,y,vx,vy; write for instance 0.1mm,0.2mm,0,50mm/s"
        )
    return [reader(name)(part) for name, part in zip(STATE_NAMES, parts, strict=True)]


def parse_size(text: str) -> tuple[float, float]:
    """Width and height of a picture in inches from a text like ``90mm x 60mm``."""
    sides = text.replace("×", "x").split("x")
    if len(sides) != 2 or not all(map(has_unit, sides)):
        raise ValueError(
            f"{text!r} is no size of a picture; write for instance 90mmx60mm"
        )
    # Matplotlib counts in inches
    width, height = (in_si(side, "m") / 0.0254 for side in sides)
    if not (0.5 <= width <= 100 and 0.5 <= height <= 100):
        raise ValueError(f"{text!r}: each side must be between 13 mm and 2.5 m")
    return width, height


FigureSize = Annotated[
    tuple[float, float] | None,
    Parameter(
        converter=_reader(parse_size),
        negative="",
        metavar="WIDTHxHEIGHT",
        n_tokens=1,
        help="size of the picture, like 90mmx60mm.",
    ),
]
Dpi = Annotated[
    int | None,
    Parameter(
        converter=_whole,
        metavar="INT",
        n_tokens=1,
        help="dots per inch of the picture; 200 by default.",
    ),
]
Units = Annotated[
    list[str] | None,
    Parameter(
        name="--unit",
        negative="",
        metavar="UNIT",
        help="unit of the axes that show its quantity, like mm, kN or Hz; repeatable.",
    ),
]
State = Annotated[list[float] | None, _signed(parse_state, "X,Y,VX,VY", negative="")]
Tolerance = Annotated[
    float, _signed(parse_share, "FLOAT", help="tolerance of the integration.")
]
Share = Annotated[float, _signed(parse_share, "FLOAT")]
Workers = Annotated[
    int | None,
    Parameter(converter=_whole, metavar="INT", help="processes; all cores by default."),
]
Configs = Annotated[list[Path] | None, Parameter(name=["--config", "-c"], negative="")]
Output = Annotated[
    Path,
    Parameter(
        name=["--output", "-o"],
        allow_leading_hyphen=True,
        help="dataset to write: NetCDF (.nc) or CSV (.csv).",
    ),
]
OutputElsewhere = Annotated[Path | None, Parameter(name=["--output", "-o"])]
AsJson = Annotated[bool, Parameter(name="--json", negative="")]
Switch = Annotated[bool, Parameter(negative="")]
Force = Annotated[bool, Parameter(negative="", help="overwrite files that exist.")]
Tolerances = Annotated[
    list[float] | None,
    Parameter(
        converter=lambda _, tokens: [parse_share(token.value) for token in tokens],
        negative="",
        metavar="FLOAT",
        n_tokens=1,
    ),
]
Texts = Annotated[list[str] | None, Parameter(negative="")]

baseline_parameters = Parameters()


physical_parameters = Group(
    "Physical parameters", help="In SI, or with a unit like 0.57mm.", sort_key=10
)


def _instead(name: str) -> Any:
    """An option that stands for parameters; ``inputs.py`` replaces it by these."""
    meaning = SUBSTITUTES[name].meaning
    group = Group("Instead of parameters", help="With a unit, or in SI.", sort_key=11)
    return Parameter(group=group, metavar="QUANTITY", help=f"{meaning}.")


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Brake:
    """The brake of a command."""

    config: Annotated[
        Configs,
        Parameter(
            help="study whose parameters are used where none are typed; repeatable."
        ),
    ] = None
    params: Annotated[
        Parameters,
        Parameter(name="*", group=physical_parameters, allow_leading_hyphen=True),
    ] = baseline_parameters
    preload_force: Annotated[str | None, _instead("preload_force")] = None
    pressure: Annotated[str | None, _instead("pressure")] = None
    area: Annotated[str | None, _instead("area")] = None
    damping_ratio: Annotated[str | None, _instead("damping_ratio")] = None


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Written(Brake):
    """The brake of a command that writes a dataset."""

    force: Force = False


Picture = Annotated[
    Path | None,
    Parameter(
        name=["--picture", "-p"],
        help="picture to write (png, svg or pdf); by default beside the output.",
    ),
]


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Look:
    """Options of the look of a picture."""

    figure_size: FigureSize = None
    dpi: Dpi = None
    unit: Units = None


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Drawn(Look, Written):
    """The brake of a command that writes a dataset and its picture."""

    picture: Picture = None


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Files(Look):
    """Options of the files that a command on a file writes beside its dataset."""

    picture: Picture = None
    force: Force = False


default_brake, written_output, drawn_output, default_look, structure_files = (
    Brake(),
    Written(),
    Drawn(),
    Look(),
    Files(),
)
full_range = parse_range("0:pi:61", parse_angle)
"""Both spring angles from 0 to π."""


def by_name(argument: str) -> str:
    """An option by the name of its parameter where it is given by the paper's symbol: --V."""
    flag, equals, value = argument.partition("=")
    name = SYMBOLS.get(flag[2:]) if flag.startswith("--") else None
    return f"--{name.replace('_', '-')}{equals}{value}" if name else argument


def pairs_of(flag: str, texts: Sequence[str]) -> dict[str, str]:
    """Name → value of each NAME=VALUE."""
    pairs: dict[str, str] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not (name and equals and value):
            raise ValueError(
                f"{text!r} is not NAME=VALUE; write for instance mu=0:0.6:13"
            )
        key = name.strip().replace("-", "_")
        key = SYMBOLS.get(key, key)
        if key in pairs:
            raise ValueError(
                f"{flag} {key} is a duplicate; keep one, with all its values"
            )
        pairs[key] = value
    return pairs


def modifications_of(texts: Sequence[str]) -> dict[str, Any]:
    """Return modifications of a structure by name, as :func:`squealpipe.assess` takes them."""
    # the command starts without matrices
    from squealpipe.structures.assess.modifications import counted_from_zero

    by_name: dict[str, Any] = {}
    for name, content in pairs_of("--modify", texts).items():
        kind, *words = content.split()
        if len(words) != 2 and not (kind == "patch" and len(words) == 3):
            raise ValueError(
                f"--modify {name}={content}: a kind, a place and the largest amount are needed, "
                'like "weight=added_mass 12 0.1", "edge=chamfer lining 0.2" or, with mass and '
                'damping ratio, "shim=patch BACK 0.2 0.05"'
            )
        place, *amounts = words
        values = [
            amount if has_unit(amount) else as_number(amount) for amount in amounts
        ]
        if kind == "chamfer":
            by_name[name] = {kind: {"face": place, "share": values[0]}}
        elif kind == "patch":
            # 0: a patch of damping alone
            both = zip(("mass", "damping_ratio"), values, strict=False)
            by_name[name] = {
                kind: {"nodes": _nodes(place)} | {k: v for k, v in both if v}
            }
        else:
            by_name[name] = {kind: {place: values[0]}}
    return counted_from_zero(by_name)


def _nodes(text: str) -> str | list[int]:
    """Read the name of a node set, or numbers of nodes like 5005,5006."""
    numbers = text.split(",")
    return (
        [int(number) for number in numbers] if all(map(str.isdigit, numbers)) else text
    )
