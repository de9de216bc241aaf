"""The explorer: motions, spectra and backbones on a grid of angles, and the page that shows them."""


rule compute_explorer:
    output:
        data("explorer"),
    params:
        settings=settings("parameters", "explorer", *([] if STUDY.paper else ["scenes"])),
    threads: cores_for(STUDY.explorer.points**2, enough=200)
    script:
        "../../scripts/report/compute_explorer.py"


EXPLORER_PAGE = [
    from_root(f"squealpipe/study/report/explorer/{name}") for name in ("page.html.j2", "explorer.css", "chart.js", "explorer.js")
]
EXPLORER_MAPS = {"verdicts": "verdict_map"}
if STUDY.paper:
    EXPLORER_MAPS = {
        "validity": f"{BEYOND}validity_map",
        "stability": f"{BEYOND}stability_map",
        "frequencies": f"{BEYOND}natural_frequencies",
        "hammering": "hammering_map",
        "ladder": "model_ladder",
    }


rule write_explorer:
    input:
        explorer=data("explorer"),
        page=EXPLORER_PAGE,
        **{name: data(made) for name, made in EXPLORER_MAPS.items()},
    output:
        f"{RESULTS}/report/explorer.html",
    params:
        settings=settings("scenes", "paper"),
        maps=list(EXPLORER_MAPS),
    script:
        "../../scripts/report/write_explorer.py"


TARGETS += rules.write_explorer.output
