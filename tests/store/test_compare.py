"""Comparison: equal, within tolerance, different or refused; where, how much, and which flags."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from squealpipe import Parameters, Sweep, backbone, run_sweep, simulate
from squealpipe.paper.schema.claims import claims_schema
from squealpipe.schema import DatasetSchema, Variable, build, find
from squealpipe.store import load, save
from squealpipe.store.comparison.compare import Comparison, compare, compare_datasets
from squealpipe.store.comparison.differences import Agreement, difference
from squealpipe.store.comparison.lines import lines
from squealpipe.store.comparison.matching import align
from squealpipe.study.archive import archive


def edited(path, change):
    """A copy of a dataset file, changed by a function and written beside it."""
    dataset = load(path)
    change(dataset)
    return save(dataset, path.with_name("edited.nc"))


@pytest.fixture
def dataset_file(run):
    return run / "results/data/stability_map.nc"


def test_two_runs_of_one_configuration_are_equal(tmp_path, write_run):
    a, b = write_run(tmp_path / "a"), write_run(tmp_path / "b")
    found = compare(a / "results", b / "results")
    assert (found.verdict, found.exit_code, found.parameters) == (
        Agreement.equal,
        0,
        {},
    )
    assert (
        json.loads(json.dumps(found.as_dict(), allow_nan=False))["verdict"] == "equal"
    )


def test_archives_by_name_runs_and_files_can_be_mixed(run, dataset_file, keys_of):
    archive("one", keys=keys_of(run), root=run)
    for a, b in [
        ("one", run / "results"),
        ("one", run / "results/data"),
        (dataset_file,) * 2,
    ]:
        assert compare(a, b, root=run).exit_code == 0


def shifted(dataset):
    dataset["growth_rate"][...] = dataset.growth_rate * (1 + 1e-12)


def moved(dataset):
    dataset["growth_rate"][3, 7] += 0.25
    dataset["growth_rate"][4, 1] -= 0.125


def flipped(dataset):
    stable = dataset.regime_linear.values.ravel() == 0
    dataset.regime_linear.values.ravel()[np.flatnonzero(stable)[:4]] = 2


def test_round_off_agrees_and_the_largest_difference_its_place_and_flags_are_told(
    dataset_file,
):
    found = compare(dataset_file, edited(dataset_file, shifted))
    assert (found.verdict, found.exit_code) == (Agreement.within_tolerance, 0)
    for change, name, count in (
        (moved, "growth_rate", 2),
        (flipped, "regime_linear", 4),
    ):
        found = compare(dataset_file, edited(dataset_file, change))
        assert found.exit_code == 1
        entry = next(v for v in found.datasets[0].variables if v.name == name)
        assert entry.differing == count
        if change is flipped:
            assert entry.flips == {"stable → divergence": 4}
            continue
        assert entry.largest_absolute == pytest.approx(0.25)
        assert entry.where == pytest.approx(
            {"alpha1": np.pi / 4, "alpha2": 7 * np.pi / 12}
        )


@pytest.mark.parametrize(
    ("factor", "verdict"),
    [(1 + 1e-10, Agreement.within_tolerance), (1 + 1e-8, Agreement.different)],
)
def test_nine_digits_are_held_against_each_other(dataset_file, factor, verdict):
    """In digits and not in the schema's tolerances, which may be edited too."""
    one, other = load(dataset_file), load(dataset_file)
    other["growth_rate"] = one.growth_rate * factor
    assert compare_datasets("map", one, other).verdict == verdict


def ensemble(values, dims=("x0", "k"), **more):
    """Final states of a system of one's own, whose dataset is its own table."""
    coords = {"x0": [0.0, 1.0, 2.0], "k": [0.5, 0.75, 1.0]}
    return xr.Dataset(
        {"x": (dims, values, {"units": "m"}), **more},
        coords,
        {"schema": "system ensemble", "schema_version": 1, "title": "an ensemble"},
    )


def both_ways(a, b):
    """The verdict, which is the same in both directions, and what was found in one of them."""
    found, back = compare_datasets("one", a, b), compare_datasets("one", b, a)
    assert found.verdict == back.verdict
    assert (found.compared, found.values) == (back.compared, back.values)
    return found.verdict, found


def test_dimensions_are_aligned_by_name():
    values = np.arange(9.0).reshape(3, 3)
    a = ensemble(values)
    assert both_ways(a, a.transpose("k", "x0"))[0] == Agreement.equal
    assert both_ways(a, ensemble(values, ("k", "x0")))[0] == Agreement.different
    assert both_ways(a, a.isel(k=[2, 0, 1]))[0] == Agreement.equal


def test_what_one_side_alone_has_is_a_difference_in_both_directions():
    a = ensemble(np.eye(3))
    more = ensemble(np.eye(3), energy=("x0", [1.0, 2.0, 3.0]))
    assert both_ways(a, more)[0] == Agreement.different
    assert both_ways(a, a.drop_vars("k"))[0] == Agreement.different


@pytest.mark.parametrize(
    ("change", "verdict"),
    [
        (lambda d: d.assign(x=d.x.astype("f4")), Agreement.equal),
        (lambda d: d.assign(x=d.x.astype(int)), Agreement.equal),
        (lambda d: d.assign(x=d.x.astype(str)), Agreement.different),
        (lambda d: d.assign(x=d.x.assign_attrs(units="mm")), Agreement.different),
        (lambda d: d.assign(x=d.x.astype(int) + 1), Agreement.different),
    ],
)
def test_types_and_units_are_judged_by_what_they_mean(change, verdict):
    assert both_ways(ensemble(np.eye(3)), change(ensemble(np.eye(3))))[0] == verdict


def test_a_kind_of_event_that_changed_is_a_difference():
    run = simulate(Parameters(), 2.6, 2.6, t_end=30)
    other = run.copy(deep=True)
    other.event_kind[3] = 1 - int(other.event_kind[3])
    assert both_ways(run, other)[0] == Agreement.different


def test_a_chart_without_one_of_its_parameters_is_compared_all_the_same():
    """The parameter along which its points are matched is named by a text."""
    lines = {"line": [0, 0, 1], "curve": [0, 0, 1]}
    chart = xr.Dataset(
        {
            name: ("point", values)
            for name, values in (lines | {"mu": [1.0, 2, 3]}).items()
        },
        {"parameter": ["kappa", "mu"]},
    )
    fewer = chart.isel(point=[0, 2])
    found = align(chart, fewer, find("regime_chart"))
    assert found.alone["point"][0].tolist() == [1]


def test_how_much_was_compared_is_said(tmp_path, write_run):
    a, b = write_run(tmp_path / "a", points=3), write_run(tmp_path / "b", points=181)
    found = compare(a / "results", b / "results")
    told = "\n".join(lines(found))
    assert (
        f"{found.datasets[0].compared:,} of {found.datasets[0].values:,} values" in told
    )
    assert found.datasets[0].values > 181**2 > 1000 * 9 > found.datasets[0].compared / 2
    assert "alpha1: compared on 3 shared points of 3 and 181" in told


def test_a_screenful_says_how_many_lines_it_leaves_out():
    changed = {f"parameters.k{n}": (n, n + 1) for n in range(9)}
    few, every = (
        lines(Comparison(a="a", b="b", parameters=changed), every=every)
        for every in (False, True)
    )
    shown = [line for line in few if "parameters.k" in line]
    assert f"  and {9 - len(shown)} more; --all shows them" in few
    assert 1 < len(shown) < 9
    assert sum("parameters.k" in line for line in every) == 9


def test_coarse_and_fine_grids_are_aligned(tmp_path, write_run):
    a, b = write_run(tmp_path / "a", points=13), write_run(tmp_path / "b", points=37)
    found = compare(a / "results", b / "results")
    assert found.exit_code == 0
    assert (
        found.datasets[0].notes[0]
        == "alpha1: compared on 13 shared points of 13 and 37"
    )
    assert found.parameters == {"linear.points": (13, 37)}


def test_grids_without_common_points_are_refused(dataset_file):
    dataset = load(dataset_file)
    alpha1 = (dataset.alpha1 + 0.01).assign_attrs(dataset.alpha1.attrs)
    path = save(
        dataset.assign_coords(alpha1=alpha1), dataset_file.with_name("moved.nc")
    )
    found = compare(dataset_file, path)
    assert found.exit_code == 2
    assert "the grids of alpha1 share 0 of 13 and 13 points" in found.datasets[0].reason


@pytest.mark.parametrize(("shift", "code"), [(1e-13, 0), (1e-6, 2)])
def test_grid_points_are_the_same_to_nine_digits(dataset_file, shift, code):
    dataset = load(dataset_file)
    moved_grid = (dataset.alpha1 + shift).assign_attrs(dataset.alpha1.attrs)
    path = dataset_file.with_name("moved.nc")
    save(dataset.assign_coords(alpha1=moved_grid), path)
    assert compare(dataset_file, path).exit_code == code


def test_flags_of_another_meaning_are_a_difference():
    flags = {"flag_values": np.array([0, 1], "i1"), "units": "1"}
    words = ["rest cycle", "cycle rest"]
    sides = [
        ensemble(
            np.eye(3),
            outcome=(
                ("x0", "k"),
                np.zeros((3, 3), "i1"),
                {**flags, "flag_meanings": each},
            ),
        )
        for each in words
    ]
    assert both_ways(sides[0], sides[0])[0] == Agreement.equal
    assert both_ways(*sides)[0] == Agreement.different


@pytest.fixture(scope="module")
def branch():
    """Of cycles, of which the continuation's steps choose the points."""
    root = Path(__file__).parents[2]
    return load(root / "results/archive/reference/data/cycles/branch_F3_down.nc")


@pytest.mark.parametrize(
    ("off", "verdict"), [(0.0, Agreement.within_tolerance), (0.05, Agreement.different)]
)
def test_a_point_that_one_branch_has_more_lies_on_the_other_or_is_a_difference(
    branch, off, verdict
):
    smooth = 4
    rest = [place for place in range(branch.sizes["point"]) if place != smooth]
    more = branch.copy(deep=True)
    more.period[smooth] += off * float(np.ptp(branch.period.values))
    assert both_ways(branch.isel(point=rest), more)[0] == verdict


def test_where_no_curve_can_be_drawn_through_the_others_a_point_more_is_a_difference(
    branch,
):
    coarse = 14
    rest = [place for place in range(branch.sizes["point"]) if place != coarse]
    assert both_ways(branch.isel(point=rest), branch)[0] == Agreement.different


def test_points_that_all_moved_off_a_branch_are_a_difference(branch):
    moved_off = branch.copy(deep=True)
    for name in ("x_max", "y_max"):
        moved_off[name][2:] *= 1.5
    assert both_ways(branch, moved_off)[0] == Agreement.different


def test_missing_datasets_are_a_difference(tmp_path, write_run):
    a, b = write_run(tmp_path / "a"), write_run(tmp_path / "b")
    shutil.copy(a / "results/data/stability_map.nc", a / "results/data/second.nc")
    found = compare(a / "results", b / "results")
    assert found.exit_code == 1
    assert next(d for d in found.datasets if d.name == "second").reason.startswith(
        "only in"
    )


def test_damaged_and_foreign_files_are_not_comparable(dataset_file, tmp_path):
    damaged = tmp_path / "damaged.nc"
    damaged.write_bytes(dataset_file.read_bytes()[:-2000])
    foreign = tmp_path / "foreign.nc"
    xr.Dataset({"x": ("t", [1.0])}).to_netcdf(foreign)
    for other, reason in [
        (damaged, "changed or damaged"),
        (foreign, "another program wrote it"),
    ]:
        found = compare(dataset_file, other)
        assert found.exit_code == 2
        assert reason in found.datasets[0].reason
    assert compare(dataset_file, tmp_path / "nothing").exit_code == 2
    assert (
        "no archive, folder or file"
        in compare(dataset_file, tmp_path / "nothing").reason
    )
    empty = tmp_path / "empty"
    empty.mkdir()
    assert "holds no dataset" in compare(dataset_file, empty).reason


TABLE = DatasetSchema(
    name="probe",
    title="Probe",
    coordinates={"t": Variable(dims=("t",), units="s")},
    variables={
        "x": Variable(dims=("t",), nan_allowed=True, rtol=1e-3, atol=1e-6),
        "wall": Variable(volatile=True, optional=True),
        "event": Variable(dims=("event",), optional=True),
    },
)


def one(a, b, **entry):
    entry = Variable(dims=("t",), nan_allowed=True, **entry)
    return difference("x", xr.DataArray(a, dims="t"), xr.DataArray(b, dims="t"), entry)


@pytest.mark.parametrize(
    ("a", "b", "verdict"),
    [
        ([np.nan], [np.nan], Agreement.equal),
        ([np.inf], [np.inf], Agreement.equal),
        ([0.0], [-0.0], Agreement.equal),
        ([np.nan], [1.0], Agreement.different),
        ([np.inf], [-np.inf], Agreement.different),
        ([np.inf], [1e308], Agreement.different),
        ([1.0], [1.0005], Agreement.within_tolerance),
        ([1.0], [1.002], Agreement.different),
        ([0.0], [5e-7], Agreement.within_tolerance),
        ([0.0], [5e-6], Agreement.different),
        ([1e308], [-1e308], Agreement.different),
        ([], [], Agreement.equal),
    ],
)
def test_verdicts_at_the_edges(a, b, verdict):
    assert one(a, b, rtol=1e-3, atol=1e-6).verdict == verdict
    assert one(b, a, rtol=1e-3, atol=1e-6).verdict == verdict


def test_text_and_lists_of_different_length():
    assert one(["a", "b"], ["a", "c"]).verdict == Agreement.different
    longer = one([1.0, 2.0, 3.0], [1.0, 2.0])
    assert longer.verdict == Agreement.different
    assert "3 against 2 along t" in longer.reason


def test_volatile_variables_are_no_part_of_the_verdict(monkeypatch):
    monkeypatch.setattr(
        "squealpipe.store.comparison.compare.schema_of", lambda _: TABLE
    )
    a = build(TABLE, {"x": [1.0, 2.0], "wall": 3.0}, {"t": [0.0, 1.0]})
    b = build(TABLE, {"x": [1.0, 2.0], "wall": 4.0}, {"t": [0.0, 1.0]})
    found = compare_datasets("probe", a, b)
    assert found.verdict == Agreement.equal
    assert (
        next(v for v in found.variables if v.name == "wall").verdict
        == Agreement.different
    )
    c = build(TABLE, {"x": [1.0, 2.0], "event": [1.0]}, {"t": [0.0, 1.0]})
    assert compare_datasets("probe", a, c).verdict == Agreement.different


def test_alignment_is_by_value_not_by_position():
    a = xr.Dataset({"x": ("t", [1.0, 2.0, 3.0])}, {"t": [0.0, 1.0, 2.0]})
    b = xr.Dataset({"x": ("t", [3.0, 1.0])}, {"t": [2.0 + 1e-12, 0.0]})
    found = align(a, b)
    np.testing.assert_array_equal(found.a.x, [1.0, 3.0])
    np.testing.assert_array_equal(found.b.x, [1.0, 3.0])
    assert found.notes == ["t: compared on 2 shared points of 3 and 2"]
    names = xr.Dataset({"x": ("s", [1, 2])}, {"s": ["F3", "F2a"]})
    others = xr.Dataset({"x": ("s", [2, 1])}, {"s": ["F2a", "F3"]})
    found = align(names, others)
    np.testing.assert_array_equal(found.a.x, found.b.x)


def test_a_grid_may_hold_a_point_twice():
    grids = [0.0, 1.0, 2.0], [0.0, 1.0, 1.0, 2.0]
    both = (xr.Dataset({"x": ("t", grid)}, {"t": grid}) for grid in grids)
    assert align(*both).b.x.values.tolist() == grids[0]


def test_events_are_matched_by_order_and_kind():
    """A run with other parameters has other events; the n-th of a kind means the n-th."""
    runs = [simulate(Parameters(mu=mu), 2.6, 2.6, t_end=30) for mu in (0.3, 0.1)]
    shorter = runs[0].isel(event=slice(1, None))
    found = compare_datasets("run", runs[0], shorter)
    assert found.verdict == Agreement.different
    assert any("matched by kind and order" in note for note in found.notes)
    times = [
        each.event_time.values[each.event_kind.values == 0]
        for each in (runs[0], shorter)
    ]
    entry = next(v for v in found.variables if v.name == "event_time")
    shared = min(map(len, times))
    largest = np.abs(times[0][:shared] - times[1][:shared]).max()
    assert entry.largest_absolute >= largest
    assert any(v.name == "number of event" for v in found.differences)
    assert compare_datasets("run", *runs).verdict == Agreement.different


def test_special_points_of_a_branch_are_matched_with_the_nearest_of_their_kind():
    """A point more on one side is told; the others still compare with their own."""
    branch = backbone(Parameters(), 0.3 * np.pi, 0.9 * np.pi, mode=1, y_peak_max=6.5)
    assert branch.sizes["special"] >= 2
    fewer = branch.isel(special=slice(1, None))
    fewer = fewer.assign_coords(special=branch.special[:-1])
    found = compare_datasets("branch", branch, fewer)
    assert [entry.name for entry in found.differences] == ["number of special"]
    none = branch.isel(special=slice(0))
    for pair in ((branch, none), (none, branch), (none, none)):
        assert compare_datasets("branch", *pair).verdict < Agreement.not_comparable


def test_ragged_sweeps_compare():
    def swept(values):
        fixed = {"alpha1": 0.9, "alpha2": 2.8, "mode": 1, "y_peak_max": 1.3}
        plan = {"task": "backbone", "vary": {"k3": values}, "fixed": fixed}
        return run_sweep(Sweep(params=Parameters(), **plan))

    first, second = swept([0.6, 0.75]), swept([0.6, 0.75, 0.9])
    assert compare_datasets("sweep", first, first).verdict == Agreement.equal
    found = compare_datasets("sweep", first, second)
    assert found.verdict == Agreement.equal
    assert "k3: compared on 2 shared points of 2 and 3" in found.notes
    cut = first.isel(point=slice(-1))
    assert compare_datasets("sweep", first, cut).verdict < Agreement.not_comparable


def test_physical_keys_come_before_those_of_grids(tmp_path, write_run):
    a, b = write_run(tmp_path / "a"), write_run(tmp_path / "b", mu=0.4, points=7)
    found = compare(a / "results", b / "results")
    assert list(found.parameters.items()) == [
        ("parameters.mu", (0.3, 0.4)),
        ("linear.points", (13, 7)),
    ]
    assert found.exit_code == 1


def test_statements_that_changed_are_told_with_verdict_and_value(tmp_path):
    claims = ["A", "B", "C"]
    names = "statement section check relation evidence dataset corrected_evidence"
    text = dict.fromkeys(names.split(), ["t"] * 3)
    judged = {"a": ([0, 0, 2], [1, 2, np.nan]), "b": ([0, 2, 2], [1.1, 2, np.nan])}
    for place, (verdict, value) in judged.items():
        numbers = dict.fromkeys(("threshold", "feasible_share"), [1.0] * 3)
        flags = dict.fromkeys(
            ("recorded", "basis", "origin", "feasible_count"), [0] * 3
        )
        flags |= {"verdict": verdict, "verdict_here": verdict}
        flags |= {"corrected_verdict": verdict, "corrected_value": value}
        data = {
            **text,
            **numbers,
            **flags,
            "value": value,
            "figure": ["fig02", "fig03", ""],
        }
        save(
            build(claims_schema, data, {"claim": claims}),
            tmp_path / place / "data/claims.nc",
        )
    found = compare(tmp_path / "a", tmp_path / "b").statements
    assert [change.claim for change in found] == ["B", "A"]
    assert [change.verdict_changed for change in found] == [True, False]
    assert found[0].verdicts == ("holds", "fails")
    assert found[1].values == (1.0, 1.1)


def test_a_statement_in_other_words_is_no_other_result():
    """One edited docstring of a check made a study differ from its archive."""
    root = Path(__file__).parents[2]
    stored = load(root / "results/archive/reference/data/claims.nc")
    for name, verdict in (
        ("check", Agreement.within_tolerance),
        ("statement", Agreement.within_tolerance),
        ("relation", Agreement.different),
        ("section", Agreement.different),
    ):
        other = stored.copy(deep=True)
        other[name] = other[name].astype(object)
        other[name][0] = "other words"
        found = compare_datasets("claims", stored, other)
        assert found.verdict is verdict, name
        (entry,) = [each for each in found.variables if each.differing]
        assert (entry.name, entry.verdict) == (name, verdict)


def test_a_backbone_traced_in_other_steps_is_the_same_curve():
    """Its points lie where steps ended: without three of them it is still the same curve."""
    whole = backbone(Parameters(), 0.9, 2.8, mode=1, y_peak_max=3.0)
    fewer = whole.isel(point=np.delete(np.arange(whole.sizes["point"]), [-15, -10, -5]))
    found = compare_datasets("backbone", whole, fewer)
    assert found.verdict is Agreement.within_tolerance
    last = whole.sizes["point"] - 1
    twice = whole.isel(point=np.sort(np.append(np.arange(last + 1), last - 10)))
    itself = compare_datasets("backbone", twice, twice)
    assert itself.verdict is not Agreement.different
    moved = fewer.assign(omega=fewer.omega * (1 + 1e-3 * (fewer.point > 20)))
    assert compare_datasets("backbone", whole, moved).verdict is Agreement.different
