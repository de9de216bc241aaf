"""Jobs of seconds stay on the head node of a cluster, where starting them costs nothing.

Included last, when all rules are known.
"""

import re

QUICK = ("draw_", "judge_", "write_")

workflow.localrules(*[known.name for known in workflow.rules if known.name.startswith(QUICK)])


# One line a job in the log of a run. A dry run lists the files of each.
onstart:
    for known in workflow.rules:
        known.message = known.name
        if known.output:
            path = re.sub(r"\{(\w+),[^}]*\}", r"{wildcards.\1}", str(known.output[0]))
            known.message += f" → {path}"
