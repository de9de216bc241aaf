"""Captions and alt texts: the constants CAPTION and ALT of the module that draws a figure."""

from __future__ import annotations

import re
from importlib import import_module


def read_caption(name: str) -> tuple[str, str]:
    """CAPTION and ALT of the figure ``name``, drawn by ``squealpipe.figures.<name>``.

    Raises:
        ValueError: one of them is missing or empty.
    """
    module = import_module(f"squealpipe.figures.{name}")
    texts = {constant: getattr(module, constant, "") for constant in ("CAPTION", "ALT")}
    for constant, text in texts.items():
        if not isinstance(text, str) or not text.strip():
            raise ValueError(f"{module.__name__} has no {constant}; give it as text")
    return texts["CAPTION"].strip(), texts["ALT"].strip()


def title(name: str) -> str:
    """Heading of a picture: the paper's number, or the name in words."""
    paper = re.fullmatch(r"fig(\d+)", name)
    if paper:
        return f"Fig. {int(paper[1])}."
    words = name.replace("_", " ").capitalize()
    return re.sub(r"\ba\d\b", lambda level: level[0].upper(), words) + "."
