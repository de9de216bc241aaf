"""Big maps in parts, for many machines: `--set-scatter maps=16`, as the Slurm profile has it.

With one part a map's rule makes the map itself. With more it makes the parts, and a rule
`join_<map>` joins them.
"""


scattergather:
    maps=1,


PARTS = workflow.resource_settings.overwrite_scatter.get("maps", 1)
SCATTERED = {}


def map_output(name, part):
    """Output of a map's rule: the map, or one part of it."""
    if PARTS == 1:
        return data(name)
    SCATTERED[name] = part
    return temp(f"{RESULTS}/parts/{name}/{{scatteritem}}.nc")
