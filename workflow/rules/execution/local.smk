"""How jobs of this machine start; those of seconds stay on the head node of a cluster.

Included last, when all rules are known.
"""

import re

from squealpipe.study.forked_jobs import start_server

QUICK = ("draw_", "judge_", "write_")

workflow.localrules(*[known.name for known in workflow.rules if known.name.startswith(QUICK)])


# One line a job in the log of a run. A dry run lists the files of each.
onstart:
    # where jobs are forked, their commands are put to the process that forks them
    before_commands = start_server()
    if before_commands:
        shell.prefix(before_commands.replace("{", "{{").replace("}", "}}"))
    if workflow.local_exec:
        # to keep 100 jobs a second Snakemake looks for jobs once a second for each that has ended
        workflow.scheduler.job_rate_limiter = None
    for known in workflow.rules:
        known.message = known.name
        if known.output:
            path = re.sub(r"\{(\w+),[^}]*\}", r"{wildcards.\1}", str(known.output[0]))
            known.message += f" → {path}"
