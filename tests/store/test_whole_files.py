"""What survives a power loss: content is on disk before its name, the name before the answer."""

import os
from pathlib import Path

import pytest

from squealpipe.store.whole_files import whole_file


def test_content_is_on_disk_before_the_name_and_the_name_before_the_end(
    tmp_path, monkeypatch
):
    steps = []
    fsync, replace = os.fsync, Path.replace

    def seen_fsync(handle):
        steps.append(Path(f"/proc/self/fd/{handle}").readlink().suffix or "folder")
        fsync(handle)

    def seen_replace(self, target):
        steps.append("rename")
        return replace(self, target)

    monkeypatch.setattr(os, "fsync", seen_fsync)
    monkeypatch.setattr(Path, "replace", seen_replace)
    with whole_file(tmp_path / "a.txt") as draft:
        draft.write_text("content")
    assert steps == [".txt", "rename", "folder"]
    assert (tmp_path / "a.txt").read_text() == "content"


def test_what_was_there_stays_whole_while_another_is_written(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("before")
    with whole_file(path) as draft:
        with path.open() as reader:
            draft.write_text("after")
            assert reader.read() == "before"
        earlier = path.stat().st_ino
    assert path.read_text() == "after"
    assert (
        path.stat().st_ino != earlier
    )  # who reads the earlier file goes on reading it
    with pytest.raises(ZeroDivisionError), whole_file(path) as draft:
        draft.write_text(str(1 / 0))
    assert path.read_text() == "after"
    assert list(tmp_path.iterdir()) == [path]


def test_others_may_read_what_is_written_as_any_file_of_its_user(tmp_path):
    """A temporary file is its owner's alone, and takes the place of the dataset."""
    with whole_file(tmp_path / "a.txt") as draft:
        draft.write_text("content")
    (tmp_path / "b.txt").touch()
    assert (tmp_path / "a.txt").stat().st_mode == (tmp_path / "b.txt").stat().st_mode
