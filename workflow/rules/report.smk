"""The report: datasets, figures and claims on one page. Included last: it reads all other rules."""

from squealpipe.report.lineage import lineage


def caption_sources(names):
    """Modules that draw the figures, which hold their captions, and all that these import."""
    modules = [ROOT / f"squealpipe/figures/{name}.py" for name in names]
    found = {path for module in modules for path in (module, *closure(module))}
    return sorted(str(path.relative_to(ROOT)) for path in found)


MADE = lineage(workflow.rules, f"{RESULTS}/data/", f"{RESULTS}/figures/")

TEMPLATES = sorted(
    str(path.relative_to(ROOT))
    for path in (ROOT / "squealpipe/report/templates").rglob("*.*")
    if path.suffix in (".typ", ".css") or path.name == "page.html.j2"
)


rule write_report:
    input:
        datasets=[made["path"] for made in MADE["datasets"].values()],
        figures=[made["path"] for made in MADE["figures"].values()],
        captions=caption_sources(MADE["figures"]),
        templates=TEMPLATES,
        sources=sources("write_report"),
    output:
        page=f"{RESULTS}/report/index.html",
        pdf=f"{RESULTS}/report/report.pdf",
    params:
        part=part("parameters"),
        made=MADE,
        explorer="explorer.html" if f"{RESULTS}/report/explorer.html" in TARGETS else None,
    script:
        "../scripts/write_report.py"


TARGETS += rules.write_report.output
