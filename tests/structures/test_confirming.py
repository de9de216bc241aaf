"""Critical frictions of large structures: found in a subspace, confirmed in the whole."""

import numpy as np
import pytest

from squealpipe.structures import dense
from squealpipe.structures.coordinates import Coordinates, StaticSpace
from squealpipe.structures.numbering import Way
from squealpipe.structures.onset import confirmed
from squealpipe.structures.schema.structures import Onset
from squealpipe.structures.shipped_pad import elastic_pad
from squealpipe.structures.spectrum import Limits, Solver
from tests.structures.test_large import by_scipy


def followed(structure, frictions):
    """The way of all modes of a structure along friction, and its critical frictions."""
    way = Way(Solver(structure, Limits(45e3), structure.belt_speed))
    way.follow(frictions, None)
    step = way.steps[frictions[-1]]
    numbers = step.numbers[way.solver.selected(step.spectrum)].tolist()
    return [each for each in way.criticals(numbers) if each.onset == Onset.located]


def test_modes_of_a_large_pad_merge_where_scipys_eigenvalues_do():
    pad = elastic_pad(elements=(48, 10), mu=0.3)
    assert pad.size > 1000
    modes = pad.complex_modes(frequency_max=45e3)
    located = modes.critical_mu.values[modes.onset == Onset.located]
    assert len(located) == 2  # a pair, of which one grows
    closed = np.ones(4, bool)
    for share, expected in ((1 - 1e-6, 0), (1 + 1e-6, 1)):
        values = by_scipy(pad, closed, share * located[0], 14)
        assert (values.real > 1e-2).sum() == expected


@pytest.mark.release
def test_of_a_pad_of_350_dense_algebra_sees_the_friction_asked_for_alone(monkeypatch):
    """983 degrees of freedom took 505 s and 1.7 GB where it saw each friction on the way."""
    sizes = []

    def counted(pencil, find=dense.all_modes):
        sizes.append(pencil.size)
        return find(pencil)

    monkeypatch.setattr(dense, "all_modes", counted)
    pad = elastic_pad(mu=0.5)
    modes = pad.complex_modes(frequency_max=60e3)
    assert sizes.count(pad.size) == 1
    assert max(size for size in sizes if size != pad.size) < 120
    # the truth of all modes: the lower pair merges there
    merging = modes.critical_mu.values[modes.unstable.values]
    assert merging[0] == pytest.approx(0.370483, abs=5e-7)
    assert modes.growth_rate.values[modes.unstable.values] == pytest.approx(
        [2333.26, 3458.64], abs=5e-3
    )


@pytest.mark.release
@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"elements": (24, 6), "mu": 0.5, "contacts": 8}, 4),
        pytest.param(
            {"contacts": 7, "mu": 0.46, "belt_speed": -2.0}, 4, marks=pytest.mark.long
        ),
        ({"contacts": 3, "mu": 0.97, "modal_damping": 0.002}, 1),
        pytest.param(
            {"contacts": 5, "mu": 0.8, "elements": (60, 10)}, 2, marks=pytest.mark.long
        ),
    ],
)
def test_critical_frictions_are_those_of_the_whole_followed(changes, expected):
    pad = elastic_pad(**{"elements": (48, 10), **changes})
    modes = pad.complex_modes(frequency_max=45e3)
    frictions = np.linspace(0.0, pad.mu, 3).tolist()
    theirs = sorted(each.mu for each in followed(pad, frictions))
    ours = np.sort(modes.critical_mu.values[modes.onset == Onset.located])
    assert len(ours) == expected
    assert ours == pytest.approx(theirs, abs=1e-10)


@pytest.mark.parametrize(
    "damping", [pytest.param(0.0, marks=pytest.mark.release), 0.002]
)
def test_the_whole_has_the_last_word(damping):
    pad = elastic_pad(elements=(12, 3), mu=0.7, modal_damping=damping)
    solver = Solver(pad, Limits(), pad.belt_speed)
    expected = followed(pad, [0.35, 0.525, 0.7])
    kept = Coordinates(StaticSpace(pad, 14), 14, 0)
    # modes at rest alone are a poor subspace: what it finds is not what the whole does
    found = followed(kept.reduced, [0.35, 0.525, 0.7])
    assert found
    other = pad.with_(stiffness=1.5 * pad.stiffness)
    elsewhere = Solver(other, Limits(), pad.belt_speed)
    for each in found:
        mu = confirmed(solver.pencil, each.crossing, kept.modes)
        nearest = min(expected, key=lambda one, mu=each.mu: abs(one.mu - mu))
        assert abs(each.mu - nearest.mu) > 1e-5
        assert mu == pytest.approx(nearest.mu, abs=1e-10)
        assert confirmed(elsewhere.pencil, each.crossing, kept.modes) is None


@pytest.mark.release
@pytest.mark.parametrize(
    "changes",
    [
        {"mu": 0.3},
        pytest.param(
            {"mu": 0.97, "contacts": 3, "modal_damping": 0.002}, marks=pytest.mark.long
        ),
    ],
)
def test_a_friction_that_is_critical_to_round_off_gets_no_wrong_label(changes):
    """Where the whole and the subspace may differ by round-off a mode is not followed at worst."""
    pad = elastic_pad(elements=(48, 10), **changes)
    assert pad.size > 1000
    modes = pad.complex_modes(frequency_max=45e3)
    located = modes.critical_mu.values[modes.onset == Onset.located]
    critical = located.min()
    number = (located == critical).sum()
    honest = {Onset.stable, Onset.located, Onset.not_followed}
    for mu in critical + critical * np.array([-1e-13, -1e-16, 0.0, 1e-16, 1e-13]):
        near = pad.complex_modes(mu=mu, frequency_max=45e3)
        assert set(near.onset.values.tolist()) <= honest
        assert (near.onset == Onset.stable).sum() >= near.onset.size - number
        told = near.critical_mu.values[near.onset == Onset.located]
        assert told == pytest.approx(critical, rel=1e-12)
    below, above = (
        pad.complex_modes(mu=critical * share, frequency_max=45e3)
        for share in (1 - 1e-9, 1 + 1e-9)
    )
    assert (below.onset == Onset.stable).all()
    assert (above.onset == Onset.located).sum() == number
