"""Maps from their parts; included after every rule that may be scattered."""

for name, slice_of_study in SCATTERED.items():

    rule:
        name:
            rule_name("join", name)
        input:
            parts=gather.maps(f"{RESULTS}/parts/{name}/{{scatteritem}}.nc"),
        output:
            data(name),
        params:
            settings=slice_of_study,
        script:
            "../../scripts/execution/join_parts.py"
