"""The model ladder: how far each level is right, and the cheapest one for a question."""

LADDER_LEVELS = [
    from_root(path) for path in sorted((ROOT / "squealpipe/tasks/ladder/levels").glob("*.py"))
]


rule map_model_ladder:
    output:
        data("model_ladder"),
    params:
        modules=LADDER_LEVELS,
        part=part("parameters", "comparison.ladder"),
    threads: all_cores_for(STUDY.comparison.ladder.points**2, enough=1000)  # it quotes times
    priority: FIRST
    script:
        "../scripts/ladder/map_model_ladder.py"
