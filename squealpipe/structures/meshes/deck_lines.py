"""Lines of a deck of Abaqus or CalculiX as blocks: a keyword, its parameters, its data lines."""

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from squealpipe.structures.packed import text_of


@dataclass
class Block:
    """A keyword with what follows it.

    Attributes:
        keyword: in capitals, without its asterisk.
        parameters: by name in capitals; "" where one has no value.
        lines: number of the line and its text, without comments and empty lines.
        path, line: where the keyword stands.
    """

    keyword: str
    parameters: dict[str, str]
    path: Path
    line: int
    lines: list[tuple[int, str]] = field(default_factory=list)

    @property
    def where(self) -> str:
        """File and line of the keyword, for messages."""
        return f"{self.path}, line {self.line}: *{self.keyword}"

    def needed(self, name: str) -> str:
        """Return a parameter's value.

        Raises:
            ValueError: it is missing.
        """
        value = self.parameters.get(name)
        if not value:
            raise ValueError(f"{self.where} lacks {name}=; give it a name")
        return value


def blocks_of(path: Path, within: tuple[Path, ...] = ()) -> Iterator[Block]:
    """Yield the blocks of a deck, those of files that it includes in their place.

    Args:
        within: files that include this one.

    Raises:
        FileNotFoundError: a file that does not exist.
        ValueError: a file that includes itself; data before the first keyword.
    """
    if path in within:
        raise ValueError(f"{path} includes itself; leave out one *INCLUDE")
    block: Block | None = None
    for number, text in _logical_lines(text_of(path)):
        if text.startswith("*"):
            if block is not None:
                yield from _with_included(block, within)
            block = _block(text, path, number)
        elif block is None:
            shown = text[:40] if text.isprintable() else "no text"
            raise ValueError(
                f"{path}, line {number}: {shown!r} stands before the first keyword; a deck of "
                "Abaqus or CalculiX is needed"
            )
        else:
            block.lines.append((number, text))
    if block is not None:
        yield from _with_included(block, within)


def _with_included(block: Block, within: tuple[Path, ...]) -> Iterator[Block]:
    """Yield the block, or what the file holds that it includes."""
    beside = block.parameters.get("INPUT")
    if beside is None:
        yield block
        return
    path = Path(os.path.normpath(block.path.parent / beside))
    if not path.is_file():
        raise FileNotFoundError(f"{block.where}: no file {path}")
    if block.keyword == "INCLUDE":
        yield from blocks_of(path, (*within, block.path))
        return
    # data lines alone, as *NODE, INPUT=nodes.txt names them
    block.path, block.lines = path, [*_logical_lines(text_of(path)), *block.lines]
    yield block


def _logical_lines(text: str) -> Iterator[tuple[int, str]]:
    """Yield number and text of lines; those of one keyword as one, without comments."""
    begun: tuple[int, str] | None = None
    for number, line in enumerate(text.splitlines(), 1):
        stripped = line.strip()
        if not stripped or stripped.startswith("**"):
            continue
        if begun is not None:
            number, stripped = begun[0], begun[1] + " " + stripped
            begun = None
        if stripped.startswith("*") and stripped.endswith(","):
            begun = number, stripped
            continue
        yield number, stripped
    if begun is not None:
        yield begun[0], begun[1].rstrip(",")


def _block(text: str, path: Path, line: int) -> Block:
    first, _, rest = text[1:].partition(",")
    keyword = " ".join(first.upper().split())
    parameters = {}
    parameter = re.compile(
        r"""\s*([^=,"']+?)\s*(?:=\s*("[^"]*"|'[^']*'|[^,]*?)\s*)?(?:,|$)"""
    )
    for match in parameter.finditer(rest):
        name = match[1].strip().upper()
        parameters[name] = (match[2] or "").strip("\"' ")
    return Block(keyword, parameters, path, line)


def cells_of(text: str) -> list[str]:
    """Return the cells of a data line; a comma at its end separates nothing."""
    cells = [cell.strip().strip("\"'") for cell in text.split(",")]
    while cells and not cells[-1]:
        cells.pop()
    return cells
