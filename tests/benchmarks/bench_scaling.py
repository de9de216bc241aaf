"""How the cost of maps of model A1 grows with cells, horizon and parameters.

Prints the tables of docs/cluster.md. CPU time is measured, of this process and its workers, so
that other work on the machine disturbs little. `--large` adds the map of a million cells.
"""

import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from squealpipe.brake.dynamics.hammering import hammering_map
from squealpipe.brake.dynamics.runs import validity_map
from squealpipe.parameters import Parameters
from squealpipe.store import save


def cpu_seconds():
    used = [
        resource.getrusage(who)
        for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    ]
    return sum(item.ru_utime + item.ru_stime for item in used)


def measured(task, params, points, t_end):
    """CPU seconds, wall seconds and the map."""
    angles = np.linspace(0.0, np.pi, points)
    cpu, wall = cpu_seconds(), time.perf_counter()
    made = task(params, angles, angles, t_end=t_end)
    return cpu_seconds() - cpu, time.perf_counter() - wall, made


def row(name, task, params, points, t_end):
    cpu, wall, made = measured(task, params, points, t_end)
    cells = points**2
    with tempfile.TemporaryDirectory() as folder:
        size = save(made, Path(folder) / "map.nc").stat().st_size
    print(
        f"| {name} | {cells:,} | {t_end:g} | {cpu:.2f} | {wall:.2f} | {1e6 * cpu / cells:.1f} | "
        f"{size / cells:.1f} |",
        flush=True,
    )


def main():
    base = Parameters()
    angles = np.linspace(0.0, np.pi, 9)
    for task in (validity_map, hammering_map):
        task(base, angles, angles, t_end=1.0)  # compiled before anything is timed
    print("| map | cells | T | CPU s | wall s | µs a cell | bytes a cell |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for points in (91, 181, 361, *([1000] if "--large" in sys.argv else [])):
        row("validity", validity_map, base, points, 200.0)
    for horizon in (50.0, 100.0, 400.0, 800.0):
        row("validity", validity_map, base, 181, horizon)
    for name, params in {
        "κ = 0.3": base.with_(k3=0.3),
        "κ = 1.5": base.with_(k3=1.5),
        "μ = 0.1": base.with_(mu=0.1),
        "μ = 0.8": base.with_(mu=0.8),
        "V = 1": base.with_(belt_speed=1.0),
        "L = 50": base.with_(length1=50.0, length2=50.0),
    }.items():
        row(f"validity, {name}", validity_map, params, 181, 200.0)
    for points, horizon in ((31, 100.0), (31, 200.0), (61, 200.0)):
        row("hammering", hammering_map, base, points, horizon)


if __name__ == "__main__":
    main()
