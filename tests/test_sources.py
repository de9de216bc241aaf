"""The import closure: every way to import counts, types-only imports do not."""

from pathlib import Path

import pytest

from squealpipe.rerun.sources import PACKAGE, closure, imported_modules


def named(*modules):
    return {PACKAGE / module for module in modules}


@pytest.fixture
def imports(tmp_path):
    def find(text):
        path = tmp_path / f"script{len(list(tmp_path.iterdir()))}.py"
        path.write_text(text)
        return set(imported_modules(path))

    return find


@pytest.mark.parametrize(
    "text",
    [
        "import squealpipe.laws.springs",
        "import squealpipe.laws.springs as springs",
        "from squealpipe.laws import springs",
        "from squealpipe.laws.springs import geometry",
        "def f():\n    from squealpipe.laws import springs",
        "try:\n    import x\nexcept ImportError:\n    import squealpipe.laws.springs",
        "try:\n    x\nfinally:\n    import squealpipe.laws.springs",
        "class A:\n    if x:\n        y\n    else:\n        import squealpipe.laws.springs",
        "with x:\n    for y in z:\n        while w:\n            import squealpipe.laws.springs",
        "match x:\n    case 1:\n        import squealpipe.laws.springs",
        "if TYPE_CHECKING:\n    pass\nelse:\n    import squealpipe.laws.springs",
    ],
)
def test_every_way_to_import_counts(imports, text):
    assert imports(text) == named("__init__.py", "laws/__init__.py", "laws/springs.py")


@pytest.mark.parametrize(
    "text",
    [
        "import numpy",
        "from squealpipes import x",
        "if TYPE_CHECKING:\n    import squealpipe.laws.springs",
        "'import squealpipe.laws.springs'",
        "from . import springs",
    ],
)
def test_what_is_not_imported_does_not_count(imports, text):
    assert imports(text) == set()


def test_closure_is_transitive(tmp_path):
    script = tmp_path / "script.py"
    script.write_text("from squealpipe.tasks.linear.maps import stability_map\n")
    found = {path.relative_to(PACKAGE).as_posix() for path in closure(script)}
    assert {"tasks/linear/maps.py", "models/a3.py", "laws/springs.py", "parameters.py"} <= found
    assert not any(name.startswith(("figures", "report", "cli", "methods")) for name in found)


def test_every_closure_stays_in_the_package():
    for script in Path(__file__).parents[1].glob("workflow/scripts/*/*.py"):
        assert all(PACKAGE in path.parents for path in closure(script))
