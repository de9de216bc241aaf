"""The model ladder: how far each level is right, and the cheapest one for a question."""

rule map_model_ladder:
    output:
        data("model_ladder"),
    params:
        settings=settings("parameters", "comparison.ladder"),
    threads: all_cores_for(STUDY.comparison.ladder.points**2, enough=1000)  # it quotes times
    priority: FIRST
    script:
        "../scripts/ladder/map_model_ladder.py"
