"""The pictures of the report: which module explains which file."""

from __future__ import annotations

from types import ModuleType

from squealpipe.figures import fig01, fig06, fig08, fig09

MODULES: dict[str, tuple[str, ModuleType]] = {
    "fig01": ("Fig. 1.", fig01),
    "fig06": ("Fig. 6.", fig06),
    "fig08": ("Fig. 8.", fig08),
    "fig09": ("Fig. 9.", fig09),
}
"""Name of the picture → its title and the module whose CAPTION and ALT speak for it."""
