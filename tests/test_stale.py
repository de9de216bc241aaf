"""A dataset tells what made it: a result that is out of date is found, or is never published."""

import os
from pathlib import Path

import numpy as np
import pytest

from squealpipe.rerun.sources import code_digests, edited, first_seen
from squealpipe.rerun.stale import Made, attributes, stale
from squealpipe.store import StoreError, load, produce, save
from squealpipe.tasks.linear.maps import stability_map
from tests.former import FORMER

ANGLES = np.linspace(0, np.pi, 7)
PART = {"parameters": {"mu": 0.3}, "linear.points": 7}
TEXT = '''"""Doc."""
def law(y):
    """What it is."""
    return 2 * y
'''


def make():
    return stability_map(FORMER, ANGLES, ANGLES)


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "law.py"
    path.write_text(TEXT)
    os.utime(path, (1e9, 1e9))
    return path


@pytest.fixture
def produced(tmp_path, source):
    return produce(make, config=PART, output=tmp_path / "map.nc", sources=[source])


def later(source, text):
    """The file as another process finds it: edited, with a date before the dataset's."""
    source.write_text(text)
    os.utime(source, (1e9 + 1, 1e9 + 1))
    first_seen.cache_clear()


def check(path, source, part=PART):
    return stale([Made(str(path), part, (str(source),))])


@pytest.mark.parametrize(
    "text",
    [
        "# a comment\n" + TEXT,
        TEXT.replace("What it is", "What it was"),
        TEXT.replace('"""Doc."""\n', ""),
        TEXT.replace("2 * y", "(2   * y)  # twice"),
    ],
)
def test_comments_and_docstrings_are_not_code(source, produced, text):
    before = code_digests([source])
    source.write_text(text)
    assert edited([source]) == []
    later(source, text)
    assert code_digests([source]) == before
    assert check(produced, source) == {}


def test_header_tells_what_made_a_dataset_whatever_its_size(tmp_path, produced, source):
    told = attributes(produced)
    assert {name: told[name] for name in ("config", "code")} == {
        name: load(produced).attrs[name] for name in ("config", "code")
    }
    long = make().isel(alpha1=np.zeros(5000, int)).assign_coords(alpha1=np.arange(5000.0))
    path = produce(lambda: long, config=PART, output=tmp_path / "long.nc", sources=[source])
    assert attributes(path)["config"] == told["config"]
    (tmp_path / "none.nc").write_bytes(b"no header" * 50_000)
    assert attributes(tmp_path / "none.nc") is None


def test_other_configuration_is_found_and_named(produced, source):
    assert check(produced, source) == {}
    assert check(produced, source, {**PART, "parameters": {"mu": 0.25}}) == {
        str(produced): ["parameters.mu: 0.3 → 0.25"]
    }
    assert check(produced, source, {**PART, "linear.points": 9}) == {
        str(produced): ["linear.points: 7 → 9"]
    }


def test_source_with_an_older_date_is_found_and_one_with_a_newer_left_to_snakemake(
    produced, source
):
    later(source, TEXT.replace("2 * y", "3 * y"))
    assert check(produced, source) == {str(produced): [f"{source} changed"]}
    os.utime(source)
    newer = produced.stat().st_mtime + 10
    os.utime(source, (newer, newer))
    assert check(produced, source) == {}


def test_file_that_tells_no_origin_and_has_no_record_is_out_of_date(tmp_path, source):
    path = save(make(), tmp_path / "foreign.nc")
    assert check(path, source) == {str(path): ["does not tell what it was made from"]}


@pytest.mark.parametrize("text", [TEXT.replace("2 * y", "3 * y"), "def law(", None])
def test_result_of_code_that_changed_meanwhile_is_not_published(tmp_path, source, text):
    def edit_and_make():
        if text is None:
            source.unlink()
        else:
            source.write_text(text)
        return make()

    target = tmp_path / "map.nc"
    with pytest.raises(StoreError, match=r"law\.py changed while it was computed; run snakemake"):
        produce(edit_and_make, config=PART, output=target, sources=[source])
    assert not target.exists()


@pytest.mark.parametrize("mu", [0.3, 0.25])
def test_orphan_does_not_overwrite_what_a_later_job_wrote(tmp_path, source, mu):
    target = tmp_path / "map.nc"
    newer = {"parameters": {"mu": mu}, "linear.points": 7}

    def overtaken() -> object:
        produce(make, config=newer, output=target, sources=[source])
        return make()

    def publish() -> Path:
        return produce(overtaken, config=PART, output=target, sources=[source])

    if newer == PART:
        assert publish() == target
    else:
        with pytest.raises(StoreError, match="a job that began later has written it"):
            publish()
    assert load(target).attrs["config"] == attributes(target)["config"]
    assert str(mu) in load(target).attrs["config"]
