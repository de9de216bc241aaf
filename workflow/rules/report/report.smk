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
    for path in (ROOT / "squealpipe/study/report/templates").rglob("*.*")
    if path.suffix in (".typ", ".css") or path.name == "page.html.j2"
)


rule write_report:
    input:
        datasets=[made["path"] for made in MADE.values()],
        figures=[made["path"] for made in DRAWN.values()],
        captions=figure_sources(READ_BY),
        templates=TEMPLATES,
        sources=sources("report/write_report"),
    output:
        page=f"{RESULTS}/report/index.html",
        pdf=f"{RESULTS}/report/report.pdf",
    params:
        part=part("parameters"),
        made=MADE,
        drawn=DRAWN,
        beyond_paper=not PAPERS_FRICTION,
        animations=ANIMATIONS if PAPERS_FRICTION else {},
        explorer="explorer.html" if f"{RESULTS}/report/explorer.html" in TARGETS else None,
    script:
        "../../scripts/report/write_report.py"


TARGETS += rules.write_report.output
