"""The pictures of the report: which module explains which file."""

from __future__ import annotations

from types import ModuleType

from squealpipe.figures import fig01, fig06

MODULES: dict[str, tuple[str, ModuleType]] = {
    "fig01": ("Fig. 1.", fig01),
    "fig06": ("Fig. 6.", fig06),
}
"""Name of the picture → its title and the module whose CAPTION and ALT speak for it."""
