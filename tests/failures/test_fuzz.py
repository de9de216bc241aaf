"""No call is silent, raw or endless, whatever it is given."""

import warnings

import numpy as np
import pytest
import xarray as xr

from tests.failures.fuzz import fuzz, warm_up


@pytest.mark.parametrize(
    ("calls", "seed"), [(250, 18), pytest.param(2_000, 1, marks=pytest.mark.release)]
)
def test_random_calls(calls, seed):
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", RuntimeWarning
        )  # extremes overflow on their way to NaN
        verdict = fuzz(calls, seed)
    assert not verdict.faults, "\n\n".join(verdict.faults[:10])
    assert len(verdict.refused) == calls
    assert 0.3 * calls < sum(verdict.refused) < 0.7 * calls


def test_faults_are_found(monkeypatch):
    """The judge itself: a function that takes anything, one that raises a raw error."""
    from tests.failures import fuzz as judged

    warm_up()
    takes_all = (1.0, lambda **_: None, {"alpha1": judged.ANGLE})
    raw = (1.0, lambda **given: given["alpha1"] + 1.0 // 0.0, {"alpha1": judged.ANGLE})
    nan = xr.Dataset({"x": ("time", [np.nan]), "outcome": ("time", [0])})
    unearned = (1.0, lambda **_: nan, {"alpha1": judged.Kind(lambda _: 1.0, [])})
    for call, fault in ((takes_all, "silent"), (raw, "raw"), (unearned, "NaN where")):
        monkeypatch.setattr(judged, "CALLS", {"Scene": call})
        found = judged.fuzz(20, seed=3)
        assert found.faults
        assert all(fault in text for text in found.faults)
