"""Random structures against own eigenvalues and own event-driven runs, in other units."""

from dataclasses import replace

import numpy as np
import pytest

from squealpipe import Contact, Structure, assess, labels
from squealpipe.structures.assess.assess import judge_structure
from squealpipe.structures.assess.cures import cures_of
from tests.oracles.falling_friction import FallingMotion, table_of
from tests.oracles.structure_answers import Motion
from tests.oracles.written import written

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


def text_of(knots, values, unit=1.0, of_values=1.0):
    """A table as structures take it, in units."""
    pairs = zip((knots * unit).tolist(), (values * of_values).tolist(), strict=True)
    return "linear " + " ".join(f"{knot!r}:{value!r}" for knot, value in pairs)


def drawn_friction(draw):
    """A law with its coefficient and limit of stick, or knots and values of a table."""
    law = str(draw.choice(["coulomb", "exponential", "hyperbolic", "table"]))
    mu = float(draw.uniform(0.15, 0.6))
    if law != "table":
        least, most = (1.05, 1.6) if law == "coulomb" else (1.1, 1.8)
        return law, mu, mu * float(draw.uniform(least, most))
    speeds = np.append(0.0, np.sort(draw.uniform(1, 30, 3))) + 0.5 * np.arange(4)
    values = mu * np.sort(draw.uniform(1.0, 1.6, 4))[::-1]
    limit = None
    if draw.random() < 0.5:
        limit = float(values[0] * draw.uniform(1.0, 1.3))
    return (speeds, values), None, limit


def falling(seed):
    """As ``drawn``, with friction that falls and limits of stick, and tables of force."""
    draw = np.random.default_rng([651, seed])
    size = int(draw.integers(2, 13))
    count = int(draw.integers(1, min(4, max(size // 2, 1)) + 1))
    a, b = draw.standard_normal((2, size, size)) / np.sqrt(size)
    units = [
        10.0 ** draw.uniform(low, high) for low, high in ((-4, 0), (0, 3), (-4, 0))
    ]
    damping = 0.01 * draw.uniform(0.3, 2.0)
    draw.uniform(0.2, 0.6)
    belt = float(draw.choice([-1, 1]) * draw.uniform(3, 15.0))
    falls_over = float(draw.uniform(2, 12))
    common, rows = drawn_friction(draw), []
    for place in range(count):
        ways = draw.standard_normal((2, size))
        speed = float(draw.choice([-1.0, 1.0], p=[0.25, 0.75]) * draw.uniform(0.7, 1.3))
        springs, preload = float(draw.uniform(0.5, 8)), float(draw.uniform(20, 40))
        own = drawn_friction(draw) if place and draw.random() < 0.5 else None
        table = None
        if draw.random() < 0.25:
            knots = np.append(0.0, np.cumsum(draw.uniform(1, 5, 2)))
            knots = np.append(knots, knots[-1] + 5.0)
            slopes = np.sort(springs * draw.uniform(0.5, 1.8, 3))
            table = knots, np.append(0.0, np.cumsum(slopes * np.diff(knots)))
        rows.append((ways, speed, springs, preload, own, table))
    load = None if draw.random() < 0.7 else 0

    def friction(drawn, speed_unit):
        law, mu, limit = drawn
        if not isinstance(law, str):
            law = text_of(*law, speed_unit)
        return {"friction_law": law, "mu": mu, "mu_static": limit}

    def made(time, force, length):
        stiffness, speed_unit = force / length, length / time
        contacts = [
            Contact(
                f"c{place}",
                *ways,
                None if table else springs * stiffness,
                preload * force,
                speed=speed,
                law=text_of(*table, length, force) if table else None,
                **(friction(own, speed_unit) if own else {}),
            )
            for place, (ways, speed, springs, preload, own, table) in enumerate(rows)
        ]
        return Structure(
            (a @ a.T + 0.5 * np.eye(size)) * stiffness * time**2,
            (10 * b @ b.T + np.eye(size)) * stiffness,
            modal_damping=damping,
            contacts=contacts,
            belt_speed=belt * speed_unit,
            load=load,
            friction_speed=falls_over * speed_unit,
            **friction(common, speed_unit),
        )

    return made(*units), made(1.0, 1.0, 1.0), units


def changed(plain, name, value):
    """The structure with one cure, in units of order 1."""
    if name in ("mu", "modal_damping"):
        return plain.with_(**{name: value})
    if name == "weight":
        mass = plain.mass.toarray()
        mass[0, 0] += value
        return plain.with_(mass=mass)
    key = "stiffness" if name == "contact_stiffness" else "preload"
    contacts = []
    for each in plain.contacts:
        change = {key: value * getattr(each, key)} if getattr(each, key) else {}
        if each.law and key == "stiffness":
            knots, forces, _ = table_of(each.law)
            change = {"law": text_of(knots, forces, 1.0, value)}
        contacts.append(replace(each, **change))
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


@written
def answer_apart(seed):
    """What own runs say of a structure."""
    return Motion(drawn(seed)[1]).answer()


def test_level_and_frequency_of_a_structure_that_hammers():
    scaled, _, (time, _, length) = drawn(15)
    answer = judge_structure(scaled, samples=0, seed=0, tol=1e-12, workers=1)
    check_motion(answer.without_cures(), answer_apart(15), time, length)


def check_answer(scaled, plain, units, motion):
    """Compare all that is told with own eigenvalues and runs; return the number of boundaries."""
    time, force, length = units
    most = 2.0 * scaled.mass[0, 0]
    answer = assess(
        scaled,
        modifications={"weight": {"added_mass": {0: most}}},
        samples=4,
        workers=1,
    )
    check_motion(answer, motion(plain).answer(), time, length)
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
        tried = [
            value
            for value in (side * end for end in inner for side in (0.99, 1.01))
            if low <= value <= high
        ]
        for value in tried:
            told = bool(((ends[:, 0] <= value) & (value <= ends[:, 1])).any())
            own = motion(changed(plain, name, value))
            quiet = own.growth <= 0.0 and own.answer()["verdict"] == "quiet"
            assert told == quiet, (name, value)
        for value in np.linspace(low, high, 30):
            told = bool(((ends[:, 0] <= value) & (value <= ends[:, 1])).any())
            assert not (told and motion(changed(plain, name, value)).growth > 1e-9)
    return boundaries


@pytest.mark.release
@pytest.mark.parametrize(
    "seed", [10, *(pytest.param(seed, marks=pytest.mark.long) for seed in (0, 11, 15))]
)
def test_all_quiet_intervals_on_both_sides_at_one_per_cent(seed):
    assert check_answer(*drawn(seed), Motion) >= 3


@pytest.mark.release
@pytest.mark.parametrize(
    "seed", [24, *(pytest.param(seed, marks=pytest.mark.long) for seed in (0, 1, 23))]
)
def test_all_quiet_intervals_where_friction_falls(seed):
    """Stick–slip with losses of contact; a measured law; contacts with own laws and tables."""
    assert check_answer(*falling(seed), FallingMotion) >= 1


@pytest.mark.release
def test_the_last_motion_beside_sliding_ends_where_own_runs_do():
    """Damping at which a push dies out leaves a motion, up to a fifth more damping."""
    plain = falling(26)[1]
    judged = judge_structure(plain, samples=4, seed=1, tol=1e-12, workers=1)
    row = judged.with_cures().sel(cure="modal_damping")
    push, end = float(row.quiet_from), float(row.quiet_from_any_start)
    assert end > 1.1 * push
    states, (cures, _) = judged.motions, cures_of(judged.design, {})
    for value in np.linspace(cures["modal_damping"].value, 0.98 * end, 12):
        design = cures["modal_damping"].apply(float(value))
        runs = judged.family.settle(judged.family.starts(design, 0, states))
        states = [run.last.final for run in runs if run.lasts]
    for share, lasts in ((0.98, True), (1.02, False)):
        own = FallingMotion(changed(plain, "modal_damping", share * end), states[0])
        period = 2.0 * np.pi / own.omega.min()
        own.run(400.0 * period)
        late = own.run(20.0 * period, own.step)["samples"]
        assert bool(np.ptp(late, axis=0).max() > 0.1) is lasts
