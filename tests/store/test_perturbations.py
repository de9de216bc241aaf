"""Whatever is done to a dataset, `compare` calls it a difference or none, in both directions."""

import numpy as np
import pytest

from squealpipe import (
    Parameters,
    backbone,
    natural_frequencies,
    simulate,
    stability_map,
)
from squealpipe.schema import schema_of
from squealpipe.store.comparison.compare import compare_datasets
from squealpipe.store.comparison.differences import Agreement

ANGLES = np.linspace(0.3, 2.8, 5)
NUMBER = 100
"""Of the 2,000 that were tried with the datasets of a whole study, too."""


@pytest.fixture(scope="module")
def datasets():
    brake = Parameters()
    return [
        stability_map(brake, ANGLES, ANGLES),
        natural_frequencies(brake, ANGLES, ANGLES),
        simulate(brake, 2.6, 2.6, t_end=20),
        backbone(brake, 0.3 * np.pi, 0.9 * np.pi, mode=1, y_peak_max=2.0),
    ]


def beyond(dataset, rng, *, factor=30.0):
    """One value off by so many tolerances."""
    name = rng.choice(judged(dataset))
    values, entry = dataset[name].values, schema_of(dataset).lookup(name)
    at = rng.choice(np.flatnonzero(np.isfinite(values)))
    values.flat[at] += factor * (entry.atol + entry.rtol * abs(values.flat[at]))
    return dataset


def judged(dataset):
    """Variables of numbers that the schema has compared by value."""
    table = schema_of(dataset)
    return [
        str(name)
        for name, variable in dataset.data_vars.items()
        if variable.dtype.kind == "f"
        and np.isfinite(variable.values).any()
        and (entry := table.lookup(str(name))) is not None
        and not entry.volatile
        and entry.round_off is None
        and entry.rtol < 0.01
    ]


def permuted(dataset, rng):
    table = schema_of(dataset)
    grids = [
        dim for dim in dataset.dims if dim in dataset.coords and dim not in table.lists
    ]
    return dataset.isel({dim: rng.permutation(dataset.sizes[dim]) for dim in grids})


def transposed(dataset, rng):
    return dataset.transpose(*rng.permutation(list(dataset.dims)))


def without(dataset, rng):
    return dataset.drop_vars(rng.choice(judged(dataset)))


def other_units(dataset, rng):
    dataset[rng.choice(judged(dataset))].attrs["units"] = "furlong"
    return dataset


def other_words(dataset, rng):
    dataset[rng.choice(judged(dataset))].attrs["long_name"] = "in other words"
    return dataset.assign_attrs(note="mine", title="another")


CHANGES = {
    beyond: True,
    (lambda dataset, rng: beyond(dataset, rng, factor=0.3)): False,
    permuted: False,
    transposed: False,
    without: True,
    other_units: True,
    other_words: False,
}
"""Change → whether it is a difference."""


@pytest.mark.release
def test_random_changes_are_told_right_in_both_directions(datasets):
    rng = np.random.default_rng(11)
    for _ in range(NUMBER):
        dataset = datasets[rng.integers(len(datasets))]
        change = list(CHANGES)[rng.integers(len(CHANGES))]
        changed = change(dataset.copy(deep=True), rng)
        there, back = (
            compare_datasets("one", *pair)
            for pair in ((dataset, changed), (changed, dataset))
        )
        for found in (there, back):
            different = found.verdict >= Agreement.different
            assert different is CHANGES[change], (dataset.schema, change, found)
        assert (there.compared, there.values) == (back.compared, back.values)
