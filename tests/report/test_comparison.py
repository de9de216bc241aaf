"""What people see of a comparison: parameters first, the place, pictures of flipped cells."""

import io

import numpy as np
import pytest
from rich.console import Console

from squealpipe.figures.difference import draw, drawable
from squealpipe.parameters import Parameters
from squealpipe.report.comparison import page, table, verdict_line
from squealpipe.schema.linear import STABILITY_MAP
from squealpipe.store import produce
from squealpipe.store.compare import compare
from squealpipe.tasks.linear import stability_map


@pytest.fixture
def pair(tmp_path):
    angles = np.linspace(0, np.pi, 13)
    for name, mu in (("a", 0.3), ("b", 0.5)):
        produce(
            lambda mu=mu: stability_map(Parameters(mu=mu), angles, angles),
            config={"parameters": {"mu": mu}},
            output=tmp_path / name / "stability_map.nc",
        )
    return tmp_path / "a", tmp_path / "b"


def printed(comparison):
    buffer = io.StringIO()
    Console(file=buffer, width=160).print(table(comparison))
    return buffer.getvalue()


def test_table_lists_changed_parameters_first_and_the_verdict_last(pair):
    text = printed(compare(*pair))
    assert text.index("parameters.mu") < text.index("growth_rate")
    assert "stable → flutter" in text
    assert text.rstrip().endswith("different: 1 dataset (different 1)")


def test_equal_datasets_are_counted_but_not_listed(pair):
    assert printed(compare(pair[0], pair[0])) == "equal: 1 dataset (equal 1)\n"


def test_table_of_what_cannot_be_compared_tells_why(pair, tmp_path):
    found = compare(pair[0], tmp_path / "nowhere")
    assert "no archive, folder or file" in printed(found)
    assert verdict_line(found).startswith("not comparable")


def test_page_is_self_contained_and_shows_each_differing_map(pair):
    html = page(compare(*pair))
    assert html.count('<img src="data:image/png;base64,') == 4
    assert "http" not in html.replace("http-equiv", "")
    assert "13 flipped" in html or "flipped:" in html


def test_page_quotes_what_datasets_say(pair, tmp_path):
    hostile = tmp_path / "<script>alert(1)<script>"
    pair[1].rename(hostile)
    assert "<script>" not in page(compare(pair[0], hostile))


def test_picture_of_flags_marks_exactly_the_flipped_cells(pair):
    a, b = (stability_map(Parameters(mu=mu), *[np.linspace(0, np.pi, 13)] * 2) for mu in (0.3, 0.5))
    entry = STABILITY_MAP.variables["regime_linear"]
    figure = draw("regime_linear", a.regime_linear, b.regime_linear, entry)
    drawn = np.asarray(figure.axes[2].collections[0].get_array()).reshape(13, 13)
    np.testing.assert_array_equal(drawn.T, a.regime_linear.values != b.regime_linear.values)
    assert drawable(a.frequency)
    assert not drawable(a.alpha1)
