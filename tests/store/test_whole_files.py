"""Files appear whole, from a name that nobody could prepare."""

import subprocess

from squealpipe import Parameters, save, stability_map
from squealpipe.store.checkout import commit
from squealpipe.store.provenance import stamped


def test_ids_of_inputs_are_those_of_the_files_that_the_task_read(tmp_path):
    made = [stability_map(Parameters(mu=mu), [1.0], [2.0]) for mu in (0.1, 0.2)]
    path = save(made[0], tmp_path / "input.nc")

    def task():
        save(made[1], path)  # another job, meanwhile
        return made[0]

    before = stamped(lambda: made[0], config={}, inputs=[path]).attrs["inputs"]
    assert stamped(task, config={}, inputs=[path]).attrs["inputs"] == before


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
