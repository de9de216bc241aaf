"""What people see of a comparison: parameters first, the place, the worst first."""

from squealpipe.store.comparison.compare import Comparison, DatasetDifference
from squealpipe.store.comparison.differences import Agreement, VariableDifference
from squealpipe.store.comparison.lines import lines
from squealpipe.store.comparison.statements import StatementChange


def difference(name, share, **more):
    more = {"verdict": Agreement.different, **more}
    return VariableDifference(name=name, compared=100, differing=share, **more)


def test_worst_comes_first_and_a_screenful_is_enough():
    """Many differences, long texts and many keys: one screen of 24 lines, the rest on request."""
    many = [
        DatasetDifference(
            name=f"d{i}",
            verdict=Agreement.different,
            variables=[difference("mild", i), difference("bad", i + 50, reason="because " * 30)],
        )
        for i in range(40)
    ]
    refused = DatasetDifference(name="z", verdict=Agreement.not_comparable, reason="damaged")
    keys = {f"{part}.{i}": (i, -i) for part in ("parameters", "linear") for i in range(9)}
    changes = [
        StatementChange(
            claim=f"F{i}", statement="", verdicts=("holds", "fails"), values=(1.0, None)
        )
        for i in range(9)
    ]
    found = Comparison(a="a", b="b", datasets=[*many, refused], parameters=keys, statements=changes)
    shown = lines(found)
    assert len(shown) <= 24
    assert max(map(len, shown)) <= 100
    at = shown.index("differences, worst first")
    assert "z: not comparable; damaged" in shown[at + 1]
    assert "d39.bad" in shown[at + 2]
    assert "d39.mild" in shown[at + 3]
    assert shown[-1] == "  and 76 more; --all shows them"
    assert len(lines(found, every=True)) > 100
