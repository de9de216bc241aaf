"""Archives keep once what they have in common; nothing that one refers to is ever deleted."""

import os
import shutil

import pytest

from squealpipe.cli import run as command
from squealpipe.store import load
from squealpipe.store.archive import archive, verify
from squealpipe.store.memory import objects
from squealpipe.store.memory.objects import checksum, collect, garbage, object_path


@pytest.fixture
def pair(run):
    """Two archives of one run; the second with another figure."""
    first = archive("first", root=run)
    (run / "results/figures/fig06.png").write_bytes(b"another picture")
    return first, archive("second", root=run)


DATASET, FIGURE = "data/stability_map.nc", "figures/fig06.png"


def test_what_is_the_same_is_kept_once_and_stays_a_plain_file(pair):
    first, second = pair
    assert (first / DATASET).samefile(second / DATASET)
    assert not (first / FIGURE).samefile(second / FIGURE)
    assert (first / DATASET).stat().st_nlink == 3
    assert load(first / DATASET).identical(load(second / DATASET))
    assert verify(first).intact
    assert verify(second).intact


def test_without_links_files_are_copies(run, monkeypatch):
    def refuse(*_):
        raise OSError("links are not supported")

    monkeypatch.setattr(objects.os, "link", refuse)
    pair = archive("first", root=run), archive("second", root=run)
    assert not (pair[0] / DATASET).samefile(pair[1] / DATASET)
    assert all(verify(each).intact for each in pair)
    assert garbage(run).objects == []


def test_damage_of_a_shared_content_is_found_in_every_archive_that_has_it(run, pair):
    path = pair[0] / DATASET
    path.chmod(0o644)
    with path.open("r+b") as file:
        file.seek(4000)
        file.write(b"damage")
    for each in pair:
        assert verify(each).changed == [DATASET]
    third = archive("third", root=run)
    assert verify(third).intact, "a damaged object is never linked to again"
    assert checksum(third / DATASET) == checksum(run / "results" / DATASET)


def test_a_damaged_object_that_is_no_longer_the_file_is_found(run, pair):
    digest = checksum(pair[0] / FIGURE)
    kept = object_path(run / "results/archive", digest)
    kept.unlink()
    kept.write_bytes(b"not that picture")
    found = verify(pair[0])
    assert found.changed == [f".objects/{digest} (shared object of {FIGURE})"]
    assert verify(pair[1]).intact


def test_only_what_no_archive_refers_to_is_deleted(run, pair, monkeypatch, capsys):
    monkeypatch.chdir(run)
    first, second = pair
    digest, size = checksum(first / FIGURE), (first / FIGURE).stat().st_size
    assert garbage(run).objects == []
    shutil.rmtree(first)
    alone = garbage(run)
    kept = object_path(run / "results/archive", digest)
    assert kept in alone.objects
    assert alone.size >= size
    assert command(["gc", "--dry-run"]) == 0
    assert str(kept.relative_to(run)) in capsys.readouterr().out
    assert kept.is_file()
    assert command(["gc"]) == 0
    assert not kept.exists()
    assert verify(second).intact
    assert garbage(run).objects == []
    assert collect(run).objects == []


def test_archives_half_written_by_a_killed_process_are_garbage(run, pair):
    draft = run / "results/archive/.third.x1.tmp"
    (draft / "data").mkdir(parents=True)
    os.link(pair[0] / DATASET, draft / DATASET)
    (draft / "half").write_bytes(b"12345")
    found = collect(run)
    assert (found.drafts, found.size) == ([draft], 5)
    assert not draft.exists()
    assert verify(pair[0]).intact


def test_what_something_else_still_links_to_is_kept(run, pair, tmp_path):
    pair[0].rename(tmp_path / "moved")
    assert garbage(run).objects == []
    assert verify(tmp_path / "moved").intact


def test_nothing_is_collected_while_a_manifest_is_damaged(run, pair):
    shutil.rmtree(pair[0])
    manifest = pair[1] / "manifest.json"
    manifest.chmod(0o644)
    manifest.write_text(manifest.read_text().replace("second", "secund"))
    with pytest.raises(ValueError, match="manifest is damaged"):
        collect(run)
    assert verify(pair[1]).changed == ["manifest.json"]
