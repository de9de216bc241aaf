"""``squealpipe claims``: the paper's statements with their verdicts, in one line each."""

import json
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from squealpipe.cli.arguments import AsJson
from squealpipe.cli.console import ExitCodes


def claims(
    *ids: str,
    only: str | None = None,
    json_: AsJson = False,
    file: Path = Path("results/data/claims.nc"),
) -> int:
    """Print the paper's statements with their verdicts; those that are named, in full.

    With the shipped parameters, exit code 1 means that a verdict differs from the recorded one.

    Example: `squealpipe claims F2d` or `squealpipe claims --only fails`

    Args:
        ids: statements to show in full.
        only: a verdict, by its first letters: holds, fails, holds only, depends or cannot.
        json_: print a JSON list of objects.
        file: dataset of verdicts, made by `squealpipe run`.
    """
    from squealpipe.paper.claims.table import table

    if not file.is_file():
        raise FileNotFoundError(f"no verdicts {file}; make them with: squealpipe run")
    every, code = table(file)
    rows = _chosen(every, ids, only)
    if json_:
        print(json.dumps(rows, indent=1, allow_nan=False))
    elif ids:
        for row in rows:
            print(*_details(row), "", sep="\n")
    else:
        print(*map(_line, rows), sep="\n")
        if rows:
            print(
                f"{len(rows)} statements; {_counts(rows)}; "
                f"`squealpipe claims {rows[0]['id']}` shows one in full"
            )
        if changed := [row for row in rows if row["changes"]]:
            print("\nWith friction of one sign throughout these change:")
            for row in changed:
                beside = {key: row[f"corrected_{key}"] for key in ("verdict", "value")}
                print(_line({**row, **beside}))
    return code if rows else ExitCodes.done


def _chosen(
    rows: Sequence[Mapping[str, Any]], ids: Sequence[str], only: str | None
) -> list[Mapping[str, Any]]:
    known = {row["id"].lower(): row for row in rows}
    for name in ids:
        if name.lower() not in known:
            raise ValueError(
                f"no statement {name!r}; known: {', '.join(r['id'] for r in rows)}"
            )
    kept = [known[name.lower()] for name in ids] or list(rows)
    if only is None:
        return kept
    verdicts = sorted({row["verdict"] for row in rows})
    wanted = only.strip().lower()
    exact = [verdict for verdict in verdicts if verdict == wanted]
    fitting = exact or [verdict for verdict in verdicts if verdict.startswith(wanted)]
    if not fitting:
        raise ValueError(
            f"--only {only}: no statement has this verdict; {', '.join(verdicts)}"
        )
    return [row for row in kept if row["verdict"] in fitting]


def _line(row: Mapping[str, Any]) -> str:
    value = "" if row["value"] is None else f"{row['value']:.4g}"
    text = f"{row['id']:<5}{row['verdict']:<26}{value:>10}  {row['statement']}"
    width = shutil.get_terminal_size().columns
    return text if len(text) <= width else f"{text[: width - 1]}…"


def _counts(rows: Sequence[Mapping[str, Any]]) -> str:
    """Verdicts of the paper's statements counted: those that test apart from the fitted ones."""
    from squealpipe.paper.claims.table import tally
    from squealpipe.paper.schema.claims import ClaimVerdict

    own = [row for row in rows if row["origin"] == "paper"]
    told = [f"{len(own)} of them the paper's"]
    for part in tally(own):
        counts = zip(part["counts"], ClaimVerdict, strict=True)
        listed = ", ".join(f"{n} {verdict.words}" for n, verdict in counts if n)
        told.append(f"{part['basis']}: {listed}")
    return "; ".join(told)


def _details(row: Mapping[str, Any]) -> list[str]:
    lines = [f"{row['id']}  {row['verdict']}  ({row['section']})", row["statement"]]
    lines.append(f"basis: {row['basis']}")
    if row["value"] is not None:
        but = ", but a further condition is not met" if row["unmet"] else ""
        lines.append(
            f"{row['check']}: {row['value']:.6g}, wanted {row['relation']} "
            f"{row['threshold']:.6g}{but}"
        )
    if row["feasible_share"] is not None:
        lines.append(
            f"holds in {row['feasible_share']:.1%} of the feasible parameter sets"
        )
    lines.append(row["evidence"])
    if row["changes"]:
        lines.append(
            f"with friction of one sign throughout: {row['corrected_verdict']}; "
            f"{row['corrected_evidence']}"
        )
    lines += [f"{key}: {row[key]}" for key in ("dataset", "figure") if row[key]]
    if not row["as_recorded"]:
        lines.append(f"here: {row['verdict_here']}; recorded: {row['recorded']}")
    return lines
