"""Every equation of the paper has exactly one home, and docs/equations.md says where.

A home is a function or class below laws, vibration or brake whose docstring begins with ``Eq. (n)``
or ``Eqs. (m), (n)``. References, ``of Eq. (n)``, and words before it do not count.
"""

import ast
import re
from collections import defaultdict
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LETTERS = {1: "abc", 8: "abcd", 12: "abcdefg"} | dict.fromkeys((15, 22, 25, 28), "ab")
PAPER = {
    f"{number}{letter}"
    for number in range(1, 37)
    for letter in LETTERS.get(number) or [""]
}
REFERENCE = re.compile(r"\bof Eqs?\. \(\d+[a-g]?\)(?:(?:, |–| and )\(\d+[a-g]?\))*")
NUMBER = re.compile(r"\((\d+)([a-g]?)\)(?:–\((\d+)([a-g]?)\))?")


def numbers(text):
    """Equation numbers in a text, ranges such as (8a)–(8c) and (31)–(34) spelled out."""
    found = set()
    for first, letter, last, last_letter in NUMBER.findall(text):
        if not last:
            found.add(first + letter)
        elif first == last:
            found |= {
                first + chr(code) for code in range(ord(letter), ord(last_letter) + 1)
            }
        else:
            found |= {str(number) for number in range(int(first), int(last) + 1)}
    return found


@cache
def homes():
    """Equation → ``path: name`` of its homes."""
    found = defaultdict(set)
    for layer in ("laws", "vibration", "brake"):
        for path in sorted((ROOT / "squealpipe" / layer).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if not isinstance(node, ast.FunctionDef | ast.ClassDef):
                    continue
                summary = (ast.get_docstring(node) or "").split("\n\n")[0]
                if not summary.startswith("Eq"):
                    continue
                for number in numbers(REFERENCE.sub("", summary)):
                    found[number].add(
                        f"{path.relative_to(ROOT).as_posix()}: {node.name}"
                    )
    return found


def table():
    """Equation → ``path: name`` as docs/equations.md has it."""
    found = defaultdict(set)
    for line in (ROOT / "docs/equations.md").read_text(encoding="utf-8").splitlines():
        match = re.match(
            r"\| (\(.*?\)) \| .* \| `(squealpipe/\S+\.py)` `(\w+)` \|$", line
        )
        if match:
            for number in numbers(match[1]):
                found[number].add(f"{match[2]}: {match[3]}")
    return found


def test_what_the_architecture_says_to_look_for_is_there():
    page = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| .* \| `(squealpipe/\S+)`(.*) \|$", page, re.MULTILINE)
    assert len(rows) > 10
    for path, names in rows:
        source = (ROOT / path).read_text(encoding="utf-8")
        for name in re.findall(r"`(\w+)`", names):
            assert re.search(rf"\b(?:def|class) {name}\b", source), (path, name)


def test_every_equation_has_exactly_one_home():
    found = homes()
    assert set(found) <= PAPER, f"no such equation: {sorted(set(found) - PAPER)}"
    assert set(found) >= PAPER, f"no home: {sorted(PAPER - set(found))}"
    several = {
        number: sorted(places) for number, places in found.items() if len(places) > 1
    }
    assert not several


def test_the_table_says_where_each_one_lives():
    assert table() == dict(homes())


def test_ranges_are_spelled_out():
    assert numbers("(8a)–(8c), (31)–(33) and (4)") == {
        "8a",
        "8b",
        "8c",
        "31",
        "32",
        "33",
        "4",
    }
