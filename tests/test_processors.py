"""Lists of what runs as on other processors: each folder of tests is on them, or says why not."""

import pytest

from tests.conftest import ROOT

ON_ONE_PROCESSOR = {
    "tests": "what concerns the whole checkout; units are on the list of AVX2",
    "tests/workflow": "Snakemake; the tiny study is made anew as with AVX2, and compared",
    "tests/workflow/slurm": "the same",
    "tests/schema": "names and units of datasets",
    "tests/paper/claims": "long runs, 35 s for one verdict where the C library's fma is software",
    "tests/paper/report": "pages",
    "tests/plotting": "films and sounds of runs that other folders test",
    "tests/store/archives": "files",
}
"""Folders that need not be on both lists."""


@pytest.mark.parametrize("name", ["avx2", "generic"])
def test_no_folder_is_forgotten_and_what_is_listed_is_there(name):
    listed = (ROOT / f"tests/{name}.txt").read_text(encoding="utf-8").split()
    files = [entry.partition("::") for entry in listed]
    for path, _, test in files:
        assert (ROOT / path).exists()
        if test:
            text = (ROOT / path).read_text(encoding="utf-8")
            assert f"def {test}(" in text
    paths = [ROOT / path for path, _, _ in files]
    folders = {path.parent for path in (ROOT / "tests").rglob("test_*.py")}
    forgotten = {
        str(folder.relative_to(ROOT))
        for folder in folders
        if not any(
            folder.is_relative_to(path) or path.is_relative_to(folder) for path in paths
        )
    }
    assert forgotten <= set(ON_ONE_PROCESSOR)
