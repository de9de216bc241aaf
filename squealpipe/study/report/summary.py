"""The summary of the report: at most ten sentences, each made from the data of the run.

A sentence depends on what the data say: another configuration gets another sentence, or none.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

from squealpipe.schema.claims import Basis, Origin, Verdict
from squealpipe.text import number

PAPER = {
    "authors": "O. T. Şen and R. Singh",
    "title": "Dynamics of a simplified nonlinear model offering insights into the hammering type "
    "brake squeal initiation process",
    "journal": "Noise Control Engineering Journal",
    "year": 2021,
}
"""The paper that is computed again."""

SERIOUS = {
    "E1": "the sign of friction in Eq. (4)",
    "E2": "the residual of Eq. (34)",
    "E3": "the quotient in Eq. (11)",
    "E6": "the number of samples for Eq. (29)",
}
"""Misprints that change results wherever they are taken literally."""

Rows = Sequence[Mapping[str, Any]]
Facts = Mapping[str, Any]


def is_misprint(row: Mapping[str, Any]) -> bool:
    """Whether a row judges a printed form (E1, E2, …) and not a statement on the results."""
    return bool(row["origin"] == Origin.misprints.name)


def summarize(claims: Rows, facts: Mapping[str, Facts], figures: Collection[str]) -> list[str]:
    """The sentences, most important first.

    Args:
        claims: rows of :func:`squealpipe.study.claims.table.rows`.
        facts: numbers of the run by topic, of :func:`squealpipe.study.report.facts.gather_facts`.
        figures: names of the pictures of the run.
    """
    statements = [row for row in claims if not is_misprint(row)]
    printed = [row for row in claims if is_misprint(row)]

    def told(topic: str, sentence: Callable[[Facts], str]) -> str:
        return sentence(facts[topic]) if topic in facts else ""

    sentences = [
        _reproduced(statements, figures),
        _fitted(statements, facts),
        told("whirl", _whirl),
        told("transient", _transient),
        told("linear", _sliding),
        _misprints(printed),
        told("integration", _speed),
        told("failures", _failures),
        told("ladder", _ladder),
    ]
    return [sentence for sentence in sentences if sentence]


def tally(rows: Rows) -> list[dict[str, Any]]:
    """Verdict → ids, for the verdicts that occur, in the order of :class:`Verdict`."""
    found = {verdict.words: [row["id"] for row in rows if row["verdict"] == verdict.words]
             for verdict in Verdict}  # fmt: skip
    return [{"verdict": words, "ids": ids} for words, ids in found.items() if ids]


def listed(parts: Sequence[str]) -> str:
    """Parts as people list them: a, b and c."""
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def _reproduced(statements: Rows, figures: Collection[str]) -> str:
    drawn = sum(bool(re.fullmatch(r"fig\d\d", name)) for name in figures)
    if not statements:
        return ""
    counts = Counter(str(row["verdict"]) for row in statements)
    told = listed(
        [f"{counts[v.words]} {_many(v, counts[v.words])}" for v in Verdict if v.words in counts]
    )
    return (
        f"{drawn} figures of the paper are computed from its equations, and of its "
        f"{len(statements)} statements {told}."
    )  # fmt: skip


def _many(verdict: Verdict, count: int) -> str:
    words = verdict.words
    if count == 1 or verdict == Verdict.cannot_be_decided:
        return words
    first, _, rest = words.partition(" ")
    return f"{first.removesuffix('s')} {rest}".strip()


def _fitted(statements: Rows, facts: Mapping[str, Facts]) -> str:
    if "inference" not in facts:
        return ""
    found = facts["inference"]
    fitted = [row for row in statements if row["basis"] == Basis.fitted.name]
    others = [row for row in statements if row["basis"] == Basis.predicted.name]
    fails = Verdict.fails.words
    held = sum(row["verdict"] == Verdict.holds.words for row in others)
    refuted = [str(row["id"]) for row in others if row["verdict"] == fails]
    broken = found["broken"]
    beyond = [str(r["id"]) for r in fitted if r["verdict"] == fails and r["id"] not in broken]
    here = (
        f"the parameters of this run violate {listed(broken)}"
        if broken
        else "the parameters of this run satisfy all of them"
    )
    if beyond:
        fail = "fails" if len(beyond) == 1 else "fail"
        here += f" ({listed(beyond)} {fail} in a part that was not fitted)"
    judged = (
        f"{listed(refuted)} {'is' if len(refuted) == 1 else 'are'} refuted"
        if refuted
        else "none is refuted"
    )
    return (
        f"The paper prints no parameters: they were fitted to {len(fitted)} of the statements, "
        f"which {found['feasible']} of {found['samples']} trial sets satisfy together, and "
        f"{here}; of the other {len(others)} statements {held} hold, and {judged}."
    )


def _whirl(found: Facts) -> str:
    if not found["own_speed"]:
        return ""
    size = f"|x| = {number(found['amplitude'])} l_pre"
    if found["motion"] == "whirl" and found["saturated"]:
        return (
            f"The growth of Fig. 3 ends: the mass whirls, and its amplitude saturates at {size} "
            f"(V = {number(found['speed'])} m/s)."
        )
    state = "has settled" if found["saturated"] else "has not settled"
    return (
        f"By t = {number(found['t_end'])} √(m/k₁) the motion of Fig. 3 {state}: {found['motion']}, "
        f"{size}."
    )


def _transient(found: Facts) -> str:
    runs = f"{found['runs']} runs from starts at most a billionth of l_pre apart"
    if not found["ended"]:
        end = number(found["t_end"])
        return f"Not one of {runs} leaves the motion of Fig. 4 by t = {end} √(m/k₁)."
    return (
        f"The limit cycle of Fig. 4 is a chaotic transient: {found['ended']} of {runs} leave it by "
        f"t = {number(found['t_end'])} √(m/k₁), the first at {number(found['shortest'])}"
        + (f", half of all before {number(found['median'])}." if found["median"] else ".")
    )


def _sliding(found: Facts) -> str:
    total = found["flutter"] + found["divergence"]
    printed, physical = found["unstable_printed"], found["unstable_physical"]
    if not total:
        return "No cell of Fig. 6 is linearly unstable."
    if not printed and physical:
        return (
            f"The black and white of Fig. 6 rest on reading Eq. (11) literally: as printed none of "
            f"the {total} linearly unstable cells can slide, by the sign of the reaction force "
            f"{physical} can."
        )
    return (
        f"Of the {total} linearly unstable cells of Fig. 6, {printed} can slide by Eq. (11) as "
        f"printed and {physical} by the sign of the reaction force."
    )


def _misprints(printed: Rows) -> str:
    wrong = {
        str(row["id"])
        for row in printed
        if row["verdict"] in {Verdict.fails.words, Verdict.holds_only_as_printed.words}
    }
    if not printed:
        return ""
    serious = [f"{words} ({name})" for name, words in SERIOUS.items() if name in wrong]
    tail = f"; those that change results most are {listed(serious)}" if serious else ""
    return (
        f"Of {len(printed)} printed forms that we list as misprints or gaps, {len(wrong)} do not "
        f"stand as printed{tail}."
    )


def _speed(found: Facts) -> str:
    scenes = found["scenes"]
    if not scenes:
        return ""
    error = max(row["error"] for row in scenes)
    ratios = [row["public_time"] / row["time"] for row in scenes]
    theirs = [row["public_error"] for row in scenes]
    return (
        f"On {len(scenes)} scenes a run of A1 at the setting of all maps is right to "
        f"{number(error, 1)} in at most {number(1000 * max(row['time'] for row in scenes), 2)} ms; "
        "the most accurate public methods and settings tried there reach "
        f"{number(min(theirs), 1)} to {number(max(theirs), 1)} and take "
        f"{number(min(ratios), 2)} to {number(max(ratios), 2)} times as long."
    )


def _failures(found: Facts) -> str:
    ours, others = found["totals"]["ours"], found["totals"]["others"]
    return (
        f"On {found['scenes']} hard scenes, all at the tolerance {number(found['tolerance'], 1)} "
        f"where they take one, our methods are silently wrong in {ours['silent']} of "
        f"{ours['asked']} answers and miss {ours['missed']} contact changes, the others in "
        f"{others['silent']} of {others['asked']}, and miss {others['missed']}."
    )


def _ladder(found: Facts) -> str:
    parts = [
        f"{row['question']} in {number(100 * row['simpler'], 3)} %" for row in found["questions"]
    ]
    work = [100 * row["work"] for row in found["questions"]]
    return (
        f"A level simpler than A1 answers within {number(100 * found['tolerance'], 2)} % "
        f"({listed(parts)} of {found['points']} × {found['points']} cells), and choosing it "
        f"without knowing the answer takes {number(min(work), 2)} to {number(max(work), 2)} % of "
        "the time integrated by always running A1."
    )
