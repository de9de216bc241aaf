"""The pictures of the report: which module explains which file."""

from __future__ import annotations

from types import ModuleType

from squealpipe.figures import fig01, fig02, fig03, fig04, fig05, fig06, fig07, fig08, fig09

MODULES: dict[str, tuple[str, ModuleType]] = {
    "fig01": ("Fig. 1.", fig01),
    "fig02": ("Fig. 2.", fig02),
    "fig03": ("Fig. 3.", fig03),
    "fig04": ("Fig. 4.", fig04),
    "fig05": ("Fig. 5.", fig05),
    "fig06": ("Fig. 6.", fig06),
    "fig07": ("Fig. 7.", fig07),
    "fig08": ("Fig. 8.", fig08),
    "fig09": ("Fig. 9.", fig09),
}
"""Name of the picture → its title and the module whose CAPTION and ALT speak for it."""
