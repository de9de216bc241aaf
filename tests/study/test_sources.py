"""The import closure: every way to import counts, types-only imports do not."""

import json
import re
import time
from pathlib import Path

import pytest

from squealpipe.store.rerun.key import (
    STARTED,
    key_behind,
    rule_key,
    sources,
    state_key,
    used,
)
from squealpipe.store.rerun.sources import PACKAGE, closure, read_source


def named(*modules):
    return {PACKAGE / module for module in modules}


@pytest.fixture
def imports(tmp_path):
    def find(text):
        path = tmp_path / f"script{len(list(tmp_path.iterdir()))}.py"
        path.write_text(text)
        return set(read_source(path).imports)

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
    script.write_text("from squealpipe.brake.linear.maps import stability_map\n")
    found = {path.relative_to(PACKAGE).as_posix() for path in closure(script)}
    assert {
        "brake/linear/maps.py",
        "brake/models/a3.py",
        "laws/springs.py",
        "parameters.py",
    } <= found
    assert not any(
        name.startswith(("paper", "study", "cli", "systems/taylor")) for name in found
    )


def test_every_closure_stays_in_the_package():
    for script in Path(__file__).parents[2].glob("workflow/scripts/*/*.py"):
        assert all(PACKAGE in path.parents for path in closure(script))


@pytest.mark.parametrize(
    ("edit", "same"),
    [
        (lambda text: "# a comment\n" + text, True),
        (lambda text: text.replace("What it is", "What it was"), True),
        (lambda text: text.replace('"""Doc."""\n', ""), True),
        (lambda text: text.replace("2 * y", "(2   * y)  # twice"), True),
        (lambda text: text.replace("2 * y", "3 * y"), False),
    ],
)
def test_comments_and_docstrings_are_not_code(tmp_path, edit, same):
    text = '"""Doc."""\ndef law(y):\n    """What it is."""\n    return 2 * y\n'
    found = []
    for place, content in enumerate((text, edit(text))):
        (tmp_path / str(place)).mkdir()
        path = tmp_path / str(place) / "law.py"
        path.write_text(content)
        found.append(rule_key({"mu": 0.3}, sources(path)))
    assert (found[0] == found[1]) == same


def test_docstrings_that_the_table_of_statements_shows_are_code(tmp_path, monkeypatch):
    monkeypatch.setattr("squealpipe.store.rerun.sources.STATEMENT_CHECKS", tmp_path)
    for words in ("share of cells", "number of cells"):
        (tmp_path / f"{words}.py").write_text(f'def check():\n    """{words}"""\n')
    assert len({read_source(path).code for path in tmp_path.iterdir()}) == 2


def test_key_changes_with_slice_inputs_and_files_that_the_slice_names(tmp_path):
    table = tmp_path / "friction.csv"
    table.write_text("0,0.3")
    part = {"parameters": {"friction_table": str(table)}, "points": 7}
    first = rule_key(part, [], {"data/a.nc": "1"})
    assert rule_key(dict(part), [], {"data/a.nc": "1"}) == first
    assert rule_key({**part, "points": 8}, [], {"data/a.nc": "1"}) != first
    assert rule_key(part, [], {"data/a.nc": "2"}) != first
    table.write_text("0,0.4")
    assert rule_key(part, [], {"data/a.nc": "1"}) != first


@pytest.mark.parametrize("end", ["a.svg", "a.png", "a.html", "a.json"])
def test_figures_and_pages_end_with_their_key_and_any_change_is_noticed(tmp_path, end):
    path = tmp_path / end
    path.write_bytes(
        b"content of a picture" if path.suffix != ".json" else b'{"a": {"b": 1}}\n'
    )
    assert key_behind(path) is None
    state_key(path, "0" * 16)
    assert key_behind(path) == f"{'0' * 16} {end}"
    if path.suffix == ".json":
        assert json.loads(path.read_text())["a"] == {"b": 1}
    whole = path.read_bytes()
    for at in range(len(whole)):
        for changed in (
            whole[:at],
            whole[at + 1 :],
            whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :],
            whole + whole[: at + 1],
        ):
            path.write_bytes(changed)
            assert key_behind(path) != f"{'0' * 16} {end}"


def test_result_of_code_that_changed_meanwhile_is_not_published(tmp_path, monkeypatch):
    picture = tmp_path / "fig06.png"
    picture.write_bytes(b"picture")
    monkeypatch.setenv(STARTED, "0")
    with pytest.raises(
        RuntimeError, match=r"changed in .* while it was computed"
    ) as told:
        state_key(picture, "0" * 16)  # a new installation changes all files
    assert "written: squealpipe/__init__.py, squealpipe/" in str(told.value)
    assert re.search(r" and \d+ more changed", str(told.value))
    assert len(str(told.value)) < 500
    assert "a new installation; run the same command again" in str(told.value)
    monkeypatch.setenv(STARTED, str(time.time()))
    state_key(picture, "0" * 16)
    # a file that is dated later than now has another clock's date, and was not edited
    monkeypatch.setenv(STARTED, "0")
    monkeypatch.setattr(time, "time", lambda: 1.0)
    state_key(picture, "0" * 16)


def test_a_law_counts_where_it_is_named(tmp_path):
    """All laws are imported with one of them; those that nothing names decide nothing."""
    laws = {"coulomb", "exponential", "hyperbolic", "dashpot", "linear"}

    def counted(text, part):
        path = tmp_path / f"script{len(list(tmp_path.iterdir()))}.py"
        path.write_text(f"from squealpipe.brake.models import a1\n{text}")
        code = sources(path)
        assert laws <= {each.stem for each in code}
        return {each.stem for each in used(part, code)} & laws

    assert counted("", {}) == {"coulomb", "linear"}
    named_here = {"parameters": {"friction_law": "hyperbolic"}}
    assert counted("", named_here) == {"coulomb", "linear", "hyperbolic"}
    assert counted("", {"vary": ["contact_law=linear,dashpot"]}) >= {"dashpot"}
    assert "exponential" in counted("for law in ('exponential',):\n    pass", {})
    assert "dashpot" not in counted("def f(p):\n    return p.law == 'dashpot'", {})
    robustness = PACKAGE / "paper/robustness.py"
    assert {"exponential", "hyperbolic"} <= {
        each.stem for each in used({}, [robustness, *closure(robustness)])
    }


def test_what_a_module_reads_beside_its_imports_is_part_of_its_closure():
    """An edit of the problems of the benchmark would run nothing again."""
    read = named("benchmark/problems.yaml", "benchmark/references.json")
    assert read <= set(closure(PACKAGE / "benchmark/problems.py"))


def test_dimensions_of_a_sweep_in_another_order_are_another_result():
    one, other = ({"vary": dict.fromkeys(names, 1.0)} for names in ("ab", "ba"))
    assert rule_key(one, []) != rule_key(other, [])
