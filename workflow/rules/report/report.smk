"""The report: datasets, figures and claims on one page. Included last: it reads all other rules."""

MADE = lineage(workflow.rules, f"{RESULTS}/data/")
DRAWN = {
    name: {
        "path": f"{RESULTS}/figures/{name}.png",
        "rule": f"draw_{declared.topic(name)}",
        "datasets": found,
    }
    for name, found in READ_BY.items()
}

TEMPLATES = sorted(
    from_root(path)
    for path in (ROOT / "squealpipe/study/report").rglob("*.*")
    if path.suffix in (".typ", ".css") or path.name == "page.html.j2"
)


if STUDY.paper:
    LINKS = {
        "This report as PDF": f"{RESULTS}/report/report.pdf",
        "methods, accuracy and failures": f"{RESULTS}/report/supplement.html",
        "rules, checksums and configuration": f"{RESULTS}/report/provenance.json",
    }
    if PAPERS_FRICTION:
        LINKS["the explorer of all angles"] = f"{RESULTS}/report/explorer.html"


    rule write_report:
        input:
            datasets=[made["path"] for made in MADE.values()],
            figures=[made["path"] for made in DRAWN.values()],
            templates=TEMPLATES,
        output:
            page=f"{RESULTS}/report/index.html",
            pdf=f"{RESULTS}/report/report.pdf",
            supplement=f"{RESULTS}/report/supplement.html",
            supplement_pdf=f"{RESULTS}/report/supplement.pdf",
            provenance=f"{RESULTS}/report/provenance.json",
        params:
            modules=[from_root(declared.find_module(name)) for name in READ_BY],
            settings=STUDY.slice("parameters", "reading"),
            made=MADE,
            drawn=DRAWN,
            changed=STUDY.changes_of(SHIPPED),
            links=LINKS,
        script:
            "../../scripts/report/write_report.py"

    TARGETS += rules.write_report.output
elif STUDY.structure is not None:
    told = {name: made for name, made in MADE.items() if name.startswith("structure/")}

    rule write_structure_report:
        input:
            datasets=[made["path"] for made in told.values()],
            figures=[made["path"] for made in DRAWN.values()],
            templates=TEMPLATES,
        output:
            page=f"{RESULTS}/report/index.html",
            pdf=f"{RESULTS}/report/report.pdf",
            provenance=f"{RESULTS}/report/provenance.json",
        params:
            modules=[from_root(declared.find_module(name)) for name in READ_BY],
            made=told,
            drawn=DRAWN,
        script:
            "../../scripts/structure/write_structure_report.py"

    TARGETS += rules.write_structure_report.output
else:
    read = {"verdict_map", "verdict_shares"}
    own = {name: made for name, made in MADE.items() if name in read or name.startswith(("own/", "assess/", "settled/"))}
    own |= {name: MADE[name] for drawn in DRAWN.values() for name in drawn["datasets"]}

    rule write_own_report:
        input:
            datasets=[made["path"] for made in own.values()],
            figures=[made["path"] for made in DRAWN.values()],
            templates=TEMPLATES,
        output:
            page=f"{RESULTS}/report/index.html",
            pdf=f"{RESULTS}/report/report.pdf",
            provenance=f"{RESULTS}/report/provenance.json",
            tables=f"{RESULTS}/report/tables.xlsx",
        params:
            modules=[from_root(declared.find_module(name)) for name in READ_BY],
            settings=settings("parameters"),
            left_out=LEFT_OUT,
            became=STUDY.parameters.became(),
            made=own,
            drawn=DRAWN,
            changed=[row for row in STUDY.changes_of(SHIPPED) if row[0].startswith(("dynamics.", "robustness."))],
        script:
            "../../scripts/own/write_own_report.py"

    TARGETS += rules.write_own_report.output
