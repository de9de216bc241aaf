"""Compare two archives, runs, folders or files: equal, within tolerance or different, and where.

Idea: datasets are paired by name, brought onto what they share
(:mod:`squealpipe.store.comparison.matching`) and compared variable by variable, each with the
tolerance and the round-off that its schema states. What has one value on each side is compared;
what only one side has is told. Invariant: bad input gives a verdict, ``not_comparable`` with its
reason, and never a traceback.
"""

import json
import math
import os
import re
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import xarray as xr

from squealpipe.schema import DatasetSchema, Variable, meanings, schema_of
from squealpipe.store.comparison.curves import beside_the_curve
from squealpipe.store.comparison.differences import Agreement, VariableDifference, judge
from squealpipe.store.comparison.matching import Aligned, align, is_filler
from squealpipe.store.comparison.statements import StatementChange, changed_statements
from squealpipe.store.identity import VOLATILE_ATTRIBUTES
from squealpipe.store.netcdf import load
from squealpipe.store.runs import dataset_files, locate, matches_any, read_manifest
from squealpipe.store.yaml_files import flat


@dataclass(frozen=True, kw_only=True)
class DatasetDifference:
    """Comparison of one dataset; ``reason`` says why where it could not be compared.

    Attributes:
        compared: values that both sides have, of ``values`` of the larger one.
    """

    name: str
    verdict: Agreement
    variables: list[VariableDifference] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    compared: int = 0
    values: int = 0
    reason: str = ""

    @property
    def differences(self) -> list[VariableDifference]:
        """Variables beyond their tolerance, worst first; volatile ones are not judged."""
        judged = [entry for entry in self.variables if not entry.volatile]
        differing = [entry for entry in judged if entry.verdict >= Agreement.different]
        return sorted(differing, key=lambda entry: entry.severity, reverse=True)

    @property
    def severity(self) -> tuple[int, float, float]:
        """Severity of the worst variable; the larger, the worse."""
        if self.verdict == Agreement.not_comparable or not self.differences:
            return self.verdict, 0.0, 0.0
        return self.differences[0].severity


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Comparison of two places.

    Attributes:
        parameters: changed configuration key → values in a and b (None: the key is absent).
        environment: what else differs in how they were made: commit, versions, platform.
        statements: statements of the paper whose verdict or value changed.
        skipped: datasets that one side, an archive, deliberately left out.
        reason: why nothing could be compared, if so.
    """

    a: str
    b: str
    parameters: dict[str, tuple[Any, Any]] = field(default_factory=dict)
    environment: dict[str, tuple[Any, Any]] = field(default_factory=dict)
    datasets: list[DatasetDifference] = field(default_factory=list)
    statements: list[StatementChange] = field(default_factory=list)
    skipped: list[str] = field(default_factory=list)
    reason: str = ""

    @property
    def verdict(self) -> Agreement:
        """The worst of the datasets' verdicts."""
        if self.reason or not self.datasets:
            return Agreement.not_comparable
        return max(item.verdict for item in self.datasets)

    @property
    def exit_code(self) -> int:
        """0 equal or within tolerance, 1 different, 2 not comparable."""
        return {Agreement.different: 1, Agreement.not_comparable: 2}.get(
            self.verdict, 0
        )

    def as_dict(self) -> dict[str, Any]:
        """Return plain values for JSON; NaN and infinity become None."""
        whole = {**asdict(self), "verdict": self.verdict, "exit_code": self.exit_code}
        return _plain(whole)  # type: ignore[no-any-return]


def compare(
    a: str | os.PathLike[str],
    b: str | os.PathLike[str],
    *,
    root: str | os.PathLike[str] = ".",
) -> Comparison:
    """Compare two archives, runs, folders or files, dataset by dataset.

    Bad input gives a verdict, not an exception: ``not_comparable``, with its reason.
    """
    try:
        places = locate(a, root), locate(b, root)
        left, right = (dataset_files(place) for place in places)
        absent = [
            pattern
            for place in places
            for pattern in read_manifest(place).get("left_out", [])
        ]
    except (FileNotFoundError, ValueError) as error:
        return Comparison(a=str(a), b=str(b), reason=str(error))
    if len(left) == len(right) == 1 and (Path(a).is_file() or Path(b).is_file()):
        right = {next(iter(left)): next(iter(right.values()))}
    parameters: dict[str, tuple[Any, Any]] = {}
    environment: dict[str, tuple[Any, Any]] = {}
    datasets = []
    statements: list[StatementChange] = []
    skipped = {
        name
        for name in set(left) ^ set(right)
        if matches_any(f"data/{name}.nc", absent)
    }
    for name in sorted((set(left) | set(right)) - skipped):
        if name not in left or name not in right:
            reason = f"only in {a if name in left else b}"
            missing = DatasetDifference(
                name=name, verdict=Agreement.different, reason=reason
            )
            datasets.append(missing)
            continue
        try:
            first, second = load(left[name]), load(right[name])
        except ValueError as error:
            datasets.append(_refused(name, str(error)))
            continue
        parameters |= _changes(configuration(first), configuration(second))
        environment |= _changes(_environment(first), _environment(second))
        datasets.append(compare_datasets(name, first, second))
        if first.attrs["schema"] == second.attrs["schema"] == "claims":
            statements = changed_statements(first, second)
    # keys that say what is computed come first; the others say how, and on which grid
    physical_first = sorted(
        parameters,
        key=lambda key: (
            not re.match(r"(parameters\.|alpha\d|mode\b|scene\b|vary\.|fixed\.)", key),
            key,
        ),
    )
    return Comparison(
        a=str(a),
        b=str(b),
        parameters={key: parameters[key] for key in physical_first},
        statements=statements,
        environment=dict(sorted(environment.items())),
        datasets=datasets,
        skipped=sorted(skipped),
    )


def compare_datasets(name: str, a: xr.Dataset, b: xr.Dataset) -> DatasetDifference:
    """Compare two datasets of one schema, variable by variable, on what they share.

    Points of grids are matched by value, entries of lists as the schema's ``lists`` say.
    """
    of_a, of_b = a.attrs["schema"], b.attrs["schema"]
    if of_a != of_b:
        return _refused(name, f"the schemas are {of_a!r} and {of_b!r}")
    schema, schema_of_b = schema_of(a), schema_of(b)
    try:
        aligned = align(a, b, schema)
    except ValueError as error:
        return _refused(name, str(error))
    variables = _unmatched_entries(a, b, aligned, schema)
    compared = values = 0
    tables = (
        *(schema.coordinates, schema_of_b.coordinates),
        *(schema.variables, schema_of_b.variables),
    )
    for variable in dict.fromkeys(name for table in tables for name in table):
        entry = schema.lookup(variable) or schema_of_b.lookup(variable)
        sides = [variable in each.variables for each in (a, b)]
        sizes = [each[variable].size for each in (a, b) if variable in each.variables]
        if entry is None or not sizes:
            continue
        values += 0 if entry.volatile else max(sizes)
        if all(sides):
            difference_of_variable = _judged(variable, aligned, entry)
            variables.append(difference_of_variable)
            shared = aligned.a[variable].size
            compared += (
                0 if entry.volatile or not difference_of_variable.compared else shared
            )
        else:
            reason = f"only in the {'first' if sides[0] else 'second'}"
            alone = _differs(variable, reason)
            variables.append(replace(alone, volatile=entry.volatile))
    judged = [entry.verdict for entry in variables if not entry.volatile]
    return DatasetDifference(
        name=name,
        verdict=max(judged, default=Agreement.equal),
        variables=variables,
        notes=aligned.notes,
        compared=compared,
        values=values,
    )


def _judged(name: str, aligned: Aligned, entry: Variable) -> VariableDifference:
    """Compare one variable of both sides, if its dimensions, units, flags and type are the same."""
    pair = aligned.a[name], aligned.b[name]
    for what, (left, right) in (
        ("dimensions", [each.dims for each in pair]),
        ("units", [each.attrs.get("units", "1") for each in pair]),
        ("flags", [meanings(each) for each in pair]),
        ("type", ["text" if each.dtype.kind in "UOS" else "number" for each in pair]),
    ):
        if left != right:
            return _differs(name, f"{what} {left} against {right}")
    return judge(name, aligned.a, aligned.b, entry)


def _unmatched_entries(
    a: xr.Dataset, b: xr.Dataset, aligned: Aligned, schema: DatasetSchema
) -> list[VariableDifference]:
    """List the entries that lists of results have on one side alone; fillers must lie on the
    other's curve.
    """
    unmatched = []
    for dim, how in schema.lists.items():
        if dim not in aligned.alone:
            sizes = a.sizes.get(dim), b.sizes.get(dim)
            if sizes[0] != sizes[1]:
                reason = f"{sizes[0]} entries against {sizes[1]}"
                unmatched.append(_differs(f"number of {dim}", reason))
            continue
        alone, lengths, fillers = aligned.alone[dim], [], []
        for each, places in zip((a, b), alone, strict=True):
            fills = is_filler(each, how, dim)
            lengths.append(each.sizes[dim] - int(fills.sum()))
            fillers.append(places[fills[places]])
        rest = [len(at) - len(fill) for at, fill in zip(alone, fillers, strict=True)]
        if any(rest):
            reason = (
                f"{lengths[0]} entries against {lengths[1]}; "
                f"{rest[0]} and {rest[1]} of these have no counterpart"
            )
            unmatched.append(_differs(f"number of {dim}", reason))
        if any(map(len, fillers)):
            unmatched += beside_the_curve(
                a, b, dim, how, schema, (fillers[0], fillers[1])
            )
    return unmatched


def _differs(name: str, reason: str) -> VariableDifference:
    return VariableDifference(name=name, verdict=Agreement.different, reason=reason)


def _refused(name: str, reason: str) -> DatasetDifference:
    return DatasetDifference(name=name, verdict=Agreement.not_comparable, reason=reason)


def configuration(dataset: xr.Dataset) -> dict[str, Any]:
    """Return the configuration that made a dataset, by dotted key: the study's, else the call's."""
    stated = dataset.attrs
    if "config" in stated:
        return flat(json.loads(stated["config"]))
    return flat({"parameters": json.loads(stated.get("parameters", "{}"))})


def _environment(dataset: xr.Dataset) -> dict[str, Any]:
    """Return commit and platform by name, and the version of each library."""
    left_out = {"history", "wall_time_s", "inputs", "libraries", "key_content"}
    shown = VOLATILE_ATTRIBUTES - left_out
    stated = {key: dataset.attrs[key] for key in shown if key in dataset.attrs}
    return stated | flat(
        {"libraries": json.loads(dataset.attrs.get("libraries", "{}"))}
    )


def _changes(a: dict[str, Any], b: dict[str, Any]) -> dict[str, tuple[Any, Any]]:
    return {
        key: (a.get(key), b.get(key))
        for key in sorted(set(a) | set(b))
        if a.get(key) != b.get(key)
    }


def _plain(value: Any) -> Any:
    """Return a value as JSON takes it."""
    if isinstance(value, Agreement):
        return value.name
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
