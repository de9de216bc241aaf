"""Laws from files: what a table may hold, and that its content is the law."""

import numpy as np
import pytest

from squealpipe import Parameters
from squealpipe.brake.models.refusals import refuse_extensions
from squealpipe.laws import contact_laws
from squealpipe.laws.friction_laws import coefficient, slope
from squealpipe.store.rerun.key import rule_key
from squealpipe.study.configuration.settings import ConfigError, read_study

CSV = "speed, coefficient\n0, 0.5\n0.1, 0.4\n1, 0.3\n"
TEXT = "linear 0.0:0.5 0.1:0.4 1.0:0.3"


@pytest.fixture
def csv(tmp_path):
    path = tmp_path / "friction.csv"
    path.write_text(CSV)
    return path


def test_the_content_of_a_file_is_the_law(csv):
    params = Parameters(friction_law=csv)
    assert (
        params
        == Parameters(friction_law=str(csv))
        == Parameters(friction_law={"table": csv})
    )
    assert params.friction_law == TEXT
    assert Parameters(**params.as_dict()) == params == eval(repr(params))  # noqa: S307
    assert (params.static_mu, params.mu) == (0.5, 0.3)
    assert params.with_(belt_speed=-0.05).drag == pytest.approx(-0.45, rel=1e-15)


def test_what_a_table_stood_for_stays_when_it_goes(csv):
    params = Parameters(friction_law=csv, contact_law="linear 0:0 1:2 2:8", preload=1.5)
    plain = params.with_(friction_law="coulomb", contact_law="linear")
    assert (plain.mu, plain.k3) == (0.3, params.k3) == (0.3, 5.0 / 1.5)
    assert params.with_(preload=1.0).k3 == 2.0
    assert Parameters(mu=0.7).with_(friction_law=csv).mu == 0.3


def test_values_between_and_beyond_the_knots():
    speeds = np.array([0.0, 0.05, 0.1, 0.55, 1.0, 7.0])
    params = Parameters(friction_law=TEXT)
    expected = np.interp(speeds, [0.0, 0.1, 1.0], [0.5, 0.4, 0.3])
    np.testing.assert_allclose(coefficient(speeds, params), expected, rtol=1e-15)
    np.testing.assert_allclose(
        slope(speeds[[1, 3, 5]], params), [-1.0, -1 / 9, 0.0], rtol=1e-14
    )
    # a knot has the mean of its slopes, also of a speed that misses it by round-off
    for at in (0.1, 0.1 * (1 + 3e-16), 0.1 * (1 - 3e-16)):
        assert slope(at, params) == pytest.approx(-5 / 9, rel=1e-14)
        assert coefficient(at + 1e-30j, params).imag == slope(at, params) * 1e-30
    late = Parameters(friction_law="linear 0.2:0.4 1:0.3")
    assert coefficient(0.1, late) == late.static_mu == 0.4


@pytest.mark.parametrize("shape", [(3, 5), (4, 4), (2, 3, 4), (0, 4)])
def test_arrays_of_any_shape_are_taken_number_by_number(shape):
    at = np.random.default_rng(7).uniform(-0.2, 2.0, shape)
    params = Parameters(friction_law=TEXT, contact_law="cubic 0:0 0.5:0.2 1:1 2:4")
    force = contact_laws.law_of(params.contact_law).force
    functions = (
        lambda speed: coefficient(np.abs(speed), params),
        lambda speed: slope(np.abs(speed), params),
        lambda compression: force(compression, 0.0, params),
    )
    for function in functions:
        one_by_one = [float(function(each)) for each in at.ravel().tolist()]
        np.testing.assert_array_equal(function(at), np.reshape(one_by_one, shape))


def test_cubic_tables_are_monotone_and_smooth():
    params = Parameters(friction_law=TEXT.replace("linear", "cubic"))
    speeds = np.linspace(0.0, 1.0, 1001)[:-1]
    assert (np.diff(coefficient(speeds, params)) < 0).all()
    left, right = slope(0.1 - 1e-12, params), slope(0.1 + 1e-12, params)
    assert left == pytest.approx(right, rel=1e-9)
    gap = 1e-5
    numeric = (
        coefficient(speeds[1:] + gap, params) - coefficient(speeds[1:] - gap, params)
    ) / 2e-5
    inner = np.abs(speeds[1:] - 0.1) > 2 * gap
    np.testing.assert_allclose(
        slope(speeds[1:], params)[inner], numeric[inner], atol=1e-8
    )


@pytest.mark.parametrize("between", ["linear", "cubic"])
def test_a_contact_goes_on_with_its_last_slope(between):
    """Of a cubic one the slope at its last knot: the force has no corner there."""
    law = contact_laws.law_of(f"{between} 0:0 0.5:0.2 1:1 2:4")
    plain, end = Parameters(k3=1.0), 2.0
    before, after = (
        (law.force(end + step, 0.0, plain) - law.force(end, 0.0, plain)) / step
        for step in (-1e-7, 1.0)
    )
    assert before == pytest.approx(after, rel=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("speed,coefficient\n0,0.5\n0.1,0.4\n0.1,0.3\n", r"row 4: speed 0.1 after 0.1"),
        ("speed,coefficient\n0.2,0.5\n0.1,0.4\n", r"row 3: speed 0.1 after 0.2"),
        ("speed,coefficient\n0,-0.5\n", r"row 2: coefficient = -0.5"),
        ("speed,coefficient\n0,nan\n", r"row 2: 'nan' is no number"),
        ("speed,coefficient\n0,0.5\n1\n", r"row 3: an empty cell"),
        ("v,mu\n0,0.5\n", r"has no column 'speed'; its columns: v, mu"),
        ("speed,coefficient\n", r"has no rows"),
    ],
)
def test_a_table_that_is_no_function_is_refused(tmp_path, text, message):
    path = tmp_path / "friction.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        Parameters(friction_law=path)


@pytest.mark.parametrize(
    "other", [{"mu": 0.2}, {"mu_static": 0.5}, {"friction_speed": 2.0}]
)
def test_what_the_table_stands_for_is_refused_beside_it(other):
    with pytest.raises(
        ValueError, match=f"{next(iter(other))} = .*leave {next(iter(other))} out"
    ):
        Parameters(friction_law=TEXT, **other)
    with pytest.raises(ValueError, match="leave k3 out"):
        Parameters(contact_law="linear 0:0 1:2", k3=3.0)


def test_laws_that_cannot_be_carried_say_why():
    with pytest.raises(ValueError, match=r"no Taylor series at d = 0.*give a table"):
        Parameters(contact_law="hertz")
    with pytest.raises(
        ValueError, match=r"damping3 = 1.0: contact_law = 'dashpot' alone"
    ):
        Parameters(damping3=1.0)
    with pytest.raises(ValueError, match="begins with compression 0 and force 0"):
        Parameters(contact_law="linear 1:1 2:3")
    for given in ({"friction_law": TEXT}, {"contact_law": "dashpot"}):
        with pytest.raises(ValueError, match="A4 cannot carry this"):
            refuse_extensions(Parameters(**given), "A4", "")


def test_a_law_in_python_needs_its_file_alone(tmp_path):
    path = tmp_path / "law.py"
    path.write_text(
        "from squealpipe.functions import exp\n\n"
        "def coefficient(speed, p):\n    return p.mu * (1.0 + 0.5 * exp(-speed))\n"
    )
    params = Parameters(friction_law=path, mu=0.4)
    assert params.static_mu == pytest.approx(0.6, rel=1e-15)
    speeds = np.array([0.5, 2.0])
    np.testing.assert_allclose(
        slope(speeds, params), -0.2 * np.exp(-speeds), rtol=1e-14
    )
    path.unlink()
    assert Parameters(**params.as_dict()) == params
    path.write_text("def mu(speed):\n    return 0.3\n")
    with pytest.raises(ValueError, match=r"no function coefficient\(speed, p\)"):
        Parameters(friction_law=path)


def test_configurations_name_files_relative_to_themselves(tmp_path, csv):
    mine = tmp_path / "mine.yaml"
    mine.write_text(
        "parameters:\n  friction_law: {table: friction.csv, between: cubic}\n"
    )
    part = read_study(mine).slice("parameters")
    assert part["parameters"]["friction_law"] == TEXT.replace("linear", "cubic")
    before = rule_key(part, [])
    csv.write_text(CSV.replace("0.4", "0.41"))
    assert rule_key(read_study(mine).slice("parameters"), []) != before


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("friction_law: {table: none.csv}", "parameters.friction_law: .*none.csv"),
        ("mu: 0.3\n  friction_law: {table: friction.csv}", "stands for mu; leave"),
        ("friction_law: {file: friction.csv}", "write {table: FILE.csv}"),
    ],
)
def test_mistakes_in_a_configuration_name_the_law(tmp_path, csv, lines, message):
    mine = tmp_path / "mine.yaml"
    mine.write_text(f"parameters:\n  {lines}\n")
    with pytest.raises(ConfigError, match=message):
        read_study(mine)
