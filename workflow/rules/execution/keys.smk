"""The key of every rule: a parameter on which Snakemake runs it again, stated by its results.

Included when all rules are known; no rule has to name what its script imports.
"""

import base64
import json

from squealpipe.store.rerun.key import PLAN_VARIABLE, digest, file_key, rule_key, sources
from squealpipe.store.keys import misfits, refuse_misfits

MAKERS = {str(path): known for known in workflow.rules for path in known.output}
SOURCES = {}


def maker(path):
    """The rule that makes a file; None if it is given."""
    found = (known for known in workflow.rules if known.has_wildcards() and known.is_producer(path))
    return MAKERS.get(path) or next(found, None)


def set_key(known):
    """Give a rule its key, after those that it reads from; without a script it has none."""
    if "key" in known.params.keys():
        return known.params.key
    if not known.is_script:
        return None
    script = (Path(known.snakefile).parent / known.script).resolve()
    modules = [Path(path).resolve() for path in known.params.get("modules", [])]
    SOURCES[known.name] = sources(script, *modules)
    inputs, parts_of = {}, None
    for path in map(str, known.input):
        made_by = maker(path)
        if made_by is None:
            inputs[Path(path).name] = digest(Path(path).read_bytes())
        elif made_by.has_wildcards():
            parts_of = made_by  # a map that is made in parts has the key of one that is made at once
        else:
            inputs[path.removeprefix(f"{RESULTS}/")] = set_key(made_by)
    key = set_key(parts_of) if parts_of else rule_key(known.params.get("settings", {}), SOURCES[known.name], inputs)
    known.set_params(key=key)
    return key


for known in workflow.rules:
    set_key(known)

KEYS = {path: file_key(known.params.key, path) for path, known in MAKERS.items() if known.is_script and "{" not in path}
"""File → the key that it must state."""


def behind(paths):
    """Files, what else their rules make, and all that is read for them."""
    makers = {maker(str(path)) for path in paths} - {None}
    made = {str(path) for known in makers for path in known.output}
    read = {str(path) for known in makers for path in known.input}
    return made | behind(read - made) if makers else made


# a study of one's own makes what its report needs; Snakemake makes again what is missing of it
TARGETS += KEYS if STUDY.paper else sorted(KEYS.keys() & behind(TARGETS))

for known in workflow.rules:  # the report holds what it shows against the keys
    if known.name in ("write_report", "write_own_report", "write_structure_report"):
        known.set_params(expected={path: KEYS[path] for path in KEYS if path in known.input})


def misjudged(path):
    """Whether Snakemake would keep a file that is not what it should be.

    It believes its record of a file, and without one the file's date: it does not see results that
    were copied, replaced or damaged, or whose records were deleted. A file whose record has another
    key is left to it, and so is one whose job was killed, which it makes again.
    """
    name = base64.urlsafe_b64encode(path.encode()).decode()
    if Path(".snakemake/incomplete", name).exists():
        return False
    record = Path(".snakemake/metadata", name)
    key = KEYS[path].partition(" ")[0]
    unseen = not record.exists() or key in record.read_text(encoding="utf-8")
    return unseen and Path(path).is_file() and bool(misfits({path: KEYS[path]}))


ASKED = os.environ.get(PLAN_VARIABLE)
if workflow.is_main_process and not ASKED:
    refuse_misfits({path: KEYS[path] for path in KEYS if misjudged(path)})

DRAWN = {f"{RESULTS}/figures/{name}.{ending}": name for name in READ_BY for ending in ("png", "svg")}
"""File of a picture → its figure, where a rule draws all figures of a topic."""


def of_picture(path):
    """Return what one picture is drawn from, of all that its rule reads and imports."""
    if path not in DRAWN:
        return {}
    read = [str(MADE[name]["path"]) for name in READ_BY[DRAWN[path]]]
    return {"reads": read, "imports": list(map(str, sources(declared.find_module(DRAWN[path]))))}


# What `squealpipe explain` and `archive` ask for: what each file should be.
if ASKED:
    Path(ASKED).write_text(
        json.dumps(
            {
                path: {
                    "rule": MAKERS[path].name,
                    "key": key,
                    "settings": MAKERS[path].params.get("settings", {}),
                    "sources": list(map(str, SOURCES[MAKERS[path].name])),
                    "inputs": list(map(str, MAKERS[path].input)),
                    **of_picture(path),
                }
                for path, key in KEYS.items()
            }
        ),
        encoding="utf-8",
    )
