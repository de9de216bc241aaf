"""Files appear whole, from a name that nobody could prepare."""

from __future__ import annotations

import subprocess

import numpy as np
import pytest

from squealpipe import Parameters, save, stability_map
from squealpipe.store.checkout import commit
from squealpipe.store.chunks import Checkpoint
from squealpipe.store.netcdf import StoreError
from squealpipe.store.provenance import stamped
from squealpipe.store.whole_files import whole_file


def test_no_waiting_link_is_written_to(tmp_path, monkeypatch):
    monkeypatch.setattr("os.getpid", lambda: 7)
    (tmp_path / ".page.7.html").symlink_to(tmp_path / "victim")
    with whole_file(tmp_path / "page.html") as temporary:
        temporary.write_text("whole")
    assert (tmp_path / "page.html").read_text() == "whole"
    assert not (tmp_path / "victim").exists()


def test_ids_of_inputs_are_those_of_the_files_that_the_task_read(tmp_path):
    made = [stability_map(Parameters(mu=mu), [1.0], [2.0]) for mu in (0.1, 0.2)]
    path = save(made[0], tmp_path / "input.nc")

    def task():
        save(made[1], path)  # another job, meanwhile
        return made[0]

    before = stamped(lambda: made[0], config={}, inputs=[path]).attrs["inputs"]
    assert stamped(task, config={}, inputs=[path]).attrs["inputs"] == before


def test_a_foreign_part_is_named(tmp_path):
    parts = Checkpoint.beside(tmp_path / "sweep.nc", key="x")
    for index in (0, 1):
        parts.write(index, {"a": np.arange(2.0) + index})
    assert parts.read(1)["a"].tolist() == [1.0, 2.0]
    parts.path(0).write_bytes(parts.path(1).read_bytes())
    with pytest.raises(StoreError, match=r"000000\.npz is a part of something else; delete it"):
        parts.read(0)
    np.savez(parts.path(1), a=np.zeros(2))
    with pytest.raises(StoreError, match=r"000001\.npz"):
        parts.read(1)


def test_an_archive_that_replaces_another_leaves_the_commit_clean(tmp_path):
    for name in ("Snakefile", "squealpipe/__init__.py", "results/archive/reference/manifest.json"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    by = ["git", "-C", str(tmp_path), "-c", "user.name=n", "-c", "user.email=e"]
    for words in (["init", "-q"], ["add", "-A"], ["commit", "-qm", "first"]):
        subprocess.run([*by, *words], check=True)
    (tmp_path / "results/archive/reference/manifest.json").unlink()
    commit.cache_clear()
    assert not commit(tmp_path).endswith("-dirty")
    (tmp_path / "Snakefile").write_text("rule all:")
    commit.cache_clear()
    assert commit(tmp_path).endswith("-dirty")
    commit.cache_clear()
