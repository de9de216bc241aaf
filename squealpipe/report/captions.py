"""Captions and alt texts, read from the figure modules without running them.

A figure ``<name>`` is drawn by ``squealpipe/figures/<name>.py``, whose constants CAPTION and ALT
speak for it. Reading the source keeps the report free of the plotting library.
"""

from __future__ import annotations

import ast
import os
import re
from pathlib import Path


def read_caption(module: str | os.PathLike[str]) -> tuple[str, str]:
    """CAPTION and ALT of a figure module.

    Raises:
        ValueError: one of them is missing, empty or computed.
    """
    constants = {}
    for node in ast.parse(Path(module).read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
            constants.update(
                {
                    target.id: node.value.value
                    for target in node.targets
                    if isinstance(target, ast.Name)
                }
            )
    texts = []
    for name in ("CAPTION", "ALT"):
        text = constants.get(name)
        if not isinstance(text, str) or not text.strip():
            raise ValueError(f"{module} has no {name}; give it as a plain text constant")
        texts.append(text.strip())
    return texts[0], texts[1]


def title(name: str) -> str:
    """Heading of a picture: the paper's number, or the name in words."""
    paper = re.fullmatch(r"fig(\d+)", name)
    return f"Fig. {int(paper[1])}." if paper else name.replace("_", " ").capitalize() + "."
