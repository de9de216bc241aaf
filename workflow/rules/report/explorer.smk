"""The explorer: motions, spectra and backbones on a grid of angles, and the page that shows them."""


rule compute_explorer:
    output:
        data("explorer"),
    params:
        part=part("parameters", "explorer"),
    threads: cores_for(STUDY.explorer.points**2, enough=200)
    script:
        "../../scripts/report/compute_explorer.py"


EXPLORER_PAGE = [
    from_root(f"squealpipe/study/report/explorer/{name}") for name in ("page.html.j2", "explorer.css", "chart.js", "explorer.js")
]


rule write_explorer:
    input:
        explorer=data("explorer"),
        stability=data(f"{BEYOND}stability_map"),
        frequencies=data(f"{BEYOND}natural_frequencies"),
        validity=data(f"{BEYOND}validity_map"),
        hammering=data("hammering_map"),
        ladder=data("model_ladder"),
        page=EXPLORER_PAGE,
    output:
        f"{RESULTS}/report/explorer.html",
    params:
        part=part("scenes"),
    script:
        "../../scripts/report/write_explorer.py"


TARGETS += rules.write_explorer.output
