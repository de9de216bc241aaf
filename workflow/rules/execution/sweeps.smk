"""The study's own sweeps: any task over ranges, one dataset each.

Included after the report, which shows the paper's study and must not wait for them.
"""

from math import prod

from squealpipe.store.mistakes import ConfigError
from squealpipe.ranges import is_structure, longest

SWEEPS = {name: STUDY.sweep(name) for name in STUDY.sweeps}

if SWEEPS and workflow.is_main_process:  # jobs need not check again: the import takes a second
    from squealpipe.study.sweep import planned

    faults = []
    for name, sweep in SWEEPS.items():
        try:
            planned(sweep)
        except (ValueError, FileNotFoundError) as fault:
            faults.append(f"sweeps.{name}: {fault}")
    if faults:
        raise ConfigError(faults)


def sweep_parts(sweep):
    """Parts of a sweep: as many as a map has, but no more than it has values to cut.

    A basin is made whole: its attractors are numbered over all starts; so are a structure's modes.
    """
    followed = is_structure(sweep["task"]) and not sweep["task"].endswith(":operating_map")
    if sweep["fixed"].get("run") == "basin" or followed:
        return 1
    return min(PARTS, len(sweep["vary"][longest(sweep["vary"])]))


for name, sweep in SWEEPS.items():
    whole = sweep_parts(sweep) == 1
    parts = f"{RESULTS}/parts/sweeps/{name}/{{scatteritem}}.nc"

    scattergather:
        **{f"sweep_{name}": sweep_parts(sweep)},

    rule:
        name:
            f"run_sweep_{name}"
        output:
            data(f"sweeps/{name}") if whole else temp(parts),
        params:
            settings=sweep,
        threads: all_cores_for(prod(map(len, sweep["vary"].values())), enough=16)
        script:
            "../../scripts/execution/run_sweep.py"

    if not whole:

        rule:
            name:
                f"join_sweep_{name}"
            input:
                parts=getattr(gather, f"sweep_{name}")(parts),
            output:
                data(f"sweeps/{name}"),
            params:
                settings=sweep,
            script:
                "../../scripts/execution/join_parts.py"


rule sweeps:
    input:
        [data(f"sweeps/{name}") for name in SWEEPS],


TARGETS += rules.sweeps.input
