"""The brake of a command, whatever it is told by: a study, options, and what stands for them."""

from collections.abc import Sequence
from typing import Any

from cyclopts import App, ArgumentCollection, Token

from squealpipe.cli.console import current_session, say
from squealpipe.parameters import DEFAULTS, TABLE, UNITS_OF_INPUTS, read_substitutes
from squealpipe.substitutes import (
    SUBSTITUTES,
    became,
    check_together,
    equal_springs,
    rivals,
    stands_for,
    stood_for,
)
from squealpipe.systems.inputs.units import UnitError, has_unit, in_si

FLAGS = {name: f"--{name.replace('_', '-')}" for name in (*TABLE, *SUBSTITUTES)}
UNITS_OF_FLAGS = {FLAGS[name]: units for name, units in UNITS_OF_INPUTS.items()}


def read_brake(_: App, __: tuple[str, ...], arguments: ArgumentCollection) -> None:
    """Give the parameters of a command their numbers in SI.

    What was typed takes the place of what ``--config`` says, in other words too: a typed force
    that of a preload there.
    """
    options = {argument.name: argument for argument in arguments}
    if (
        "--config" not in options
    ):  # a command without a brake, whose --mu may be a range
        return
    physical = {name: options[flag] for name, flag in FLAGS.items() if flag in options}
    texts = {
        name: argument.tokens[-1].value
        for name, argument in physical.items()
        if argument.tokens
    }
    typed = {name: _number(name, text) for name, text in texts.items()}
    check_together(list(typed))
    current_session.typed = {
        part for name in typed for part in (stands_for(name) or (name,))
    }
    if not physical:
        return
    paths = [token.value for token in options["--config"].tokens]
    inputs = {
        **{
            name: value
            for name, value in _of_study(paths).items()
            if not rivals(name, typed)
        },
        **typed,
    }
    written = read_substitutes(
        {name: value for name, value in inputs.items() if stands_for(name)}
    )
    if written:
        numbers = DEFAULTS | {
            name: row.check(name, inputs[name])
            for name, row in TABLE.items()
            if name in inputs
        }
        values = stood_for(written, numbers.__getitem__)
        inputs |= values
        for line in became(written, (numbers | values).__getitem__):
            say(line)
    for name in TABLE.keys() & inputs.keys() & physical.keys():
        if name not in texts or has_unit(texts[name]):
            physical[name].tokens.clear()
            physical[name].append(
                Token(
                    keyword=FLAGS[name],
                    value=str(inputs[name]),
                    source=", ".join(paths) or "cli",
                )
            )
    # the angles of a command that takes them in their order
    angle_arguments = ("ALPHA1", "ALPHA2")
    if "stiffness" in written and not any(_tokens(options, angle_arguments)):
        springs = equal_springs(**written["stiffness"])
        for name, angle in zip(angle_arguments, springs[1:], strict=True):
            if name in options:
                options[name].append(Token(value=repr(angle), source=", ".join(paths)))


def _tokens(options: dict[str, Any], names: Sequence[str]) -> list[Any]:
    return [options[name].tokens for name in names if name in options]


def _number(name: str, text: str) -> Any:
    """The number of a typed text, in SI; text that is none is left for others to refuse."""
    flag = FLAGS[name]
    if flag in UNITS_OF_FLAGS and has_unit(text):
        try:
            return in_si(text, UNITS_OF_FLAGS[flag], UNITS_OF_FLAGS)
        except UnitError as error:
            raise ValueError(f"{flag} {text}: {error}") from None
    if flag in UNITS_OF_FLAGS and "_" in text:  # which Python takes for a number
        raise ValueError(
            f"{flag} {text}: it is not a number; write for instance 1000 or 1e3"
        )
    try:
        return float(text)
    except ValueError:
        return text


def _of_study(paths: Sequence[str]) -> dict[str, Any]:
    """Parameters of a study, with what stands for some in their place."""
    if not paths:
        return {}
    from squealpipe.study.configuration.settings import read_study

    section = read_study(*paths).parameters
    written = section.substitutes
    values = {name: getattr(section, name) for name in TABLE}
    return written | {
        name: value
        for name, value in values.items()
        if value is not None and not rivals(name, written)
    }
