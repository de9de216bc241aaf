"""Rules of the switching law, case by case; units m = k1 = l_pre = 1."""

from __future__ import annotations

import numpy as np
import pytest

from squealpipe.laws.springs import Geometry
from squealpipe.models import switching
from squealpipe.models.switching import (
    CONTACT,
    FASTER,
    NO_EVENT,
    REVERSAL,
    SEPARATED,
    SEPARATION,
    SLOWER,
    STICK,
    TO_SLIP,
    TO_STICK,
    VARIANT_RULES,
    ScaledParameters,
    Switch,
    start,
    switch,
)
from tests.former import FORMER

# K is the identity: the elastic force is −(x, y).
G = Geometry(0.0, 1.0, -1.0, 0.0)
PARAMS = FORMER.with_(k3=1.0, mu=0.5, belt_speed=2.0)
P = ScaledParameters.of(PARAMS)
RULES = VARIANT_RULES["A1-linear-springs"]


def at(x, y, vx, vy, regime, p=P, rules=RULES, step=0.1) -> Switch:
    return switch(x, y, vx, vy, regime, step, p, G, rules)


@pytest.mark.parametrize("regime", [SLOWER, FASTER, STICK])
def test_separation_moves_above_the_threshold(regime):
    change = at(0.0, 1.0, 2.0, 0.1, regime)
    assert (change.kind, change.regime) == (SEPARATION, SEPARATED)
    assert change.y == np.nextafter(1.0, 2.0)
    assert change.saltation == 1.0


def test_no_separation_while_it_falls():
    assert at(0.0, 1.0 - 1e-15, 0.0, -0.1, SLOWER).kind == NO_EVENT


@pytest.mark.parametrize(
    ("vx", "x", "regime"),
    [
        (1.0, 0.0, SLOWER),
        (3.0, 0.0, FASTER),
        (2.0, -1.0, FASTER),
        (2.0, 1.0, SLOWER),
        (2.0, 0.0, STICK),
    ],
)
def test_contact_finds_its_regime(vx, x, regime):
    change = at(x, 1.0, vx, -0.1, SEPARATED)
    assert (change.kind, change.regime) == (CONTACT, regime)
    assert change.y < 1.0
    assert np.sign(change.vx - 2.0) == {SLOWER: -1, FASTER: 1, STICK: 0}[regime]


def test_belt_speed_is_held_inside_the_cone():
    change = at(-0.2, 0.0, 2.0, 0.0, SLOWER)
    assert (change.kind, change.regime, change.vx) == (TO_STICK, STICK, 2.0)
    assert change.saltation == 0.0


def test_belt_speed_is_passed_outside_the_cone():
    change = at(-0.8, 0.0, 2.0, 0.0, SLOWER)
    assert (change.kind, change.regime) == (REVERSAL, FASTER)
    assert change.vx > 2.0
    assert change.saltation == pytest.approx((0.8 - 0.5) / (0.8 + 0.5))


def test_moving_away_from_belt_speed_is_no_event():
    change = at(0.8, 0.0, 2.0 - 1e-15, 0.0, SLOWER)
    assert change.kind == NO_EVENT
    assert change.vx < 2.0


@pytest.mark.parametrize(("x", "regime"), [(-0.5, FASTER), (0.5, SLOWER)])
def test_release_to_the_side_that_the_springs_pull(x, regime):
    change = at(x, 0.0, 2.0, 0.0, STICK)
    assert (change.kind, change.regime) == (TO_SLIP, regime)
    assert np.sign(change.vx - 2.0) == (1 if regime == FASTER else -1)


def test_no_release_inside_the_cone():
    assert at(0.4, 0.0, 2.0, 0.0, STICK).kind == NO_EVENT


def test_late_events_are_marked():
    assert at(0.0, 1.1, 0.0, 0.1, SLOWER).late
    assert at(0.0, 0.9, 0.0, -0.1, SEPARATED).late
    assert at(-0.8, 0.0, 2.1, 0.0, SLOWER).late
    assert at(0.9, 0.0, 2.0, 0.0, STICK).late


def test_variants_leave_their_part_out():
    no_stick, a4 = VARIANT_RULES["A1-no-stick"], VARIANT_RULES["A4"]
    linear = no_stick._replace(linear_springs=True)
    assert at(-0.2, 0.0, 2.0, 0.0, SLOWER, rules=linear).kind == switching.CHATTER
    assert at(-0.8, 0.0, 2.0, 0.0, SLOWER, rules=linear).kind == REVERSAL
    assert at(-0.8, 0.0, 2.5, 0.0, SLOWER, rules=a4).kind == NO_EVENT
    kept = VARIANT_RULES["A1-no-separation"]._replace(linear_springs=True)
    assert at(0.0, 1.5, 0.0, 0.1, SLOWER, rules=kept).kind == NO_EVENT


@pytest.mark.parametrize(("x", "regime"), [(-0.2, FASTER), (0.2, SLOWER), (0.0, SLOWER)])
def test_friction_as_printed_never_holds_belt_speed(x, regime):
    """Within the cone a mass at belt speed could leave to either side; the springs decide."""
    rules = VARIANT_RULES["A1-as-printed"]._replace(linear_springs=True)
    repelled = P._replace(mu=-P.mu, static_mu=-P.static_mu, onset_mu=-P.onset_mu)
    assert start(x, 0.0, 2.0, 0.0, repelled, G, rules)[0] == regime
    change = at(-0.8, 0.0, 2.0, 0.0, SLOWER, p=repelled, rules=rules)
    assert (change.kind, change.regime) == (REVERSAL, FASTER)
    assert change.saltation == pytest.approx((0.8 + 0.5) / (0.8 - 0.5))
    assert at(-0.2, 0.0, 2.0 - 1e-15, 0.0, SLOWER, p=repelled, rules=rules).kind == NO_EVENT


@pytest.mark.parametrize(
    ("state", "regime"),
    [
        ((0, 0, 0, 0), SLOWER),
        ((0, 0, 3, 0), FASTER),
        ((0, 0, 2, 0), STICK),
        ((0, 1.5, 0, 0), SEPARATED),
        ((0, 1.0, 0, 0.1), SEPARATED),
        ((0, 1.0, 0, -0.1), SLOWER),
        ((0, 1.0, 0, 0), SLOWER),
    ],
)
def test_start(state, regime):
    found, y, _ = start(*map(float, state), P, G, RULES)
    assert found == regime
    assert (y > 1.0) == (regime == SEPARATED)


def test_no_friction_never_sticks():
    free = ScaledParameters.of(PARAMS.with_(mu=0.0))
    assert start(0.0, 0.0, 2.0, 0.0, free, G, RULES)[0] != STICK
    assert at(0.0, 0.0, 2.0, 0.0, SLOWER, p=free).regime != STICK
