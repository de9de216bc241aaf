"""Beyond the point contact: an elastic pad on several contact points."""


rule compare_contact_points:
    output:
        data("contact_points"),
    params:
        settings=settings("contact_points"),
    threads: (workflow.cores + 1) // 2
    script:
        "../scripts/structure/compare_contact_points.py"
