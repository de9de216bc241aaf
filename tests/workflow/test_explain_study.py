"""`squealpipe explain` on the real workflow: keys, figures and times of a finished study."""

import os
import shutil

from squealpipe.store import load, save
from squealpipe.study.explain import explain

TINY = "workflow/config/tiny.yaml"


def reasons(checkout, *configs):
    plan = explain([checkout / TINY, *configs], directory=checkout)
    return {job.rule: job.reasons for job in plan.jobs}


def test_changed_key_and_missing_dataset_are_named_with_what_follows(
    finished, tmp_path
):
    mine = tmp_path / "mine.yaml"
    mine.write_text("linear: {points: 71}\n")
    missing = finished / "results/tiny/data/whirl.nc"
    missing.rename(finished / "aside.nc")
    try:
        plan = explain([finished / TINY, mine], directory=finished)
    finally:
        (finished / "aside.nc").rename(missing)
    jobs = {job.rule: job for job in plan.jobs}
    assert jobs["follow_whirl"].reasons == ["missing: results/tiny/data/whirl.nc"]
    assert [reason.partition(":")[0] for reason in jobs["map_linear"].reasons] == [
        "linear.points"
    ]
    assert "map_linear" in jobs["draw_linear"].follows
    assert "fig06" in plan.figures
    assert "fig02" not in plan.figures
    assert "map_validity" not in jobs
    assert plan.seconds > 0


def test_changed_code_is_noticed_whatever_its_date_and_dates_or_other_words_are_not(
    finished,
):
    path = finished / "squealpipe/paper/figures/linear/fig06.py"
    text = path.read_text()
    path.write_text(text + "ANOTHER = 1\n")
    try:
        new = reasons(finished)
        os.utime(path, (1e9, 1e9))
        old = reasons(finished)
    finally:
        path.write_text(text)
    assert set(new) == set(old) == {"draw_linear", "write_report"}
    assert "fig06.py" in new["draw_linear"][0]
    assert "fig06.py" not in old["draw_linear"][0]
    for each in [
        *finished.glob("squealpipe/**/*.py"),
        *finished.glob("workflow/**/*.*"),
    ]:
        each.touch()
    law = finished / "squealpipe/brake/models/a1.py"
    law.write_text(
        '"""In other words."""\n# A remark.\n' + law.read_text().split('"""', 2)[2]
    )
    assert reasons(finished) == {}


def test_replaced_and_damaged_results_are_named(finished, snakemake):
    """With Snakemake's records or without: it would keep both."""
    folder = finished / "results/tiny"
    paths = [folder / "data/quasi_static_map.nc", folder / "figures/fig07.png"]
    whole = [(path.read_bytes(), path.stat().st_mtime) for path in paths]
    records = finished / ".snakemake/metadata"
    foreign = load(paths[0])
    save(foreign.assign_attrs(key="f" * 16 + " data/quasi_static_map.nc"), paths[0])
    paths[1].write_bytes(whole[1][0][:1000])
    try:
        for recorded in (True, False):
            if not recorded:
                records.rename(finished / "aside")
            assert {"map_linear", "draw_linear"} <= set(reasons(finished))
            refused = snakemake(finished, "--configfile", TINY, "-n")
            assert refused.returncode != 0
            for path in paths:
                assert path.name in refused.stdout + refused.stderr
    finally:
        if (finished / "aside").exists():
            shutil.rmtree(records, ignore_errors=True)
            (finished / "aside").rename(records)
        for path, (content, date) in zip(paths, whole, strict=True):
            path.write_bytes(content)
            os.utime(path, (date, date))
