"""A study of a structure (``structure:``): its complex modes, which squeal, and what stops it."""

from squealpipe.store.rerun.key import files_named_in
from squealpipe.store.yaml_files import read_yaml

STRUCTURE = settings("structure")

if workflow.is_main_process:  # jobs need not check again: the import takes a second
    from squealpipe.store.mistakes import ConfigError
    from squealpipe.study.configuration.settings import files_of_user
    from squealpipe.study.structure_study import modifications, operating_options, read_structure

    try:
        of_study = read_structure(STRUCTURE["structure"])
        modifications(of_study, STUDY.slice("modifications")["modifications"])
        if STUDY.operating is not None:
            operating_options(of_study, STRUCTURE["structure"], STUDY.slice("operating")["operating"])
    except (ValueError, FileNotFoundError) as fault:
        raise ConfigError([str(fault)], files_of_user(workflow.configfiles)) from fault


rule analyse_structure:
    input:
        files=sorted(set(files_named_in(STRUCTURE))),
    output:
        modes=data("structure/modes"),
        squeal=data("structure/squeal"),
        contacts=f"{RESULTS}/report/contacts.csv",
    params:
        settings=STRUCTURE,
    threads: workflow.cores
    script:
        "../scripts/structure/analyse_structure.py"


rule assess_structure:
    input:
        files=sorted(set(files_named_in(STRUCTURE))),
        squeal=data("structure/squeal"),
    output:
        answer=data("structure/assess"),
        run=data("structure/run"),
    params:
        settings=settings("structure", "modifications"),
    threads: workflow.cores
    script:
        "../scripts/structure/assess_structure.py"


if STUDY.operating is not None:
    OPERATING = settings("structure", "operating")
    number = min(PARTS, STUDY.operating.longest)
    parts = f"{RESULTS}/parts/operating/{{scatteritem}}.nc"

    scattergather:
        operating=number,

    rule map_operating_points:
        input:
            files=sorted(set(files_named_in(OPERATING))),
        output:
            data("structure/operating") if number == 1 else temp(parts),
        params:
            settings=OPERATING,
        threads: workflow.cores if number == 1 else 1
        script:
            "../scripts/structure/map_operating_points.py"

    if number > 1:

        rule join_operating_points:
            input:
                files=sorted(set(files_named_in(OPERATING))),
                parts=gather.operating(parts),
            output:
                data("structure/operating"),
            params:
                settings=OPERATING,
            script:
                "../scripts/structure/join_operating_points.py"


_contacts = read_yaml(Path(STRUCTURE["structure"]["file"])).get("contacts")

# faces of a mesh; a table of contacts is no mapping
if isinstance(_contacts, dict) and any(face.get("points", 3) > 2 for face in _contacts.values()):

    rule compare_fewer_points:
        input:
            files=sorted(set(files_named_in(STRUCTURE))),
        output:
            data("structure/fewer_points"),
        params:
            settings=STRUCTURE,
        script:
            "../scripts/structure/compare_fewer_points.py"
