"""Onset and end of squeal over friction, against closed forms and an integrator apart."""

import numpy as np
import pytest

from squealpipe import Contact, Structure, load, plot, save, squealing_modes
from squealpipe.codes import Verdict
from squealpipe.plotting import picture
from squealpipe.schema import Outcome
from squealpipe.structures.schema.squealing import JUST_ABOVE, OnsetKind, SquealLimits
from squealpipe.study.report.squealing import lines
from tests.oracles.structure_answers import Motion

UNITS = 1e4
"""rad/s of a mode."""
PRELOAD, CONTACT = 2e3, 2.25 * UNITS**2


def soft(mu, **further):
    """Two modes of which contact loss brings the frequencies together."""
    contact = Contact("c", {1: -1.0}, {0: 1.0}, stiffness=CONTACT, preload=PRELOAD)
    stiffness = np.array([[2.7, -0.4], [-0.4, 1.125]]) * UNITS**2
    given = {"modal_damping": 0.045, "contacts": [contact], "belt_speed": -2.0}
    return Structure(np.eye(2), stiffness, mu=mu, **given | further)


def hoffmann(mu, **further):
    """Hoffmann's two modes, of which contact loss takes the frequencies apart."""
    contact = Contact("c", {1: -1.0}, {0: 1.0}, stiffness=4 / 3 * UNITS**2, preload=2e3)
    stiffness = np.array([[2.0, -1.0], [-1.0, 2 / 3]]) * UNITS**2
    given = {"modal_damping": 0.02, "contacts": [contact], "belt_speed": -2.0}
    return Structure(np.eye(2), stiffness, mu=mu, **given | further)


def test_of_hoffmanns_modes_squeal_dies_where_it_begins():
    answer = squealing_modes(hoffmann(0.6), samples=1, onset=True, workers=1)
    modes = hoffmann(0.9).complex_modes()
    assert Verdict(int(answer.verdict)) is Verdict.quiet
    assert float(answer.onset_mu) == pytest.approx(
        float(modes.critical_mu.min()), abs=1e-9
    )
    assert int(answer.onset_kind) == OnsetKind.supercritical
    assert int(answer.onset_outcome) == Outcome.converged
    assert not answer.squeals_below_critical
    assert float(answer.hysteresis) == 0.0
    assert float(answer.mu_dies[0]) == float(answer.onset_mu)
    said = lines(answer)
    assert "turns unstable at mu = 0.7401" in said[-1]
    assert said[-1].endswith("The noise just above it dies there (supercritical).")


@pytest.mark.release
def test_without_damping_or_an_onset_nothing_is_followed():
    still = squealing_modes(
        hoffmann(0.6, modal_damping=0.0), samples=1, onset=True, workers=1, t_end=0.2
    )
    assert float(still.onset_mu) == pytest.approx(0.75, abs=1e-9)
    assert int(still.onset_outcome) == Outcome.unresolved
    assert still.sizes["track"] == 0
    assert "is undetermined" in lines(still)[-1]
    low = squealing_modes(hoffmann(0.3), samples=1, onset=True, workers=1)
    assert int(low.onset_outcome) == Outcome.not_reached
    assert np.isnan(float(low.onset_mu))
    assert "no mode turns unstable" in lines(low)[-1]


@pytest.fixture(scope="module")
def answer():
    return squealing_modes(soft(0.45), samples=4, onset=True, workers=1)


def squealing(answer, mu, start, end):
    """Events in the last tenth of a run apart from the package, from a share of what squeals."""
    structure = soft(mu)
    at_rest = at_sliding(mu)
    squeal = np.concatenate([answer.displacement[0], answer.velocity[0]])
    state = at_rest + start * (squeal - at_sliding(0.45))
    motion = Motion(structure, state)
    motion.run(0.9 * end)
    return motion.run(0.1 * end)["events"] > 0


def at_sliding(mu):
    """Steady sliding, from the equations of a leg alone; the belt runs backwards."""
    leg = Motion(soft(mu)).flow([-1])[0]
    return np.linalg.solve(leg[:-1, :-1], -leg[:-1, -1])


@pytest.mark.release
def test_squeal_lasts_below_the_critical_friction_down_to_the_fold(answer):
    assert int(answer.onset_kind) == OnsetKind.subcritical
    assert answer.track_attractor.values.tolist() == [0, JUST_ABOVE]
    fold, critical = float(answer.mu_dies[0]), float(answer.onset_mu)
    assert answer.mu_dies_is_fold.all()
    # what runs say brackets what the exact map says
    low, high = float(answer.mu_dies_low[0]), float(answer.mu_dies_high[0])
    assert low < fold < high <= low + 1.001 * SquealLimits.narrow * critical
    assert float(answer.hysteresis) == pytest.approx(critical - fold)
    # an integrator apart: it lasts, and does not begin, just above the fold; below it dies
    assert squealing(answer, 1.004 * fold, 1.0, 0.15)
    assert not squealing(answer, 1.004 * fold, 0.05, 0.15)
    assert not squealing(answer, 0.992 * fold, 1.0, 0.15)


@pytest.mark.release
def test_the_unstable_cycle_ends_where_the_contact_is_just_touched(answer):
    """At the critical friction small motions keep their size until contact is lost."""
    critical = float(answer.onset_mu)
    values, vectors = np.linalg.eig(Motion(soft(critical)).flow([-1])[0][:-1, :-1])
    place = int(np.argmax(values.real + 1e-3 * values.imag))
    shape = vectors[:, place]
    assert abs(values[place].real) < 1e-6 * abs(values[place])
    # as far as steady sliding presses the contact in
    shape *= (PRELOAD / CONTACT + at_sliding(critical)[1]) / abs(shape[1])
    touching = np.sqrt((abs(shape[2:]) ** 2).sum() / 2)
    assert float(answer.unstable_mu[0][-1]) == pytest.approx(critical, rel=1e-6)
    assert float(answer.unstable_velocity_rms[0][-1]) == pytest.approx(
        touching, rel=1e-3
    )


@pytest.mark.release
def test_words_and_picture_show_the_fold(answer, tmp_path):
    said = "\n".join(lines(answer))
    assert "lasts down to mu = 0.3342, 13 % below the critical friction (subcr" in said
    assert "As friction falls, the motion at 2.56 kHz lasts down to mu = 0.3342" in said
    save(answer, tmp_path / "squeal.nc")
    again = load(tmp_path / "squeal.nc")
    assert again.drop_attrs().identical(answer.drop_attrs())
    panels = picture(again).axes
    over = panels[-1]
    assert over.get_xlabel() == "friction μ"
    labels = over.get_legend_handles_labels()[1]
    assert "unstable cycle" in labels
    assert "critical, μ = 0.385" in labels
    assert plot(again).has_data()
    # at a friction below the critical one no small start tells, and the end of the track does
    below = squealing_modes(soft(0.36), samples=4, onset=True, workers=1)
    assert Verdict(int(below.verdict)) is Verdict.quiet
    first, *_, last = lines(below)
    assert first.startswith("Quiet from rest: ")
    assert last == "At mu = 0.36, too, squeal that has begun lasts."
