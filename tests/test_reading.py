"""The three readings of the sign of friction."""

import pytest

from squealpipe.brake.models.variants import VARIANT_RULES
from squealpipe.parameters import Parameters
from squealpipe.reading import READINGS, corrected, for_linear

PARAMS = Parameters(belt_speed=100.0)


@pytest.mark.parametrize(
    ("reading", "model", "belt", "mended"),
    [
        ("as_printed", "A1-as-printed", 100.0, -100.0),
        ("along_plus_x", "A1", 100.0, 100.0),
        ("along_minus_x", "A1", -100.0, -100.0),
    ],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_reading_has_its_belt_and_model(reading, model, belt, mended, sign):
    params = PARAMS.with_(belt_speed=sign * 100.0)
    assert READINGS[reading].a1_model == model
    assert sign * for_linear(params, reading).belt_speed == belt
    assert sign * corrected(params, reading).belt_speed == mended


def test_the_correction_has_one_sign_and_is_its_own():
    assert list(READINGS) == ["as_printed", "along_plus_x", "along_minus_x"]
    for reading in READINGS.values():
        assert reading.a1_model in VARIANT_RULES
        mended = READINGS[reading.corrected]
        assert mended.a1_model == "A1"
        assert READINGS[mended.corrected] == mended
