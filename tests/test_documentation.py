"""The API reference builds without warnings, and holds what is public."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import squealpipe

ROOT = Path(__file__).resolve().parents[1]


@pytest.mark.release
def test_reference_builds_without_warnings(tmp_path):
    done = subprocess.run(
        [sys.executable, str(ROOT / "docs/build_reference.py"), str(tmp_path)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert "Warning" not in done.stderr
    front = (tmp_path / "squealpipe.html").read_text(encoding="utf-8")
    assert all(f'id="{name}"' in front for name in squealpipe.__all__)
    assert (tmp_path / "squealpipe/laws/springs.html").is_file()


def test_public_names_are_documented():
    for name in set(squealpipe.__all__) - {"SCENES"}:
        assert (getattr(squealpipe, name).__doc__ or "").strip(), name
