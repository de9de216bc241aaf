"""Write docs/datasets.md, the data dictionary, from the schemas: ``make dictionary``."""

from __future__ import annotations

from pathlib import Path

from squealpipe.schema import (
    ANGLE_CONVENTION,
    DatasetSchema,
    Variable,
    all_schemas,
    flag_table,
)

TARGET = Path(__file__).with_name("datasets.md")
HEAD = f"""\
# Data dictionary

Written from the schemas of all rooms (`squealpipe/*/schema`) by `docs/build_dictionary.py`; a test
compares them. Files are NetCDF-4 with CF-1.11 attributes, one dataset each, under `results/data/`;
each carries its configuration, code and library versions, licence, references and the ids of its
inputs. Units are those of the parameters (SI by default).

{ANGLE_CONVENTION}.

`time` is in s since the start of the run, so it is a plain coordinate and not a date of CF.

NaN always has its reason in an outcome of the same dataset. Flags are integers; their meanings are
attributes of the variable and listed here.
"""


def main() -> None:
    """Write the page."""
    TARGET.write_text(page(), encoding="utf-8")


def page() -> str:
    """The text of the page."""
    return HEAD + "".join(
        map(section, sorted(all_schemas().values(), key=lambda one: one.name))
    )


def section(schema: DatasetSchema) -> str:
    """One dataset: what it is, and a table of its coordinates and variables."""
    entries = {**schema.coordinates, **schema.variables}
    rows = "".join(row(name, entry) for name, entry in entries.items())
    return (
        f"\n## {schema.name}\n\n{schema.title} (version {schema.version}).\n\n"
        f"| name | dimensions | unit | meaning |\n|---|---|---|---|\n{rows}"
    )


def row(name: str, entry: Variable) -> str:
    """One variable."""
    words = [cell(entry.long_name or name.replace("_", " "))]
    if entry.flags is not None:
        table = flag_table(entry.flags).items()
        words.append(
            ", ".join(
                f"{value} {meaning.replace('_', ' ')}" for value, meaning in table
            )
        )
    words += ["may be NaN"] * entry.nan_allowed + ["optional"] * entry.optional
    words += ["differs from run to run"] * entry.volatile
    unit = "" if entry.flags is not None or entry.units == "1" else entry.units
    return f"| `{name}` | {', '.join(entry.dims)} | {unit} | {'; '.join(words)} |\n"


def cell(text: str) -> str:
    """Text that a cell of a Markdown table can hold."""
    return text.replace("|", "\\|")


if __name__ == "__main__":
    main()
