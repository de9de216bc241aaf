"""Tell structures from pads on two springs, for functions that take either."""

from collections.abc import Mapping
from typing import Any

from squealpipe.parameters import Parameters
from squealpipe.structures.definition import ContactStructure
from squealpipe.systems.inputs.values import brief


def is_structure(
    params: Any, *, of_pads: Mapping[str, Any], of_structures: Mapping[str, Any]
) -> bool:
    """Tell whether this is a structure, and not a pad.

    Args:
        of_pads, of_structures: arguments that only the one of them has, by name; None: left out.

    Raises:
        ValueError: it is neither, or an argument is one of the other.
    """
    holds = isinstance(params, ContactStructure)
    if not holds and not isinstance(params, Parameters):
        raise ValueError(
            f"params = {brief(params)}: Parameters of a pad or a Structure is needed"
        )
    for name, value in (of_pads if holds else of_structures).items():
        if value is not None:
            raise ValueError(
                f"{name} = {brief(value)}: a "
                f"{'structure' if holds else 'pad on two springs'} has none; leave it out"
            )
    return holds


def refuse_missing(task: str, subject: str, arguments: Mapping[str, Any]) -> None:
    """Raise if an argument that a task needs of a structure or a pad is left out.

    Raises:
        TypeError: it is None.
    """
    for name, value in arguments.items():
        if value is None:
            raise TypeError(f"{task}: {name}: missing required argument of a {subject}")
