"""A reduced structure against eigenvalues of the whole, assembled here and solved by SciPy."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.linalg as la
import xarray as xr
from matplotlib.figure import Figure

from squealpipe import Contact, Structure, assess, labels, plot, squealing_modes
from squealpipe.cli.signatures import in_options
from squealpipe.codes import Verdict
from squealpipe.plotting.squealing import draw_poles
from squealpipe.schema import Outcome
from squealpipe.structures import disc_brake, elastic_pad
from squealpipe.structures.agreement import Truth
from squealpipe.structures.coordinates import Coordinates, StaticSpace
from squealpipe.structures.reduction import Search, fewest_modes
from squealpipe.structures.schema.squealing import Kind
from squealpipe.structures.squeal import plant
from squealpipe.structures.squeal.attractors import grouped
from squealpipe.structures.squeal.remedies import (
    added_damping,
    growth_in_band,
    located_near,
)
from squealpipe.structures.squeal.squealing_modes import _verdict
from squealpipe.study.report.squealing import (
    _of_contacts,
    _peak_force,
    headline,
    lines,
    outside,
)
from squealpipe.study.report.squealing import modes as lines_of_modes
from squealpipe.systems.linear.matrices import Caps
from tests.oracles.elastic_block import elastic_block


def chain(links, *, mu=0.5, offset=0.0):
    """A mirror-symmetric chain of masses in a plane with a contact at each end.

    Args:
        offset: of the stiffness at one end, over itself: 0 keeps the mirror.
    """
    line = 1e8 * (2 * np.eye(links) - np.eye(links, k=1) - np.eye(links, k=-1))
    line += 1e6 * np.eye(links)
    line[0, 0] *= 1.0 + offset
    stiffness = np.zeros((2 * links, 2 * links))
    stiffness[::2, ::2], stiffness[1::2, 1::2] = line, 0.5 * line
    contacts = [
        Contact("left", {1: 1.0}, {0: 1.0}, 1e7, 100.0),
        Contact("right", {2 * links - 1: 1.0}, {2 * links - 2: 1.0}, 1e7, 100.0),
    ]
    return Structure(
        0.1 * np.eye(2 * links), stiffness, contacts=contacts, mu=mu, modal_damping=0.01
    )


def rigid_pad():
    """A rigid pad on an elastic back that rests on its leading and its trailing edge."""
    contacts = [
        Contact("leading", {1: 1.0, 2: 0.03}, {0: 1.0, 2: 0.01}, 2e7, 300.0),
        Contact("trailing", {1: 1.0, 2: -0.03}, {0: 1.0, 2: 0.01}, 2e7, 300.0),
    ]
    return Structure(
        np.diag([0.3, 0.3, 1e-4]),
        np.diag([3e7, 4e7, 1e4]),
        contacts=contacts,
        mu=0.6,
        modal_damping=0.005,
    )


def eigenvalues(structure, ratio):
    """About steady sliding, from dense arrays, s with Im s ≥ 0; None where none was found.

    Args:
        ratio: of the modes of (M, K + Σ k n nᵀ), beside the damping matrix.
    """
    mass, stiffness, damping = (
        each.toarray()
        for each in (structure.mass, structure.stiffness, structure.damping)
    )
    n, t, k, p = (
        structure.normals,
        structure.tangentials,
        structure.stiffnesses,
        structure.preloads,
    )
    acting = n + np.sign(structure.belt_speed * structure.speeds) * structure.mu * t
    closed = np.ones(len(k), bool)
    for _ in range(50):
        rubbing = stiffness + acting * (k * closed) @ n.T
        q = la.solve(rubbing, structure.load + acting @ (p * closed))
        wrong = np.flatnonzero((p - k * (n.T @ q) > 0) != closed)
        if not wrong.size:
            break
        closed[wrong[0]] ^= True
    else:
        return None
    squares, shapes = la.eigh(stiffness + n * k @ n.T, mass)
    to_modes = mass @ shapes
    omega = np.sqrt(np.maximum(squares, 0.0))
    damper = damping + to_modes @ np.diag(2 * ratio * omega) @ to_modes.T
    zero, one = np.zeros_like(mass), np.eye(len(mass))
    values = la.eigvals(
        np.block([[zero, one], [-la.solve(mass, rubbing), -la.solve(mass, damper)]])
    )
    return values[values.imag >= 0]


def test_contacts_on_one_tangent_have_complex_modes_and_share_their_friction_in_stick():
    pad = rigid_pad()
    found = pad.complex_modes()
    ours = found.growth_rate.values + 2j * np.pi * found.frequency.values
    truth = eigenvalues(pad, 0.005)
    assert np.sort_complex(ours) == pytest.approx(np.sort_complex(truth), rel=1e-9)
    # two contacts at one point are one with both stiffnesses and preloads
    contact = pad.contacts[0]
    half = [
        replace(contact, name=name, stiffness=share * contact.stiffness,
                preload=share * contact.preload)
        for name, share in (("a", 0.25), ("b", 0.75))
    ]  # fmt: skip
    alone, twice = (
        pad.with_(contacts=each, belt_speed=0.01).system() for each in ([contact], half)
    )
    end = 20.0 * alone.time_scale
    run, pair = alone.simulate(end, times=[end]), twice.simulate(end, times=[end])
    kinds = [set(labels(each.event_kind).values.tolist()) for each in (run, pair)]
    assert "leading_stick" in kinds[0]
    assert {"a_stick", "b_stick"} <= kinds[1]
    for name in alone.states:
        assert float(pair[name][0]) == pytest.approx(float(run[name][0]), rel=1e-9)


@pytest.mark.parametrize("links", [3, 20])
def test_a_mirror_symmetric_structure_is_reduced_by_itself(links):
    reduced = chain(links).reduce()
    assert reduced.record["agrees"]
    reduced.system()  # both contacts can stick
    assert np.linalg.matrix_rank(reduced.tangentials, tol=1e-6) == 2


def test_a_block_that_rests_on_its_four_corners_is_reduced_and_run_by_default():
    """Its sliding directions were refused as dependent, with the advice to merge the corners."""
    block = elastic_block((1, 1, 2), 4, mu=0.6, modal_damping=0.001)
    reduced = block.reduce()
    assert reduced.record["agrees"]
    assert np.linalg.matrix_rank(reduced.tangentials, tol=1e-6) == 4
    system = reduced.system()
    run = system.simulate(20.0 * system.time_scale)
    assert int(run.outcome) == Outcome.converged
    answer = squealing_modes(reduced, samples=1, t_end=1e-3, tol=1e-6)
    (truth,) = growing(block, 0.001).real
    error = float(answer.mode_growth_rate_error[0])
    assert float(answer.growth_rate[0]) == pytest.approx(truth, abs=1.01 * error)


def test_a_local_flutter_needs_fewer_coordinates_than_modes_at_rest():
    """A mode at 105 kHz needed 39 modes at rest of 40."""
    pad = elastic_pad(
        elements=(4, 3), contacts=2, mu=0.4, contact_stiffness=3e9, modal_damping=0.02
    )
    truth = growing(pad, 0.02)
    assert len(truth) == 1
    search = Search(pad, Truth.of(pad, None), None)
    for number in range(30, 39):
        assert search.structure(number, 0).record["growth_rate_error"] > 0.01
    reduced = pad.reduce()
    assert reduced.size <= 30
    assert growing(reduced) == pytest.approx(truth, rel=1e-2)


@pytest.mark.parametrize("mu", [0.2, 1.6])
def test_with_static_responses_contact_forces_of_sliding_are_those_of_the_whole(mu):
    """Also where contacts have opened: the static compliance of each contact is kept."""
    pad = elastic_pad(elements=(10, 3), contacts=5, mu=mu).with_(load=tilt(88))
    search = Search(pad, Truth.of(pad, 1e4), 1e4)
    reduced = search.structure(9, 1)
    assert reduced.record["static_responses"] == 5
    whole = sliding_forces(pad)
    assert sliding_forces(reduced) == pytest.approx(whole, abs=1e-9 * whole.max())
    assert (whole == 0).any() == (mu > 1.0)
    # invariants of the coordinates
    shapes, at_rest = reduced.modes, pad.stiffness_at_rest
    assert shapes.T @ pad.mass @ shapes == pytest.approx(np.eye(9), abs=1e-10)
    squares = shapes.T @ at_rest @ shapes
    scale = np.sqrt(np.outer(np.diag(squares), np.diag(squares)))
    assert squares / scale == pytest.approx(np.eye(9), abs=1e-9)


def test_coordinates_do_not_depend_on_how_many_modes_were_computed():
    """States of a stored answer are in these coordinates, which are computed again."""
    pad = elastic_pad(elements=(10, 3), contacts=5, modal_damping=0.01)
    few, many = (Coordinates(StaticSpace(pad, n_modes), 14, 2) for n_modes in (20, 80))
    assert few.n_modes == many.n_modes == 4
    assert few.omega == pytest.approx(many.omega, rel=1e-9)
    assert few.modes == pytest.approx(many.modes, abs=1e-6 * np.abs(many.modes).max())


def tilt(size):
    """A load that presses a pad of 11 × 4 nodes, more at its leading edge."""
    load = np.zeros(size)
    load[7::8] = -np.linspace(150.0, 100.0, 11)
    return load


def test_forces_stand_in_newtons_and_a_contact_open_at_rest_has_no_ratio():
    pad = elastic_pad(elements=(4, 2), contacts=3, modal_damping=0.01)
    pad = pad.with_(load=pad.load + 2.0 * pad.preloads[2] * pad.normals[:, 2])
    answer = squealing_modes(pad, samples=1, workers=1)
    forces = sliding_forces(pad)
    assert (forces > 0).tolist() == [True, True, False]
    assert answer.sliding_force.values == pytest.approx(forces, rel=1e-9)
    assert answer.peak_normal_force[0].values == pytest.approx(forces, rel=1e-9)
    ratios = np.where(forces > 0, forces / pad.preloads, np.nan)
    assert answer.peak_force[0].values == pytest.approx(ratios, rel=1e-9, nan_ok=True)
    assert _peak_force(answer.isel(attractor=0)) == (
        "a contact is pressed with up to 1.8 times its preload, and the largest force is 479 N"
    )


def test_forces_of_a_quiet_structure_are_those_of_the_whole():
    """A reduction without unstable modes keeps no static responses: its own are off by 4 %."""
    pad = elastic_pad(elements=(10, 3), contacts=4, mu=0.1, modal_damping=0.05)
    reduced, forces = pad.reduce(), sliding_forces(pad)
    assert reduced.record["unstable"] == reduced.record["static_responses"] == 0
    assert np.abs(sliding_forces(reduced) / forces - 1.0).max() > 1e-2
    answer = squealing_modes(reduced, samples=1, workers=1)
    assert answer.sliding_force.values == pytest.approx(forces, rel=1e-9)
    assert answer.peak_normal_force[0].values == pytest.approx(forces, rel=1e-9)


def sliding_forces(structure):
    """Contact forces of steady sliding, N, by trying from all closed on."""
    n, t, k, p = (
        structure.normals,
        structure.tangentials,
        structure.stiffnesses,
        structure.preloads,
    )
    closed = np.ones(len(k), bool)
    for _ in range(50):
        acting = (n + structure.mu * t) * closed
        rubbing = structure.stiffness.toarray() + acting * k @ n.T
        q = la.solve(rubbing, structure.load + acting @ p)
        wrong = np.flatnonzero((p - k * (n.T @ q) > 0) != closed)
        if not wrong.size:
            return np.where(closed, p - k * (n.T @ q), 0.0)
        closed[wrong[0]] ^= True
    raise AssertionError("no steady sliding")


@pytest.mark.release
def test_the_disc_needs_a_fifth_of_the_modes_at_rest():
    """204 modes up to 58 kHz were needed, 38 of them unstable beyond the band."""
    reduced = disc_brake().reduce(frequency_max=5e3)
    assert reduced.size <= 44
    values = growing(reduced.with_common_mu())
    # from an assembly in SciPy of CalculiX's matrices
    truth = 24.940579 + 2j * np.pi * 2851.938816
    assert len(values) == 1
    assert abs(values[0].imag - truth.imag) < 1e-4 * truth.imag
    error = abs(values[0].real - truth.real) / (0.01 * truth.imag)
    assert error == pytest.approx(reduced.record["growth_rate_error"], rel=1e-3)
    assert error < 0.01


@pytest.mark.release
def test_damping_of_modes_beyond_the_band_is_within_the_stated_error():
    """Modes were damped up to the band alone; 0.15 % of an error were not stated."""
    disc = disc_brake(modal_damping=1e-3).with_common_mu()
    reduced = disc.reduce(frequency_max=5e3)
    mass, stiffness, at_rest = (
        each.toarray() for each in (disc.mass, disc.stiffness, disc.stiffness_at_rest)
    )
    n, t, k = disc.normals, disc.tangentials, disc.stiffnesses
    rubbing = stiffness + (n + disc.mu * t) * k @ n.T
    squares, shapes = la.eigh(at_rest, mass)
    to_modes = mass @ shapes
    damper = (to_modes * (2e-3 * np.sqrt(squares))) @ to_modes.T
    # the unstable mode with damping of all modes, by inverse iteration
    kept = growing(reduced)[0]
    s, vector, other = kept, *np.random.default_rng(0).standard_normal((2, disc.size))
    factors = la.lu_factor(mass * s**2 + damper * s + rubbing)
    for _ in range(6):
        vector, other = la.lu_solve(factors, vector), la.lu_solve(factors, other, 2)
        vector, other = vector / la.norm(vector), other / la.norm(other)
    for _ in range(8):
        terms = [other.conj() @ each @ vector for each in (mass, damper, rubbing)]
        s -= np.polyval(terms, s) / np.polyval(np.polyder(terms), s)
    truth = Truth.of(disc, 5e3)
    place = int(np.abs(truth.values - s).argmin())
    assert 1e-4 < abs(truth.values[place].real - s.real) < truth.undamped[place]
    apart = abs(kept.real - s.real) / (0.01 * s.imag)
    assert 0.001 < apart < reduced.record["growth_rate_error"]


def test_a_missing_mode_makes_the_verdict_undetermined_and_is_named():
    """Without it the pad was quiet: in four modes nothing grows, in the whole 45 kHz does."""
    pad = elastic_pad(elements=(10, 3), mu=0.6, modal_damping=0.008)
    answer = squealing_modes(pad.reduce(n_modes=4), samples=1, t_end=1e-3, tol=1e-6)
    truth = growing(pad, 0.008)
    assert Verdict(int(answer.verdict)) is Verdict.undetermined
    lost = (
        answer.missing_growth_rate.values + 2j * np.pi * answer.missing_frequency.values
    )
    assert np.abs(truth - lost[0]).min() < 1e-6 * abs(lost[0])
    enough = int(answer.modes_that_would_do)
    assert pad.reduce(n_modes=enough).record["agrees"]
    said = lines(answer)
    assert said[0].startswith(
        "Undetermined: 1 unstable mode of the whole structure (45.18 kHz"
    )
    assert f"{enough} modes would do: n_modes={enough}." in said[0]
    # no motion of these modes could decide: nothing is run
    assert not answer.sizes["attractor"]
    assert "missing in the 4 modes kept, so nothing was run." in said[0]
    # both remedies work
    band = math.floor(np.abs(lost.imag).min() / (2.0 * np.pi))
    assert said[0].endswith(f"the same modes grow: frequency_max={band}.")
    assert pad.reduce(n_modes=4, frequency_max=band).record["agrees"]
    with pytest.raises(ValueError, match=rf"lack 1 unstable mode .*n_modes={enough} "):
        assess(pad.reduce(n_modes=4))
    # the error of what is shown is that from the whole structure's
    for growth, error in zip(
        answer.growth_rate.values, answer.mode_growth_rate_error.values, strict=True
    ):
        assert np.abs(np.abs(truth.real - growth) - error).min() < 1e-6 * growth
    assert "±" in said[1]
    assert plot(answer).has_data()
    axes = Figure().add_subplot()
    draw_poles(axes, answer)
    (bars,) = axes.containers
    upright = bars.lines[2][1].get_segments()
    assert [np.ptp(bar[:, 1]) / 2.0 for bar in upright] == pytest.approx(
        answer.pole_growth_rate_error.values[np.isfinite(answer.pole_growth_rate_error)]
    )


def test_where_no_number_of_modes_agrees_nothing_is_run_to_be_undetermined():
    """A pad of 49 contacts was run in 196 modes for more than 10 minutes, all for nothing."""
    pad, ratio = random_structure(17)
    answer = squealing_modes(pad, samples=1)
    assert answer.n_modes < answer.modes_that_would_do <= pad.size
    assert answer.attrs["not_run"].endswith(
        f"(n_modes={int(answer.modes_that_would_do)} would do)"
    )
    assert Verdict(int(answer.verdict)) is Verdict.undetermined
    truth = growing(pad, ratio)
    known = len(truth) - answer.sizes["missing"]
    assert 0 < known < len(truth)
    assert np.sort(answer.missing_growth_rate) == pytest.approx(
        np.sort(truth.real[truth.imag > 2 * np.pi * 170e3]), rel=1e-6
    )


def test_modes_beyond_the_band_decide_nothing_about_it():
    """With --n-modes 144 the answer was that 145 would do, again and again."""
    pad = elastic_pad(elements=(16, 4), mu=0.6).reduce(n_modes=18, frequency_max=12e3)
    kept = plant.Plant(pad)
    # modes of the reduced pad that would grow at 43 and 63 kHz are damped
    assert kept.agreement.unsure.tolist() == []
    assert kept.frequencies[kept.unstable] == pytest.approx([10.6e3], rel=1e-3)
    assert pad.record["agrees"]
    assert kept.enough is None
    motion = SimpleNamespace(kind=Kind.cycle, frequency=10.6e3)
    verdict = _verdict(kept, 0, [motion], np.array([Verdict.hammers]))
    assert verdict is Verdict.hammers


def test_a_push_that_ends_beyond_the_band_names_the_band_that_includes_it():
    told = xr.Dataset(
        {
            "verdict": int(Verdict.undetermined),
            "same_modes_grow": True,
            "whole_decays": True,
            "frequency_max": 12e3,
            "frequency": ("mode", [10.61e3, 63.23e3]),
            "mode_is_sure": ("mode", [True, False]),
            "ends_in": ("mode", [0, 0]),
            "pole_growth_rate": ("pole", [5.0]),
            "dominant_frequency": ("attractor", [63e3]),
        },
        {"mode": [2, 17]},
    )
    assert in_options(headline(told)) == (
        "Undetermined: a small push ends at 63 kHz, beyond the band, and the errors leave open "
        "whether the mode at 63.23 kHz grows: --frequency-max 69553 includes it."
    )


def test_a_motion_beyond_the_band_is_marked_and_modes_are_named_by_frequency():
    """A band up to 1 kHz answered "Squeals at 8.5 kHz", and modes had other numbers elsewhere."""
    at = {
        "verdict": int(Verdict.squeals),
        "same_modes_grow": True,
        "whole_decays": False,
        "frequency_max": 1e3,
        "frequency": ("mode", [810.0, 8.9e3]),
        "mode_frequency_error": ("mode", [0.0, 0.0]),
        "mode_growth_rate_error": ("mode", [0.0, 0.0]),
        "growth_rate": ("mode", [3.0, 2.0]),
        "mode_is_sure": ("mode", [True, True]),
        "squeals": ("mode", [False, True]),
        "time_to_squeal": ("mode", [0.1, 0.1]),
        "ends_in": ("mode", [0, 0]),
        "dominant_frequency": ("attractor", [8.5e3]),
        "motion": ("attractor", [int(Verdict.squeals)]),
        "separated_fraction": (("attractor", "contact"), [[0.0]]),
        "stick_fraction": ("attractor", [0.0]),
    }
    told = xr.Dataset(at, {"mode": [2, 17]})
    beyond = "beyond the band (modes up to 1 kHz were compared)"
    assert headline(told) == (
        f"Squeals at 8.5 kHz, {beyond}, nearest to the unstable mode at 8.9 kHz; contact is kept."
    )
    assert [*lines_of_modes(told)] == [
        (
            "The mode at 810 Hz, growth rate 3 1/s, grows within 100 ms into the vibration "
            f"at 8.5 kHz, {beyond}, 949 % above its frequency in small motions; the nearest "
            "unstable mode is at 8.9 kHz."
        ),
        (
            f"The mode at 8.9 kHz, growth rate 2 1/s, {beyond}, squeals: it grows within "
            f"100 ms into the vibration at 8.5 kHz, {beyond}, 4.5 % below its frequency in small "
            "motions."
        ),
    ]
    assert outside(told) == f"Its frequency is {beyond}."
    assert outside(told.assign(frequency_max=9e3)) is None


def test_too_many_contacts_are_told_with_the_modes(monkeypatch):
    monkeypatch.setattr(plant, "Caps", lambda: Caps(modes=32, contacts=16))
    pad = elastic_pad(elements=(16, 1), contacts=17, mu=0.6, modal_damping=0.02)
    answer = squealing_modes(pad, samples=2)
    said = lines(answer)
    assert said[0] == (
        "Undetermined: nothing was run, because 17 contacts are more than the 16 that runs can "
        "have (merge neighbours: `points` of a face, or with_points)."
    )
    assert len(answer.growth_rate) == len(growing(pad, 0.02)) == len(said) - 1


def random_structure(seed, most=400):
    """A pad of other shape, or masses with random springs and dashpots; 50 to 400 freedoms."""
    rng = np.random.default_rng(seed)
    mu, speed = (
        float(rng.uniform(0.2, 0.9)),
        float(rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 8)),
    )
    damping = float(10 ** rng.uniform(-3.3, -1.5))
    if seed % 2:
        columns, rows = int(rng.integers(6, 20)), int(rng.integers(3, 7))
        while 2 * (columns + 1) * (rows + 1) > most:
            columns -= 1
        return elastic_pad(
            length=float(rng.uniform(0.03, 0.12)),
            height=float(rng.uniform(0.008, 0.03)),
            elements=(columns, rows),
            contacts=int(rng.integers(1, 7)),
            young=float(10 ** rng.uniform(9.3, 11.0)),
            contact_stiffness=float(10 ** rng.uniform(8.0, 9.5)),
            mu=mu,
            belt_speed=speed,
            modal_damping=damping,
        ), damping
    size = int(rng.integers(50, most + 1))
    root = rng.standard_normal((size, size)) * (rng.random((size, size)) < 4 / size)
    stiffness = 1e7 * (root @ root.T) + np.diag(10 ** rng.uniform(5, 8, size))
    contacts = [
        Contact(
            f"c{place}",
            {int(n): float(rng.normal()), int(t): float(0.3 * rng.normal())},
            {int(t): float(rng.normal())},
            float(10 ** rng.uniform(6.5, 8.5)),
            float(rng.uniform(50, 500)),
        )
        for place, (n, t) in enumerate(
            rng.permutation(size)[: 2 * int(rng.integers(1, 6))].reshape(-1, 2)
        )
    ]
    return Structure(
        np.diag(rng.uniform(0.05, 0.5, size)),
        stiffness,
        contacts=contacts,
        mu=mu,
        belt_speed=speed,
        modal_damping=damping,
    ), damping


def growing(structure, ratio=0.0):
    """Unstable eigenvalues; None where there is no steady sliding."""
    values = eigenvalues(structure, ratio)
    return None if values is None else values[values.real > 1e-7 * np.abs(values)]


def judge(seed, most=400, up_to=60):
    """Where a reduced structure that claims to agree does not, and where it claims to."""
    structure, ratio = random_structure(seed, most)
    truth = growing(structure, ratio)
    if truth is None:  # no steady sliding was found here: nothing to compare with
        return [], [], -1
    search = Search(structure, Truth.of(structure, None), None)
    wrong, decided = [], []
    for number in range(fewest_modes(structure), min(up_to, structure.size) + 1):
        try:
            reduced = search.structure(number)
        except ValueError as error:
            assert "suffices" in str(error)  # noqa: PT017 (a contact without two directions)
            continue
        if not reduced.record["agrees"]:
            continue
        decided.append(number)
        grows = growing(reduced)
        # as many modes grow, at the same frequencies
        off = np.abs(grows.imag[:, None] - truth.imag)
        same = (
            len(grows) == len(truth)
            and (off.min(0, initial=np.inf) <= 0.11 * truth.imag).all()
        )
        if not same:
            wrong.append(number)
    return wrong, decided, len(truth)


@pytest.mark.parametrize(
    "seed", [3, *(pytest.param(n, marks=pytest.mark.release) for n in range(40))]
)
def test_a_reduced_structure_agrees_with_the_whole_or_says_that_it_does_not(seed):
    wrong, decided, unstable = judge(seed, *((100, 16) if seed == 3 else ()))
    assert not wrong
    assert decided or unstable  # what grows above all modes kept is not decided


def test_remedies_are_in_the_words_of_the_terminal():
    assert (
        in_options("12 modes would do: n_modes=12.")
        == "12 modes would do: --n-modes 12."
    )
    assert in_options("give frequency_max (Hz)") == "give --frequency-max (Hz)"
    assert in_options("t_end = 1e-05: 4 periods") == "--t-end 1e-05: 4 periods"


def test_motions_as_near_as_two_windows_of_one_are_one_attractor():
    """Runs 2.5 % apart were two, though windows of one motion may differ by 3 %."""

    def run(loss):
        levels = SimpleNamespace(
            velocities=np.array([1.0, 0.1]),
            total=1.005,
            separated=np.array([loss]),
            stuck=np.zeros(1),
        )
        last = SimpleNamespace(levels=lambda _: levels)
        return SimpleNamespace(agrees=True, quiet=False, change=1e-3, last=last)

    assert grouped([run(0.3), run(0.325), run(0.5)], 0).tolist() == [0, 0, 1]


def test_a_reduced_structure_can_be_reduced_again_and_has_modes():
    once = elastic_pad(contacts=2, elements=(4, 2)).reduce(n_modes=8)
    twice = once.reduce(n_modes=4)
    assert once.mesh is not None
    assert twice.mesh is None
    np.testing.assert_allclose(
        twice.complex_modes(mu=0.0).frequency,
        once.complex_modes(mu=0.0).frequency[:4],
        rtol=1e-3,
    )


@pytest.mark.release
def test_a_number_of_modes_alone_is_refused_of_a_large_structure_with_a_band_that_works():
    """The refusal asked for a band, and left open which one these modes can answer for."""
    block = elastic_block((12, 5, 4), contacts=4, modal_damping=0.01)
    assert block.size == 1170
    with pytest.raises(ValueError, match=r"beside n_modes = 20, whose highest") as told:
        block.reduce(n_modes=20)
    band = float(str(told.value).rsplit("frequency_max = ", 1)[1])
    reduced = block.reduce(n_modes=20, frequency_max=band)
    assert reduced.record["agrees"]
    kept = reduced.complex_modes(critical=False).frequency.values
    whole = block.complex_modes(frequency_max=band, critical=False).frequency.values
    assert kept[: len(whole)] == pytest.approx(whole, rel=0.02)
    assert band < kept.max()


def test_of_many_contacts_those_that_are_open_most_are_named():
    """A line of the terminal named 18 contacts, 14 of them open 0 % of the time."""
    names = [f"lining_{number}" for number in range(1, 19)]
    shares = np.zeros(18)
    shares[[8, 10, 16, 17]] = 0.01, 0.06, 0.06, 0.1
    one = xr.Dataset({"separated_fraction": ("contact", shares)}, {"contact": names})
    assert _of_contacts(one) == (
        "lining_18 10 %, lining_11 6 %, lining_17 6 %, lining_9 1 %, 14 others at most 1 %"
    )
    assert _of_contacts(one.isel(contact=[0, 10])) == "lining_1 0 %, lining_11 6 %"


@pytest.mark.parametrize("n_modes", [5, pytest.param(7, marks=pytest.mark.release)])
def test_damping_that_stops_growth_is_that_of_the_whole_where_the_reduced_one_misses_it(
    n_modes,
):
    """Modes that are run need 13 to 22 % less; all eigenvalues come from LAPACK here."""
    pad = elastic_pad(elements=(12, 3))
    reduced = pad.reduce(n_modes=n_modes, frequency_max=60e3)
    ratio, outcome = added_damping(plant.Plant(reduced))
    assert outcome == Outcome.converged
    # the disc brake's modes need more than the whole
    growth = growth_in_band(reduced.reduced_from)
    from_above = located_near(growth, 1.1 * ratio, growth(0.0))
    assert from_above == pytest.approx(ratio, rel=0.01)

    springs = pad.normals * pad.stiffnesses
    stiffness = pad.stiffness.toarray()
    square, shapes = la.eigh(stiffness + springs @ pad.normals.T, pad.mass.toarray())
    friction = (pad.tangentials * pad.stiffnesses * pad.mu) @ pad.normals.T
    restoring = shapes.T @ (stiffness + springs @ pad.normals.T + friction) @ shapes

    def fastest(ratio):
        damping = np.diag(2.0 * ratio * np.sqrt(square))
        rest, unit = np.zeros_like(damping), np.eye(len(damping))
        values = la.eigvals(np.block([[rest, unit], [-restoring, -damping]]))
        return values[np.abs(values.imag) < 2.0 * np.pi * 60e3].real.max()

    assert fastest(1.01 * ratio) < 0.0 < fastest(0.99 * ratio)
