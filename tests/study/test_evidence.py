"""What a statement's check has looked at, by name and id."""

import xarray as xr

from squealpipe.parameters import Parameters
from squealpipe.study.evidence import Evidence


def test_each_dataset_that_is_looked_at_is_noted_with_its_id_until_forgotten():
    stored, other = xr.Dataset(attrs={"dataset_id": "5a1acd4c"}), xr.Dataset()
    evidence = Evidence(Parameters(), {"whirl": stored, "map": other, "waits": other})
    for name in ("whirl", "map", "whirl"):
        assert evidence[name] is (stored if name == "whirl" else other)
    assert evidence.forget() == ["whirl (5a1acd4c)", "map (not stored)"]
    assert evidence.forget() == []
