"""The parameters that the paper never printed."""


rule infer_parameters:
    output:
        data("parameter_inference"),
    params:
        settings=STUDY.slice("parameters", "reading", "inference"),
    priority: LONG
    threads: cores_for(STUDY.inference.samples, enough=4000)
    script:
        "../scripts/inference/infer_parameters.py"
