"""Summary of a run against closed forms and against its own events."""

import numpy as np
import pytest

from squealpipe import Parameters, basin_map, plot
from squealpipe.brake.dynamics.runs import simulate
from squealpipe.brake.dynamics.summary import summarize, summary_lines
from squealpipe.codes import Event
from squealpipe.plotting.run import draw_spectrum
from squealpipe.schema import Outcome
from squealpipe.vibration.spectrum import amplitude_spectrum, strongest_lines
from tests.former import FORMER


def run(alpha1, alpha2, t_end=200.0, points=4001, **options):
    times = np.linspace(0, t_end, points)
    return simulate(FORMER, alpha1, alpha2, t_end=t_end, times=times, **options)


def test_decoupled_y_motion_has_the_frequency_and_force_of_the_closed_form():
    # A4 with K = diag(k, k): y = κ/(1+κ)(1 − cos √(1+κ) t).
    kappa = FORMER.kappa
    motion = run(np.pi / 2, np.pi, model="A4")
    summary = summarize(motion)
    assert float(summary.dominant_frequency[0]) == pytest.approx(
        np.sqrt(1 + kappa), abs=2e-4
    )
    assert float(summary.dominant_amplitude[0]) == pytest.approx(
        kappa / (1 + kappa), rel=1e-3
    )
    assert float(summary.peak_contact_force) == pytest.approx(1.0)
    assert float(summary.largest_y) == pytest.approx(2 * kappa / (1 + kappa), rel=1e-4)
    assert np.isnan(summary.first_separation_time)
    assert float(summary.separated_fraction) == 0.0
    assert "contact is kept" in "\n".join(summary_lines(motion, summary))


def test_separation_is_that_of_the_events_and_of_the_samples():
    motion = run(5 * np.pi / 6, 5 * np.pi / 6)
    summary = summarize(motion)
    first = motion.event_time.values[motion.event_kind.values == Event.separation][0]
    assert float(summary.first_separation_time) == first
    sampled = float((motion.normalized_contact_force.values <= 0).mean())
    assert float(summary.separated_fraction) == pytest.approx(sampled, abs=2e-3)
    landing = motion.event_time.values[motion.event_kind.values == Event.contact][0]
    force = motion.normalized_contact_force.values[motion.time.values > landing].max()
    assert float(summary.return_peak_contact_force) == pytest.approx(force, abs=1e-3)
    assert (
        summary.peak_contact_force >= summary.return_peak_contact_force
    )  # samples miss it
    words = "\n".join(summary_lines(motion, summary))
    assert "after a return" in words
    assert "separated " in words
    returns = np.count_nonzero(motion.event_kind.values == Event.contact)
    assert float(summary.impact_rate) == returns / 200.0


def test_too_few_or_uneven_samples_are_refused():
    with pytest.raises(ValueError, match="more samples"):
        summarize(run(1.0, 2.0, t_end=10.0, points=8))
    uneven = simulate(FORMER, 1.0, 2.0, t_end=9.0, times=np.linspace(0, 3, 40) ** 2)
    with pytest.raises(ValueError, match="not uniform"):
        summarize(uneven)


def test_a_run_that_starts_in_the_air_is_separated_from_its_start():
    motion = run(np.pi / 2, np.pi, t_end=3.0, initial_state=(0.0, 2.0, 0.0, 0.0))
    landing = float(motion.event_time[0])
    assert int(motion.event_kind[0]) == Event.contact
    sampled = float((motion.normalized_contact_force.values <= 0).mean())
    assert float(summarize(motion).separated_fraction) == pytest.approx(
        sampled, abs=2e-3
    )
    assert float(summarize(motion).separated_fraction) >= landing / 3.0


def test_a_start_off_the_belt_has_lost_contact_at_once_for_every_function():
    start = dict(zip(("x", "y", "vx", "vy"), (0.0, 2.0, 0.3, 0.0), strict=True))
    motion = run(0.4 * np.pi, 0.6 * np.pi, t_end=20.0, initial_state=[*start.values()])
    summary = summarize(motion)
    later = motion.event_time.values[motion.event_kind.values == Event.separation]
    assert later[0] > 1.0
    basin = basin_map(FORMER, 0.4 * np.pi, 0.6 * np.pi, **start, t_end=20.0)
    assert float(summary.first_separation_time) == 0.0
    assert float(basin.first_separation_time) == 0.0
    words = "\n".join(summary_lines(motion, summary))
    assert "first separation   t = 0 s" in words


def test_a_real_brake_is_summed_up_in_millimetres_and_hertz():
    pad = Parameters(
        mass=0.45,
        k1=1e7,
        k2=1e7,
        k3=7e6,
        mu=0.4,
        belt_speed=2,
        preload=5.7e-4,
        length1=0.1,
        length2=0.1,
    )
    motion = simulate(pad, np.radians(22), np.radians(46), t_end=0.04)
    summary = summarize(motion)
    words = "\n".join(summary_lines(motion, summary))
    assert f"|y| = {1e3 * float(summary.largest_y):.5g} mm" in words
    strongest = float(summary.dominant_frequency[0])
    assert f"ω = {strongest:.4g}" in words
    assert f"({strongest / (2 * np.pi):.4g} Hz" in words


def test_a_force_that_ends_for_good_has_no_frequency():
    pad = Parameters(
        mass=0.5,
        k1=1e7,
        k2=1e7,
        k3=7e6,
        mu=0.4,
        belt_speed=2,
        preload=2e-5,
        length1=0.02,
        length2=0.02,
    )
    motion = simulate(pad, np.radians(35), np.radians(145), t_end=0.0447)
    assert float(motion.normalized_contact_force[-1]) == 0.0
    assert summarize(motion).sizes["peak"] == 0
    ax = plot(motion)
    draw_spectrum(ax, motion)
    assert any("no contact in" in text.get_text() for text in ax.texts)


@pytest.mark.parametrize("drift", [0.0, 5.0])
def test_a_drift_is_no_line_and_no_line_comes_twice(drift):
    # two lines, the stronger of which a slow change of amplitude splits, on a drift
    time = np.linspace(0.0, 764.0, 40_001)
    signal = (1.0 + 0.6 * np.cos(1.5 * 2 * np.pi * time / 764.0)) * np.cos(1.3 * time)
    signal += 0.3 * np.cos(2.9 * time) + drift * np.cos(2 * np.pi * time / 764.0)
    spectrum = amplitude_spectrum(signal, float(time[1]), padding=8)
    found, _ = strongest_lines(*spectrum, 3, 2 * np.pi / 764.0)
    assert found == pytest.approx([1.3, 2.9], abs=2e-3)


def test_a_mass_that_reaches_belt_speed_without_stick_does_so_once():
    motion = simulate(
        FORMER.with_(belt_speed=0.1),
        np.pi * 0.1,
        np.pi * 0.5,
        t_end=9.0,
        model="A1-no-stick",
    )
    assert int(motion.outcome) == Outcome.accumulation
    assert motion.sizes["event"] == 1
    assert int(motion.event_kind[0]) == Event.reversal
    stuck = simulate(FORMER.with_(belt_speed=0.1), np.pi * 0.1, np.pi * 0.5, t_end=9.0)
    assert int(stuck.event_kind[0]) == Event.stick
    assert float(motion.event_time[0]) == pytest.approx(
        float(stuck.event_time[0]), rel=1e-12
    )
