"""What one run says in a few numbers, with the spectrum of its contact force."""

from __future__ import annotations

from squealpipe.schema import DatasetSchema, Variable, outcome
from squealpipe.schema.explorer import FREQUENCY

RUN_SUMMARY = DatasetSchema(
    name="run_summary",
    title="Summary of one run",
    coordinates={
        "frequency": FREQUENCY,
        "peak": Variable(dims=("peak",), dtype="i4", long_name="peak of the spectrum, by height"),
    },
    variables={
        "first_separation_time": Variable(
            units="s", long_name="time of the first loss of contact", nan_allowed=True
        ),
        "impact_rate": Variable(units="s-1", long_name="contacts regained per time"),
        "separated_fraction": Variable(long_name="share of the time without contact"),
        "stick_fraction": Variable(long_name="share of the time in stick"),
        "peak_contact_force": Variable(long_name="largest sampled contact force over k3 l_pre"),
        "largest_x": Variable(units="m", long_name="largest |x| among the samples"),
        "largest_y": Variable(units="m", long_name="largest |y| among the samples"),
        "force_spectrum": Variable(
            dims=("frequency",), long_name="amplitude spectrum of the normalized contact force"
        ),
        "dominant_frequency": Variable(
            dims=("peak",), units="rad s-1", long_name="angular frequencies of its highest peaks"
        ),
        "dominant_amplitude": Variable(dims=("peak",), long_name="heights of these peaks"),
        "outcome": outcome(),
    },
)
