"""The commit of the checkout that the package runs from."""

import subprocess
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@cache
def commit(root: Path = ROOT) -> str:
    """Our own commit, with a mark if there are changes; "unknown" outside of our checkout.

    Archives below ``results`` are not code: one that takes the place of another marks nothing.
    """
    package = "squealpipe/__init__.py"
    unknown = "unknown"
    if (
        _git(root, "rev-parse", "--show-prefix")
        or _git(root, "ls-files", package) != package
    ):
        return unknown
    if not (
        root / "Snakefile"
    ).is_file():  # installed below a repository of someone else's
        return unknown
    described = _git(root, "describe", "--always", "--abbrev=12") or unknown
    changes = ("status", "--porcelain", "--untracked-files=no", "--", ".", ":!results")
    return f"{described}-dirty" if _git(root, *changes) else described


def _git(root: Path, *arguments: str) -> str:
    try:
        done = subprocess.run(
            ["git", *arguments],
            cwd=root,
            capture_output=True,
            text=True,
            check=True,
            timeout=10,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return done.stdout.strip()
