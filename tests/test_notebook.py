"""The example notebook runs, and shows what was stored in it."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOK = Path(__file__).resolve().parents[1] / "docs/example.ipynb"


def printed(notebook):
    """Text that each cell printed."""
    return [
        "".join(
            one.text for one in cell.get("outputs", []) if one.output_type == "stream"
        )
        for cell in notebook.cells
    ]


@pytest.mark.release
def test_notebook_runs_and_prints_what_is_stored(tmp_path):
    stored = nbformat.read(NOTEBOOK, as_version=4)
    fresh = nbformat.read(NOTEBOOK, as_version=4)
    resources = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(
        fresh, timeout=300, kernel_name="python3", resources=resources
    ).execute()
    assert printed(fresh) == printed(stored)
    assert any(printed(stored))


def test_stored_notebook_holds_its_pictures():
    cells = nbformat.read(NOTEBOOK, as_version=4).cells
    outputs = [one for cell in cells for one in cell.get("outputs", [])]
    assert sum("image/png" in one.get("data", {}) for one in outputs) == 3
    assert NOTEBOOK.stat().st_size < 300_000
