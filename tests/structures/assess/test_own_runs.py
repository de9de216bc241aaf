"""Random structures against own eigenvalues and own event-driven runs, in other units."""

from dataclasses import replace

import numpy as np
import pytest

from squealpipe import Contact, Structure, assess, labels
from squealpipe.structures.assess.assess import judge_structure
from tests.oracles.structure_answers import Motion

CURES = ("mu", "modal_damping", "contact_stiffness", "preload", "weight")


def drawn(seed):
    """A random structure in SI, the same in units of order 1, and these units (s, N, m)."""
    draw = np.random.default_rng([650, seed])
    size = int(draw.integers(2, 13))
    count = int(draw.integers(1, min(4, size // 2) + 1))
    a, b = draw.standard_normal((2, size, size)) / np.sqrt(size)
    time, force, length = (
        10.0 ** draw.uniform(low, high) for low, high in ((-4, 0), (0, 3), (-4, 0))
    )
    stiffness = force / length
    damping = 0.01 * draw.uniform(0.3, 2.0)
    contacts = []
    for place in range(count):
        normal, along = draw.standard_normal((2, size))
        speed = float(draw.choice([-1.0, 1.0], p=[0.2, 0.8]) * draw.uniform(0.7, 1.3))
        springs, preload = draw.uniform(0.5, 8), draw.uniform(20, 40)
        contacts.append(
            Contact(f"c{place}", normal, along, springs, preload, speed=speed)
        )
    mu = float(draw.uniform(0.2, 0.7))
    belt = float(draw.choice([-1, 1]) * draw.uniform(5, 20.0))
    load = None if draw.random() < 0.7 else 0
    common = {"modal_damping": damping, "mu": mu, "load": load}
    mass, springs = a @ a.T + 0.5 * np.eye(size), 10 * b @ b.T + np.eye(size)
    plain = Structure(mass, springs, contacts=contacts, belt_speed=belt, **common)
    scaled = Structure(
        mass * stiffness * time**2,
        springs * stiffness,
        contacts=[
            replace(
                each, stiffness=each.stiffness * stiffness, preload=each.preload * force
            )
            for each in contacts
        ],
        belt_speed=belt * length / time,
        **common,
    )
    return scaled, plain, (time, force, length)


def changed(plain, name, value):
    """The structure with one cure, in units of order 1."""
    if name in ("mu", "modal_damping"):
        return plain.with_(**{name: value})
    if name == "weight":
        mass = plain.mass.toarray()
        mass[0, 0] += value
        return plain.with_(mass=mass)
    key = "stiffness" if name == "contact_stiffness" else "preload"
    contacts = [
        replace(each, **{key: value * getattr(each, key)}) for each in plain.contacts
    ]
    return plain.with_(contacts=contacts)


def check_motion(answer, own, time, length):
    """Verdict, level, shares and frequency agree within 1 % and the stated errors."""
    assert labels(answer.verdict).item() == own["verdict"]
    if own["verdict"] == "quiet":
        return
    names = {
        "along": "velocity_rms_along",
        "across": "velocity_rms_across",
        "open": "separated_fraction",
        "stick": "stick_fraction",
    }
    for key, name in names.items():
        unit = length / time if name.startswith("velocity") else 1.0
        value = answer[name].item() / unit
        error = 2.0 * (answer[f"{name}_error"].item() / unit + own[f"{key}_error"])
        assert abs(value - own[key]) <= 0.01 * abs(value) + error + 2e-3, name
    frequency = answer.frequency.item() * time
    allowed = 0.01 * frequency + 2.0 * answer.frequency_error.item() * time
    assert min(abs(frequency - each) for each in own["frequencies"]) <= allowed


def test_level_and_frequency_of_a_structure_that_hammers():
    scaled, plain, (time, _, length) = drawn(15)
    answer = judge_structure(scaled, samples=0, seed=0, tol=1e-12, workers=1)
    check_motion(answer.without_cures(), Motion(plain).answer(), time, length)


@pytest.mark.release
@pytest.mark.parametrize(
    "seed", [10, 15, *(pytest.param(seed, marks=pytest.mark.long) for seed in (0, 11))]
)
def test_all_quiet_intervals_on_both_sides_at_one_per_cent(seed):
    scaled, plain, (time, force, length) = drawn(seed)
    most = 2.0 * scaled.mass[0, 0]
    answer = assess(
        scaled,
        modifications={"weight": {"added_mass": {0: most}}},
        samples=4,
        workers=1,
    )
    check_motion(answer, Motion(plain).answer(), time, length)
    boundaries = 0
    for name in CURES:
        row = answer.sel(cure=name)
        unit = force / length * time**2 if name == "weight" else 1.0
        low, high = (row[f"{end}est_tried"].item() / unit for end in ("low", "high"))
        ends = np.stack([row.quiet_low.values, row.quiet_high.values], 1) / unit
        ends = ends[np.isfinite(ends[:, 0])]
        inner = [
            end for end in ends.ravel() if low < end * 0.999 and end * 1.001 < high
        ]
        boundaries += len(inner)
        for value in (side * end for end in inner for side in (0.99, 1.01)):
            told = bool(((ends[:, 0] <= value) & (value <= ends[:, 1])).any())
            own = Motion(changed(plain, name, value))
            quiet = own.growth <= 0.0 and own.answer()["verdict"] == "quiet"
            assert told == quiet, (name, value)
        for value in np.linspace(low, high, 30):
            told = bool(((ends[:, 0] <= value) & (value <= ends[:, 1])).any())
            assert not (told and Motion(changed(plain, name, value)).growth > 1e-9)
    assert boundaries >= 3
