"""Jobs of seconds stay on the head node of a cluster, where starting them costs nothing.

Included last, when all rules are known.
"""

import re

import sys

from squealpipe.rerun.stale import Made, stale

QUICK = ("draw_", "judge_", "write_")

workflow.localrules(*[known.name for known in workflow.rules if known.name.startswith(QUICK)])


def forcing(known):
    """An input function without files: at the first look it forces a rule's outdated results.

    Snakemake calls it for the jobs of its plan only, before it decides which of them run.
    """

    def check(wildcards):
        made = [
            Made(str(path), known.params.get("part", {}), tuple(map(str, known.input.sources)))
            for path in known.output
        ]
        outdated = stale(made)
        for path, reasons in outdated.items():
            print(f"stale {path}: {'; '.join(reasons)}", file=sys.stderr)
        workflow.dag.forcefiles.update(outdated)
        return []

    return check


# Results that neither Snakemake's records nor dates tell to be out of date; no file is touched.
if workflow.is_main_process:
    for known in workflow.rules:
        made = [str(path) for path in known.output]
        if made and not known.has_wildcards() and all(path.endswith(".nc") for path in made):
            known.set_input(outdated=forcing(known))


# One line a job in the log of a run; the files that each rule reads and writes go to a file of
# their own. A dry run lists them all.
onstart:
    for known in workflow.rules:
        known.message = known.name
        if known.output:
            path = re.sub(r"\{(\w+),[^}]*\}", r"{wildcards.\1}", str(known.output[0]))
            known.message += f" → {path}"
    listing = Path(".snakemake/log/rules.txt")
    listing.parent.mkdir(parents=True, exist_ok=True)
    listing.write_text(
        "".join(
            f"{known.name}\n"
            + "".join(f"    reads {path}\n" for path in known.input if not callable(path))
            + "".join(f"    writes {path}\n" for path in known.output)
            + "".join(f"    logs to {path}\n" for path in known.log)
            for known in workflow.rules
        ),
        encoding="utf-8",
    )
