"""Nonlinear runs in time: the scenes of Figs. 2–5, the maps, the whirl."""

from squealpipe.laws.contact_laws import LINEAR
from squealpipe.parameters import SCENES

PLACED = ["F3"]  # its distance from the boundary is measured
IN_TIME = [scene for scene in SCENES.values() if scene.figure <= 5]


for folder, reading in SHOWN.items():

    rule:
        name:
            rule_name("simulate", folder, "scenes")
        output:
            **{scene.name: data(f"{folder}simulate/{scene.name}") for scene in IN_TIME},
            **{name: data(f"{folder}simulate/{name}") for name in ("F3_long", "F4_long", "F2a_printed")},
        params:
            settings=settings("parameters", "dynamics.tol", read_as=reading),
        script:
            "../scripts/dynamics/simulate_scenes.py"

    validity = settings(
        "parameters",
        "dynamics.tol",
        "dynamics.validity_horizon",
        "dynamics.validity_points",
        read_as=reading,
    )

    rule:
        name:
            rule_name("map", folder, "validity")
        output:
            map_output(f"{folder}validity_map", validity),
        params:
            settings=validity,
        threads: cores_for(STUDY.dynamics.validity_points**2, enough=10_000)
        script:
            "../scripts/dynamics/map_validity.py"

if STUDY.paper and _given.contact_law == LINEAR:

    # in one job: where no mass is as fast as the belt, all readings have one boundary
    rule follow_boundary:
        output:
            **{
                reading: [
                    data(f"{folder}{name}")
                    for name in ("validity_boundary", *(f"validity_distance/{scene}" for scene in PLACED))
                ]
                for folder, reading in SHOWN.items()
            },
        params:
            settings=settings(
                "parameters",
                "dynamics.tol",
                "dynamics.validity_horizon",
                "dynamics.validity_points",
                read_as=READING,
            ),
        threads: cores_for(1, enough=1)
        script:
            "../scripts/dynamics/follow_boundary.py"


HAMMERING = settings(
    "parameters", "dynamics.tol", "dynamics.hammering_horizon", "dynamics.hammering_points"
)


rule map_hammering:
    output:
        map_output("hammering_map", HAMMERING),
    params:
        settings=HAMMERING,
    threads: cores_for(STUDY.dynamics.hammering_points**2, enough=4000)
    script:
        "../scripts/dynamics/map_hammering.py"


rule refine_validity:
    output:
        data("refined_validity_map"),
    params:
        settings=settings(
            "parameters",
            "dynamics.tol",
            "dynamics.validity_horizon",
            "dynamics.refined_points",
            "dynamics.refined_coarse",
            read_as=READING,
        ),
    threads: cores_for(STUDY.dynamics.refined_points**2, enough=1_000_000)
    script:
        "../scripts/dynamics/refine_validity.py"


if STUDY.paper and PAPERS_FRICTION:
    CHARTED = ["F2d", "F3", "F4"]

    rule chart_regimes:
        output:
            angles=data("angle_chart"),
            friction=[data(f"friction_chart/{name}") for name in CHARTED],
        params:
            settings=settings(
                "parameters",
                "dynamics.tol",
                "dynamics.chart_horizon",
                *(["cycles.damping", "cycles.settle"] if STUDY.paper else ["scenes"]),
            ),
        threads: cores_for(1, enough=1)
        script:
            "../scripts/dynamics/chart_regimes.py"


rule follow_whirl:
    output:
        run=data("simulate/whirl"),
        whirl=data("whirl"),
        transient=data("transient"),
    params:
        settings=settings(
            "parameters",
            "dynamics.tol",
            "dynamics.whirl_speeds",
            "dynamics.whirl_count",
            "dynamics.whirl_horizon",
            "dynamics.transient_samples",
            "dynamics.transient_horizon",
        ),
    threads: cores_for(STUDY.dynamics.transient_samples, enough=100)
    script:
        "../scripts/dynamics/follow_whirl.py"
