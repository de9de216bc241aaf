"""Operating points of two degrees of freedom, against eigenvalues that are written down here."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import scipy.sparse

from squealpipe import Contact, Structure, load, operating_map, plot, save
from squealpipe.codes import Verdict
from squealpipe.structures.assess.assess import judge_structure
from squealpipe.structures.assess.measured import matched, read_noises
from squealpipe.structures.assess.operating_points import _share
from squealpipe.structures.assess.operating_units import OperatingUnits
from squealpipe.structures.contact import PointOrigin
from squealpipe.structures.schema.operating_map import Match
from squealpipe.study.chunks import Chunks
from squealpipe.study.report.operating import lines as words
from squealpipe.study.sweep import joined, planned, run_sweep
from squealpipe.systems.inputs.words import percent

STIFFNESS = 6e6
UNITS = OperatingUnits("m s-1", np.nan)
ROD = np.array([[1.2e7, -1.0e6], [-1.0e6, 8.0e6]])


def structure():
    contact = Contact("pad", {1: 1.0}, {0: 1.0}, STIFFNESS, 3000.0)
    return Structure(
        0.5 * np.eye(2), ROD, 80.0 * np.eye(2), contacts=[contact], mu=0.5, load=0
    )


def growth(mu, direction):
    stiffness = ROD + STIFFNESS * np.array([[0.0, direction * mu], [0.0, 1.0]])
    state = np.block(
        [[np.zeros((2, 2)), np.eye(2)], [-2.0 * stiffness, -160.0 * np.eye(2)]]
    )
    return np.linalg.eigvals(state).real.max()


@pytest.fixture(scope="module")
def points():
    return operating_map(
        structure(),
        pressure=[1.0, 2.0],
        speed=[-2.0, 2.0, 4.0],
        mu=[0.05, 0.6],
        workers=1,
    )


def test_each_band_is_told_with_its_share_of_all_points(points):
    noisy = points.frequency.values[np.isfinite(points.frequency.values)]
    bands = np.rint(10.0 * np.log10(noisy / 1000.0))
    told = [line for line in words(points) if "  band at " in line]
    assert [line.split(": ")[1] for line in told] == [
        f"{percent((bands == band).sum() / points.verdict.size)} of all points"
        for band in np.unique(bands)
    ]


def test_growth_and_verdicts_are_those_of_own_eigenvalues(points):
    for speed in (-2.0, 2.0, 4.0):
        for mu in (0.05, 0.6):
            at = points.sel(speed=speed, mu=mu)
            truth = growth(mu, np.sign(speed))
            assert at.growth_rate.values == pytest.approx(truth, rel=1e-6)
            assert ((at.verdict == Verdict.quiet).values == (truth < 0)).all()
            assert (np.isfinite(at.frequency).values == (truth > 0)).all()


def test_twice_the_pressure_and_speed_is_twice_as_loud_at_one_frequency(points):
    """The equations are homogeneous in the preload and the speed together."""
    one = points.sel(pressure=1.0, speed=2.0, mu=0.6)
    two = points.sel(pressure=2.0, speed=4.0, mu=0.6)
    assert float(one.velocity_rms) > 0.0
    assert float(two.velocity_rms) == pytest.approx(
        2.0 * float(one.velocity_rms), rel=1e-3
    )
    assert float(two.frequency) == pytest.approx(float(one.frequency), rel=1e-4)
    assert int(two.verdict) == int(one.verdict)


@pytest.mark.parametrize("mu", [0.05, 0.6])
def test_a_point_has_the_answer_of_assess(points, mu):
    at = points.sel(pressure=2.0, speed=-2.0, mu=mu)
    same_as_assess(at, structure().with_(mu=mu, belt_speed=-2.0), 2.0)


@pytest.mark.release
def test_a_point_with_two_motions_has_the_answer_of_assess():
    """Another tolerance ends in another motion here: 17.1 and 16.1 m/s."""
    draw = np.random.default_rng([77, 0])
    a, b = draw.standard_normal((2, 6, 6)) / np.sqrt(6)
    contacts = [
        Contact(
            name,
            *draw.standard_normal((2, 6)),
            float(draw.uniform(2, 8)),
            float(draw.uniform(20, 40)),
            speed=float(draw.choice([-1, 1]) * draw.uniform(0.7, 1.3)),
        )
        for name in ("c0", "c1")
    ]
    brake = Structure(
        a @ a.T + 0.5 * np.eye(6),
        10 * b @ b.T + np.eye(6),
        modal_damping=0.012,
        contacts=[contacts[0], replace(contacts[1], mu=0.3, mu_static=0.36)],
        mu=0.2,
        mu_static=0.9,
        friction_law="exponential",
        friction_speed=6.0,
        belt_speed=8.0,
    )
    at = operating_map(brake, workers=1).squeeze()
    assert float(at.velocity_rms) > 1.0
    same_as_assess(at, brake, 1.0)


def same_as_assess(at, pad, pressure):
    contacts = [replace(each, preload=pressure * each.preload) for each in pad.contacts]
    pressed = pad.with_(contacts=contacts)
    judged = judge_structure(pressed, samples=0, seed=0, tol=1e-12, workers=1)
    answer = judged.without_cures()
    for name in ("verdict", "frequency", "frequency_error", "separated_fraction"):
        assert np.array_equal(at[name], answer[name], equal_nan=True), name
    directions = answer.velocity_rms_along, answer.velocity_rms_across
    assert float(at.velocity_rms) == np.hypot(*directions)
    assert float(at.velocity_rms_error) <= sum(
        float(answer[f"velocity_rms_{name}_error"]) for name in ("along", "across")
    )


def test_occurrence_adds_up_to_the_share_of_noisy_points(points, tmp_path):
    noisy = np.isfinite(points.frequency.values)
    assert float(points.occurrence.sum()) == pytest.approx(noisy.mean())
    assert float(points.share_noisy) == noisy.mean()
    for frequency in points.frequency.values[noisy]:
        away = np.abs(np.log10(frequency / points.band.values))
        assert away.min() <= 0.05 + 1e-9
        assert points.occurrence.values[away.argmin()] > 0
    again = load(save(points, tmp_path / "points.nc"))
    assert again.verdict.equals(points.verdict)
    assert plot(again) is not None


@pytest.mark.parametrize(("name", "value"), [("pressure", [0.0, 1.0]), ("mu", [-0.1])])
def test_pressures_and_frictions_that_cannot_be_are_refused(name, value):
    with pytest.raises(ValueError, match=name):
        operating_map(structure(), **{name: value})


def test_a_list_with_known_hits_misses_and_false_alarms_is_matched_so(points, tmp_path):
    """Noise is predicted at friction 0.6 and a speed of 2 m/s, 7.2 km/h, and none at 0.05."""
    noisy = float(points.frequency.sel(pressure=1.0, speed=2.0, mu=0.6))
    rows = [
        ("1,0", "7,2", "0,6", noisy * 1.03, "hit"),
        ("1,0", "7,0", "0,6", noisy * 1.2, "miss"),
        ("2,0", "7,2", "0,05", noisy, "miss"),
        ("1,0", "7,2", "0,6", None, "false_alarm"),
        ("1,0", "7,2", "0,05", None, "both_quiet"),
        ("1,0", "90,0", "0,6", noisy, "outside"),
    ]
    path = tmp_path / "noises.csv"
    lines = ["pressure;speed [km/h];mu;frequency [kHz];level [dB]"]
    for pressure, speed, mu, frequency, _ in rows:
        heard = "" if frequency is None else f"{frequency / 1e3:.6f}".replace(".", ",")
        lines.append(f"{pressure};{speed};{mu};{heard};{'80,5' if heard else ''}")
    path.write_text("\n".join(lines), encoding="utf-8")
    beside = matched(points, read_noises(path, UNITS), 0.05)
    assert [Match(each).name for each in beside["match"]] == [row[-1] for row in rows]
    counts = {name: beside[name] for name in ("hits", "misses", "false_alarms")}
    assert counts == {"hits": 1, "misses": 2, "false_alarms": 1}
    assert beside["measured_frequency"][0] == pytest.approx(1.03 * noisy, rel=1e-6)
    assert beside["measured_level"][0] == 80.5
    told = points.assign(
        {
            name: (("noise",) if np.ndim(value) else (), value)
            for name, value in beside.items()
            if name != "measured_occurrence"
        }
    ).assign(frequency_band=0.05)
    said = [line for line in words(told) if line.startswith("  Line ")]
    assert "  Frequencies of the hits are at most 2.9 % apart." in words(told)
    assert [line.split(" ")[3] for line in said] == ["2", "3", "4"]
    assert "(17 % below)" in said[0]
    assert said[1].endswith("predicted quiet.")
    assert "measured quiet, predicted" in said[2]
    excel = tmp_path / "noises.xlsx"
    table = pd.DataFrame(
        [[1.0, 7.2, 0.6, noisy / 1e3, 80.5]], columns=lines[0].split(";")
    )
    table.to_excel(excel, index=False)
    (only,) = read_noises(excel, UNITS)
    assert only.point == pytest.approx({"pressure": 1.0, "speed": 2.0, "mu": 0.6})
    assert only.frequency == pytest.approx(noisy)


def test_an_empty_cell_is_not_known_and_levels_may_be_weighted(points, tmp_path):
    noisy = float(points.frequency.sel(pressure=1.0, speed=2.0, mu=0.6))
    path = tmp_path / "noises.csv"
    lines = ["speed,mu,frequency [Hz],level [dB(A)]", f"2,0.6,{noisy},80"]
    lines += [f"2,,{noisy},81", "2,,,", "2,0.05,,"]
    path.write_text("\n".join(lines), encoding="utf-8")
    compared = matched(points, read_noises(path, UNITS), 0.05)
    names = [Match(each).name for each in compared["match"]]
    assert names == ["hit", "hit", "false_alarm", "both_quiet"]
    assert compared["measured_level"][:2].tolist() == [80.0, 81.0]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("pressure [bar];frequency [Hz]\n10;900", "factor"),
        ("pressure;frequency [Hz]\n1;900 Hz", "without a unit"),
        ("pressure;frequency [Hz]\n;900", "pressure is missing"),
        ("presure;frequency [Hz]\n1;900", "pressure"),
        ("level;frequency [Hz]\n1;900", "one of pressure"),
    ],
)
def test_a_list_that_cannot_be_read_is_refused_with_its_line(text, message, tmp_path):
    path = tmp_path / "noises.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r"noises\.csv") as error:
        read_noises(path, UNITS)
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"pressure": ["5 bar"]}, "no contact has an area"),
        ({"speed": [0.0, 1.0]}, "nothing slides"),
        ({"mu": [0.1, 0.1]}, "each once"),
        ({"temperature": [20.0]}, "give mu_of"),
        ({"mu_of": {"temperature": "20:0.4 300:0.3"}}, "give temperature="),
        ({"mu_of": {"humidity": "0:0.4 1:0.3"}}, "humidity"),
        ({"mu_of": {"speed": {1.0: 0.4}}}, "two or more knots"),
        (
            {"mu_of": {"speed": "1:0.4 3:0.3"}, "speed": [4.0]},
            "nothing is extrapolated",
        ),
        ({"mu_of": {"speed": 0.4}}, "name of a file"),
        ({"band_edges": [2e3, 1e3]}, "ascending"),
    ],
)
def test_points_that_cannot_be_are_refused_before_any_run(options, message):
    with pytest.raises(ValueError, match=message):
        operating_map(structure(), **options)


def test_pressures_are_those_of_the_faces_and_tables_may_have_any_unit(tmp_path):
    """A face of 20 cm² that is pressed with 3 kN has 15 bar."""
    origin = PointOrigin((1,), (), 20e-4, 0.0, (0.0, 0.0, 0.0))
    contacts = [replace(each, origin=origin) for each in structure().contacts]
    pressed = structure().with_(contacts=contacts)
    table = tmp_path / "mu.csv"
    table.write_text("temperature [K];mu\n573,15;0,7\n293,15;0,1\n", encoding="utf-8")
    points = operating_map(
        pressed,
        pressure=["7.5 bar", "3 MPa"],
        speed=["7.2 km/h"],
        temperature="20:300:3",
        mu_of={"temperature": table, "pressure": {"5 bar": 0.5, "30 bar": 1.0}},
        band_edges=["500 Hz", "1 kHz", "20 kHz"],
        workers=1,
    )
    assert points.pressure.values == pytest.approx([0.5, 2.0])
    assert float(points.mean_pressure) == pytest.approx(1.5e6)
    assert points.speed.values == pytest.approx([2.0])
    over_pressure = np.array([0.55, 1.0])
    truth = over_pressure[:, None] * np.array([0.1, 0.4, 0.7])
    assert points.friction.values[:, 0] == pytest.approx(truth)
    for place in np.ndindex(2, 3):
        at = points.growth_rate.values[place[0], 0, place[1]]
        assert at == pytest.approx(growth(truth[place], 1.0), rel=1e-6)
    assert points.band_low.values == pytest.approx([500.0, 1000.0])
    heard = np.isfinite(points.frequency.values)
    assert points.occurrence.values.sum() == pytest.approx(heard.mean())


def test_a_sweep_in_parts_or_after_an_interruption_is_the_map_of_python(tmp_path):
    pad = structure()
    for name, matrix in (("mass", pad.mass), ("stiffness", pad.given_stiffness)):
        scipy.sparse.save_npz(tmp_path / f"{name}.npz", matrix.tocsr())
    scipy.sparse.save_npz(tmp_path / "damping.npz", pad.given_damping.tocsr())
    (tmp_path / "contacts.csv").write_text(
        f"name,normal,tangential,stiffness,preload\npad,2:1,1:1,{STIFFNESS},3000\n"
    )
    (tmp_path / "pad.yaml").write_text(
        "mass: mass.npz\nstiffness: stiffness.npz\ndamping: damping.npz\n"
        "contacts: contacts.csv\nload: 0\n"
    )
    axes = {"pressure": [1.0, 2.0], "speed": [2.0, 4.0], "mu": [0.05, 0.1, 0.6]}
    config = {
        "task": f"{tmp_path / 'pad.yaml'}:operating_map",
        "vary": {"mu": axes["mu"], "speed": axes["speed"]},
        "fixed": {"pressure": axes["pressure"]},
    }
    whole = operating_map(pad, **axes, workers=1)
    sweep = planned(config)
    kept = Chunks(tmp_path / "runs", "key")
    kept.save(0, [sweep.arrays(point, 1) for point in sweep.points[:5]])
    assert sweep.finished(kept) == 5
    resumed = run_sweep(sweep, workers=1, kept=kept)
    assert resumed.equals(whole)
    parts = [
        run_sweep(planned(config).scattered(f"{i}-of-3"), workers=1) for i in (1, 2, 3)
    ]
    assert [part.sizes["mu"] for part in parts] == [1, 1, 1]
    assert joined(config, parts, "mu").equals(whole)


def test_a_frequency_on_the_edge_of_two_bands_is_in_the_upper_one():
    bands = {"band_low": np.array([1e3, 2e3]), "band_high": np.array([2e3, 3e3])}
    assert _share(np.array([2e3, np.nan]), bands).tolist() == [0.0, 0.5]
