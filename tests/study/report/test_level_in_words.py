"""Each number of the sentence about a pad's level is that of its own direction."""

import pytest
import xarray as xr

from squealpipe.codes import Verdict
from squealpipe.study.report.answer import contact_kept, headline, level


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


def test_a_pad_that_rests_off_the_belt_is_not_said_to_be_still_moving():
    answer = xr.Dataset(
        {
            "verdict": int(Verdict.undetermined),
            "settled_by": 20.5,
            "frequency": 1380.0,
            "frequency_error": 0.0,
            "peak_contact_force_over_preload": 0.0,
            "separated_fraction": 1.0,
            "stick_fraction": 0.0,
        }
    )
    assert headline(answer) == (
        "Undetermined: the mass has left the belt, and had not come back after 20.5 s; without "
        "contact there is nothing to judge."
    )
    moving = headline(answer.assign(separated_fraction=0.95))
    assert "had not settled" in moving
    assert "contact lost 95 % of the time" in moving


@pytest.mark.parametrize(
    ("opened", "told"),
    [
        ([0.0, 0.0], "contact is kept"),
        ([1.0, 0.0], "contact is kept"),
        ([1.0, 3e-4], "contact is lost < 0.1 % of the time"),
        ([0.002, 3e-4], "contact is lost 0.2 % of the time"),
    ],
)
def test_contact_is_kept_only_where_none_is_lost(opened, told):
    """A pad with one loss in 500 periods squealed with "contact is kept"."""
    assert contact_kept(opened) == told
    pad = {"separated_fraction": opened[1], "stick_fraction": 0.0, "frequency": 500.0}
    squealing = {"verdict": int(Verdict.squeals), "frequency_error": 0.0, **pad}
    squealing["peak_contact_force_over_preload"] = 1.2
    kept = contact_kept(opened[1:])
    assert headline(xr.Dataset(squealing)).endswith(f" without sticking; {kept}.")
