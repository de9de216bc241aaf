"""The three readings of the sign of friction."""

import pytest

from squealpipe.models.variants import VARIANT_RULES
from squealpipe.parameters import Parameters
from squealpipe.reading import READINGS, corrected, for_a1, for_linear

PARAMS = Parameters(belt_speed=100.0)


@pytest.mark.parametrize(
    ("reading", "a1", "linear", "mended"),
    [
        ("as_printed", (100.0, "A1-as-printed"), 100.0, -100.0),
        ("along_plus_x", (100.0, "A1"), 100.0, 100.0),
        ("along_minus_x", (-100.0, "A1"), -100.0, -100.0),
    ],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_reading_has_its_belt_and_model(reading, a1, linear, mended, sign):
    params = PARAMS.with_(belt_speed=sign * 100.0)
    moved, model = for_a1(params, reading)
    assert (sign * moved.belt_speed, model) == a1
    assert sign * for_linear(params, reading).belt_speed == linear
    assert sign * corrected(params, reading).belt_speed == mended


def test_the_correction_has_one_sign_and_is_its_own():
    assert list(READINGS) == ["as_printed", "along_plus_x", "along_minus_x"]
    for reading in READINGS.values():
        assert reading.a1_model in VARIANT_RULES
        mended = READINGS[reading.corrected]
        assert mended.a1_model == "A1"
        assert READINGS[mended.corrected] == mended
