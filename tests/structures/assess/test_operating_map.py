"""Operating points of two degrees of freedom, against eigenvalues that are written down here."""

import numpy as np
import pandas as pd
import pytest

from squealpipe import Contact, Structure, load, operating_map, plot, save
from squealpipe.codes import Verdict
from squealpipe.structures.assess.measured import matched, read_noises
from squealpipe.structures.schema.operating_map import Match

STIFFNESS = 6e6
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
    beside = matched(points, read_noises(path), 0.05)
    assert [Match(each).name for each in beside["match"]] == [row[-1] for row in rows]
    counts = {name: beside[name] for name in ("hits", "misses", "false_alarms")}
    assert counts == {"hits": 1, "misses": 2, "false_alarms": 1}
    assert beside["measured_frequency"][0] == pytest.approx(1.03 * noisy, rel=1e-6)
    assert beside["measured_level"][0] == 80.5
    excel = tmp_path / "noises.xlsx"
    table = pd.DataFrame(
        [[1.0, 7.2, 0.6, noisy / 1e3, 80.5]], columns=lines[0].split(";")
    )
    table.to_excel(excel, index=False)
    (only,) = read_noises(excel)
    assert only.point == pytest.approx({"pressure": 1.0, "speed": 2.0, "mu": 0.6})
    assert only.frequency == pytest.approx(noisy)


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
        read_noises(path)
    assert message in str(error.value)
