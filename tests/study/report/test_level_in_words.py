"""Each number of the sentence about a pad's level is that of its own direction."""

import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.study.report.answer import level


def test_levels_along_and_across_the_belt_are_not_mistaken_for_each_other():
    answer = xr.Dataset(
        {
            "verdict": int(Verdict.squeals),
            "velocity_rms_along": 0.25,
            "velocity_rms_across": 0.75,
            "velocity_rms_along_error": 0.0,
            "velocity_rms_across_error": 0.15,
            "displacement_peak": 0.002,
            "peak_contact_force": 30.0,
            "peak_contact_force_over_preload": 1.5,
        }
    )
    assert level(answer) == (
        "Level: 0.25 m/s rms along the belt and 0.75 m/s across it (within 20 %); displacement up "
        "to 2 mm, contact force up to 30 N, 1.5 times the preload force."
    )
