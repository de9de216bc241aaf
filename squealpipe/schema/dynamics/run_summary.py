"""What one run says in a few numbers, with the spectrum of its contact force."""

from squealpipe.schema import RUN_ENDS, DatasetSchema, Variable, outcome
from squealpipe.schema.agreement import Listing
from squealpipe.schema.dynamics.explorer import FREQUENCY
from squealpipe.schema.dynamics.runs import IMPACT_SPEED, RETURN_FORCE

RUN_SUMMARY = DatasetSchema(
    name="run_summary",
    title="Summary of one run",
    lists={"peak": Listing()},
    coordinates={
        "frequency": FREQUENCY,
        "peak": Variable("peak of the spectrum, by height", dims=("peak",), dtype="i4"),
    },
    variables={
        "first_separation_time": Variable(
            "time of the first loss of contact", "s", nan_allowed=True
        ),
        "impact_rate": Variable("contacts regained per time", "s-1"),
        "separated_fraction": Variable("share of the time without contact"),
        "stick_fraction": Variable("share of the time in stick"),
        "peak_contact_force": Variable("largest sampled contact force over k3 l_pre"),
        "return_peak_contact_force": RETURN_FORCE,
        "impact_speed": IMPACT_SPEED,
        "largest_x": Variable("largest |x| among the samples", "m"),
        "largest_y": Variable("largest |y| among the samples", "m"),
        "force_spectrum": Variable(
            "amplitude spectrum of the normalized contact force", dims=("frequency",)
        ),
        "dominant_frequency": Variable(
            "angular frequencies of its highest peaks", "rad s-1", ("peak",)
        ),
        "dominant_amplitude": Variable("heights of these peaks", dims=("peak",)),
        "outcome": outcome(among=RUN_ENDS),
    },
)
