"""The whole study of one's own, with every law and option: its report has the answer."""

import pytest
import yaml

from squealpipe import load
from squealpipe.laws import contact_laws, friction_laws
from squealpipe.study.report import answer
from tests.conftest import ROOT, run_snakemake, text_of_page

PAD = {
    "mass": 0.45,
    "k1": 1e7,
    "k2": 1e7,
    "k3": 7e6,
    "preload": 5.714e-4,
    "mu": 0.4,
    "belt_speed": 2.0,
    "length1": 0.1,
    "length2": 0.1,
    "damping1": 42.4,
    "damping2": 42.4,
}
FALLING = {"mu": 0.37, "mu_static": 0.55, "friction_speed": 1.7}
SPEEDS = (0, 0.1, 0.3, 0.5, 0.8, 1.1, 1.4, 1.7, 2, 2.5, 3.5, 5)
TABLE = "speed,coefficient\n" + "".join(
    f"{w},{0.55 - 0.12 * min(w, 2) / 2 - 0.02 * max(w - 2, 0)}\n" for w in SPEEDS
)
CONTACT = "compression,force\n0,0\n2e-4,1200\n5e-4,3400\n1e-3,7600\n"
PYTHON = """
from squealpipe.functions import exp

def coefficient(speed, p):
    return 0.37 + 0.18 * exp(-speed / 1.7)
"""
TABLE_LAW = {"friction_law": {"table": "friction.csv"}, "mu": None}
CUBIC_LAW = {"friction_law": {"table": "friction.csv", "between": "cubic"}, "mu": None}
PYTHON_LAW = {"friction_law": {"python": "friction.py"}, "mu": None}
CONTACT_TABLE = {"contact_law": {"table": "contact.csv"}, "k3": None}
CUBIC_CONTACT = {
    "contact_law": {"table": "contact.csv", "between": "cubic"},
    "k3": None,
}
CONTACT_DASHPOT = {"contact_law": "dashpot", "damping3": 20.0}
UNDAMPED = {"damping1": 0.0, "damping2": 0.0}
SCALED = {
    "mass": 1.0,
    "k1": 1.0,
    "k2": 1.0,
    "k3": 0.7,
    "preload": 1.0,
    "length1": 175.0,
    "length2": 175.0,
    "belt_speed": 0.75,
    "damping1": 0.02,
    "damping2": 0.02,
}
STUDIES = {
    "Coulomb, static limit, belt at rest": {"mu_static": 0.6, "belt_speed": 0.0},
    "exponential, contact dashpot": {
        "friction_law": "exponential",
        **FALLING,
        **CONTACT_DASHPOT,
    },
    "hyperbolic, undamped, scaled units": {
        "friction_law": "hyperbolic",
        **FALLING,
        **SCALED,
        **UNDAMPED,
    },
    "both tables": {**TABLE_LAW, **CONTACT_TABLE},
    "cubic table, contact dashpot, undamped, the other way": {
        **CUBIC_LAW,
        **CONTACT_DASHPOT,
        **UNDAMPED,
        "belt_speed": -2.0,
    },
    "Python, cubic contact table, the other way": {
        **PYTHON_LAW,
        **CUBIC_CONTACT,
        "belt_speed": -2.0,
    },
}
"""Options in pairs, for a whole study takes half a minute."""
LONG = {
    "Coulomb, static limit, belt at rest",
    "exponential, contact dashpot",
    "hyperbolic, undamped, scaled units",
    "cubic table, contact dashpot, undamped, the other way",
}
"""Studies of the long tier; the others have a table or a function of one's own in each place."""


def options_of(study):
    """The options that a study has, by name."""
    given = PAD | {"friction_law": "coulomb", "contact_law": "linear"} | study
    found = set()
    for law in ("friction_law", "contact_law"):
        name = given[law]
        if isinstance(name, dict):
            name = (
                "Python"
                if "python" in name
                else f"{name.get('between', 'linear')} table"
            )
        found.add(f"{law} {name}")
    speed, damped = given["belt_speed"], given["damping1"] > 0.0
    found.add("belt at rest" if speed == 0.0 else f"belt {'+' if speed > 0 else '-'}x")
    found.add("dashpots" if damped else "no dashpots")
    found.add("SI" if given["length1"] < 1.0 else "scaled units")
    return found


WITH_A_STUDY = set().union(*map(options_of, STUDIES.values()))
for name, law in friction_laws.LAWS.items():  # one that is added has a study of its own
    if f"friction_law {name}" not in WITH_A_STUDY:
        read = {key: value for key, value in FALLING.items() if key in law.PARAMETERS}
        STUDIES[name] = {"friction_law": name, **read}

COARSE = {
    "paper": False,
    "results": "results/mine",
    "scenes": {"mine": {"alpha1": "22deg", "alpha2": "46deg", "start": {"vx": 1e-3}}},
    "dynamics": {"hammering_points": 3},
    "explorer": {"points": 3},
}


def test_each_option_has_a_study():
    tables = ("linear table", "cubic table")
    expected = {
        *(f"friction_law {law}" for law in (*friction_laws.LAWS, *tables, "Python")),
        *(f"contact_law {law}" for law in (*contact_laws.LAWS, *tables)),
        *("dashpots", "no dashpots", "belt +x", "belt -x", "belt at rest"),
        *("SI", "scaled units"),
    }
    assert set().union(*map(options_of, STUDIES.values())) == expected


@pytest.mark.timeout(1800)
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.long] * (name in LONG)) for name in STUDIES],
)
def test_the_report_has_the_answer(name, tmp_path):
    (tmp_path / "friction.csv").write_text(TABLE)
    (tmp_path / "contact.csv").write_text(CONTACT)
    (tmp_path / "friction.py").write_text(PYTHON)
    given = {k: v for k, v in (PAD | STUDIES[name]).items() if v is not None}
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump({**COARSE, "parameters": given}))
    tiny = str(ROOT / "workflow/config/tiny.yaml")
    words = ["--directory", str(tmp_path), "--configfile", tiny, str(path)]
    done = run_snakemake(ROOT, *words, "--cores", "1", "--quiet", "all")
    assert done.returncode == 0, done.stderr[-3000:]
    results = tmp_path / "results/mine"
    text = text_of_page(results / "report/index.html")
    told = load(results / "data/assess/mine.nc")
    for sentence in (answer.headline(told), answer.cause(told), answer.level(told)):
        assert sentence in text
    assert (" nan" in text or "None" in text) is False
    for made in ("report.pdf", "tables.xlsx", "explorer.html"):
        assert (results / "report" / made).stat().st_size > 1000
