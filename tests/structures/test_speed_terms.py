"""Gyroscopic, centrifugal and other parts that change with speed, against own first-order forms."""

import numpy as np
import pytest
import scipy.linalg as la
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from squealpipe import Contact, Structure
from squealpipe.cli.structures import say_doubts
from squealpipe.structures import Rotation
from squealpipe.structures.files import read
from squealpipe.structures.schema.structures import SpeedOnset
from squealpipe.structures.sliding import another_sliding


class Rotor:
    """A random structure with a contact and every sort of speed term.

    Args:
        reference: Ω₀ of the terms.
    """

    def __init__(self, seed, size=5, reference=2.0):
        generator = np.random.default_rng([64, 2, seed])
        a, b, c, d = generator.standard_normal((4, size, size))
        self.mass = a @ a.T / size + np.eye(size)
        self.stiffness = b @ b.T + 5 * np.eye(size)
        self.damping = 0.02 * np.eye(size)
        self.gyroscopic, self.centrifugal = c - c.T, d @ d.T / 4
        self.turning = 0.05 * np.eye(size) + 0.01 * c
        self.normal, self.tangential = generator.standard_normal((2, size))
        self.reference, self.size = reference, size

    def terms(self):
        return {
            "damping": [(self.gyroscopic, 1), (self.turning, -1)],
            "stiffness": [(self.centrifugal, 2), (0.1 * np.eye(self.size), 0)],
        }

    def structure(self, **further):
        contact = Contact("c", self.normal, self.tangential, 3.0, 10.0)
        return Structure(
            self.mass, self.stiffness, self.damping, contacts=[contact], mu=0.3,
            speed_terms=self.terms(), **further,
        )  # fmt: skip

    def first_order(self, speed, mu=0.3):
        ratio, size = speed / self.reference, self.size
        acting = self.normal + mu * np.sign(speed) * self.tangential
        stiffness = self.stiffness + self.centrifugal * ratio**2 + 0.1 * np.eye(size)
        stiffness = stiffness + 3.0 * np.outer(acting, self.normal)
        damping = self.damping + self.gyroscopic * ratio + self.turning / ratio
        lower = [-la.solve(self.mass, stiffness), -la.solve(self.mass, damping)]
        first = np.block([[np.zeros((size, size)), np.eye(size)], lower])
        rest = la.solve(stiffness, 10.0 * (acting - self.normal))
        return first, rest

    def values(self, speed):
        values = la.eigvals(self.first_order(speed)[0])
        return np.sort_complex(values[values.imag > 0])


@pytest.mark.parametrize("seed", range(3))
def test_modes_at_any_speed_and_direction(seed):
    rotor = Rotor(seed)
    modes = rotor.structure(belt_speed=2.0).complex_modes(
        belt_speed=[-7.0, -1.0, 0.5, 2.0, 9.0], critical=False
    )
    for speed in modes.belt_speed.values:
        at = modes.sel(belt_speed=speed)
        ours = at.growth_rate.values + 2j * np.pi * at.frequency.values
        assert np.allclose(np.sort_complex(ours[ours.imag > 0]), rotor.values(speed))


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.release)])
def test_critical_speeds_are_where_growth_passes_zero(seed):
    located = 0
    rotor = Rotor(seed)
    modes = rotor.structure(belt_speed=2.0).complex_modes(
        belt_speed=np.linspace(0.4, 12.0, 6)
    )
    for speed, onset in zip(
        modes.critical_speed.values, modes.speed_onset.values, strict=True
    ):
        assert onset != SpeedOnset.not_followed
        if onset in (SpeedOnset.stable, SpeedOnset.unstable_throughout):
            assert np.isnan(speed)
            continue
        located += 1
        # two eigenvalues, a conjugate pair, change sides
        below, above = (
            int((rotor.values(speed * side).real > 0).sum())
            for side in (1 - 1e-7, 1 + 1e-7)
        )
        assert above - below == (1 if onset == SpeedOnset.turns_unstable else -1)
    assert located >= 2


def test_a_mode_that_grows_only_between_the_speeds_asked_for_is_no_stable_one():
    """Damping 0.01 (Ω − 2.5 + 1/Ω) vanishes at 0.5 and 2; its tangents at both ends meet below."""
    along = np.diag([0.01, 0.0])
    structure = Structure(
        np.eye(2),
        np.diag([40.0, 90.0]),
        np.diag([-0.025, 0.1]),
        contacts=[Contact("c", {1: 1.0}, {0: 1.0}, 3.0, 10.0)],
        mu=0.0,
        belt_speed=1.0,
        speed_terms={"damping": [(along, 1), (along, -1)]},
    )
    for speeds in ([0.3, 4.0], [0.3, 0.4, 3.0]):
        modes = structure.complex_modes(belt_speed=speeds)
        assert modes.speed_onset.values.tolist() == [
            SpeedOnset.turns_unstable,
            SpeedOnset.stable,
        ]
        assert float(modes.critical_speed[0]) == pytest.approx(0.5, rel=1e-9)


def test_a_falling_friction_stops_feeding_a_mode_at_a_speed():
    """m q̈ + (c + N μ′(V)) q̇ + k q: unstable below the speed at which N |μ′| = c."""
    contact = Contact("c", {1: 1.0}, {0: 1.0}, stiffness=1.0, preload=10.0)
    structure = Structure(
        np.eye(2), np.diag([4.0, 9.0]), np.diag([0.2, 0.2]), contacts=[contact], mu=0.2,
        friction_law="exponential", mu_static=0.5, friction_speed=2.0,
    )  # fmt: skip
    modes = structure.complex_modes(belt_speed=[0.1, 1.0, 4.0, 9.0, 12.0])
    turns = modes.speed_onset == SpeedOnset.turns_stable
    assert turns.sum() == 1
    expected = brentq(lambda v: 10.0 * 0.15 * np.exp(-v / 2.0) - 0.2, 0.1, 12.0)
    assert float(modes.critical_speed.where(turns).max()) == pytest.approx(
        expected, rel=1e-9
    )
    # backwards the speed rises towards 0, and the mode turns unstable on the way
    modes = structure.complex_modes(belt_speed=[-12.0, -9.0, -4.0, -1.0, -0.1])
    turns = modes.speed_onset == SpeedOnset.turns_unstable
    assert turns.sum() == 1
    assert float(modes.critical_speed.where(turns).max()) == pytest.approx(
        -expected, rel=1e-9
    )


def test_a_reduced_structure_turns_at_any_speed():
    rotor = Rotor(1)
    reduced = rotor.structure(belt_speed=2.0).reduce(n_modes=rotor.size)
    for other in (reduced, reduced.with_(belt_speed=9.0)):
        modes = other.complex_modes(belt_speed=9.0, critical=False)
        ours = modes.growth_rate.values + 2j * np.pi * modes.frequency.values
        assert np.allclose(np.sort_complex(ours[ours.imag > 0]), rotor.values(9.0))


def test_runs_turn_at_any_speed():
    rotor = Rotor(2)
    system = rotor.structure(belt_speed=2.0).system()
    first, rest = rotor.first_order(5.0)
    push = 1e-3 * np.arange(1.0, rotor.size + 1)
    start = {f"q{i}": each for i, each in enumerate(rest + push, 1)}
    run = system.simulate(2.0, start=start, belt_speed=5.0)
    state = np.concatenate([push, np.zeros(rotor.size)])
    end = la.expm(first * float(run.time[-1])) @ state
    found = np.array([run[f"q{i}"].values[-1] for i in range(1, rotor.size + 1)])
    assert np.allclose(found, rest + end[: rotor.size], atol=1e-9)
    # side by side with another speed, whose matrices are others
    both = system.ensemble(
        2.0, start=start, belt_speed=[3.0, 5.0], mu=[0.1, system.parameters["mu"]]
    )
    last = both.isel(belt_speed=1, mu=1)
    ends = [float(last[f"q{i}"]) for i in range(1, rotor.size + 1)]
    assert ends == pytest.approx(found, rel=1e-13)


def test_with_a_rotation_speeds_are_in_rad_per_s():
    rotor = Rotor(0, reference=20.0)
    structure = rotor.structure(rotation=Rotation(speed=20.0))
    assert structure.belt_speed == 20.0
    modes = structure.complex_modes(belt_speed=["300 rpm", "30 rad/s"])
    assert modes.belt_speed.attrs["units"] == "rad s-1"
    assert modes.critical_speed.attrs["units"] == "rad s-1"
    assert np.allclose(modes.belt_speed, [10 * np.pi, 30.0])
    for speed in modes.belt_speed.values:
        at = modes.sel(belt_speed=speed)
        ours = at.growth_rate.values + 2j * np.pi * at.frequency.values
        assert np.allclose(np.sort_complex(ours[ours.imag > 0]), rotor.values(speed))


REFUSED = {
    "speed 0": (lambda s: s.complex_modes(belt_speed=[0.0, 1.0]), "power -1 has no value"),
    "a kind": (lambda s: s.with_(speed_terms={"dampng": []}), "did you mean 'damping'"),
    "no power": (lambda s: s.with_(speed_terms={"damping": [(np.eye(5),)]}), "no pair"),
    "a half": (lambda s: s.with_(speed_terms={"damping": [(np.eye(5), 0.5)]}), "whole number"),
    "a size": (lambda s: s.with_(speed_terms={"damping": [(np.eye(4), 1)]}), "mass is 5 × 5"),
    "no list": (lambda s: s.with_(speed_terms={"damping": np.eye(5)}), "a list of pairs"),
    "at rest": (
        lambda s: s.with_(belt_speed=0.0, speed_terms={"damping": [(np.eye(5), 1)]}),
        "Ω₀ at which their matrices hold is 0",
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSED)
def test_what_has_no_value_is_refused(what):
    call, words = REFUSED[what]
    with pytest.raises(ValueError, match=words):
        call(Rotor(0).structure())


def test_terms_from_a_file(tmp_path):
    """Also in mm, t and s, where all matrices are a thousand times smaller."""
    rotor = Rotor(3)
    parts = {
        "M": rotor.mass, "K": rotor.stiffness, "C": rotor.damping,
        "G": rotor.gyroscopic, "T": rotor.turning, "Z": rotor.centrifugal,
    }  # fmt: skip
    for name, matrix in parts.items():
        np.save(tmp_path / f"{name}.npy", matrix / 1e3)
    (tmp_path / "s.yaml").write_text("""
units: mm-t-s
mass: M.npy
stiffness: K.npy
damping: C.npy
triangle: keep
belt_speed: 2000
speed_terms:
  damping: [{matrix: G.npy, power: 1}, {matrix: T.npy, power: -1, factor: 1.0}]
  stiffness: [{matrix: Z.npy, power: 2, factor: 0.5}, {matrix: Z.npy, power: 2, factor: 0.5}]
""")
    structure = read(tmp_path / "s.yaml", Structure)
    given = Structure(
        rotor.mass, rotor.stiffness, rotor.damping, belt_speed=2.0,
        speed_terms={
            "damping": [(rotor.gyroscopic, 1), (rotor.turning, -1)],
            "stiffness": [(rotor.centrifugal, 2)],
        },
    )  # fmt: skip
    for speed in (-3.0, 0.7):
        one, other = structure.at_speed(speed), given.at_speed(speed)
        assert np.allclose(one.stiffness.toarray(), other.stiffness.toarray())
        assert np.allclose(one.damping.toarray(), other.damping.toarray())
    (tmp_path / "t.yaml").write_text(
        "mass: M.npy\nstiffness: K.npy\nspeed_terms: {damping: [{matrix: G.npy}]}\n"
    )
    with pytest.raises(ValueError, match="matrix and power are needed"):
        read(tmp_path / "t.yaml", Structure)


@pytest.mark.parametrize("speed", [0.6, 0.9, 1.2])
def test_softening_has_a_second_state_with_an_open_contact_and_it_is_told(
    speed, capsys
):
    """From 0.84 m/s on; modes said that the state near the contact is stable, and no more."""
    softening, load, contact = 1.0, -1.0, Contact("pad", {1: 1.0}, {0: 1.0}, 3.0, 1.0)
    structure = Structure(
        np.eye(2), np.diag([1.0, 0.7]), modal_damping=0.02, contacts=[contact], mu=0.3,
        belt_speed=1.0, load=[0.0, load],
        speed_terms={"stiffness": [(-softening * np.diag([0.0, 1.0]), 2)]},
    ).at_speed(speed)  # fmt: skip
    stiffness = 0.7 - softening * speed**2
    # by hand: away from the contact, beyond where its force ends
    apart = load / stiffness
    exists = apart > contact.compression
    assert exists == (speed > 0.84)
    forces = another_sliding(structure)
    say_doubts(structure)
    told = capsys.readouterr().out
    if not exists:
        assert forces is None
        assert not told
        return
    assert forces == pytest.approx([0.0], abs=1e-12)
    assert "contact forces are pad 0 N" in told

    # a mass there runs away or comes back to the contact, as another integrator has it
    def field(_, now):
        normal = max(contact.preload - contact.stiffness * now[0], 0.0)
        return now[1], load + normal - stiffness * now[0] - 0.1 * now[1]

    closed = (load + contact.preload) / (stiffness + contact.stiffness)
    near, beyond = (
        solve_ivp(field, (0.0, 60.0), (share * apart, 0.0), rtol=1e-9).y[0, -1]
        for share in (0.99, 1.01)
    )
    assert near == pytest.approx(closed, abs=0.05 * apart)
    assert beyond > 10.0 * apart
