"""Two archives, runs, folders or files: what is equal, within tolerance or different; where."""

import json
import math
import os
import re
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import xarray as xr

from squealpipe.config.yaml_files import flat
from squealpipe.schema import schema_of
from squealpipe.schema.claims import CLAIMS
from squealpipe.store.comparison.differences import Agreement, VariableDifference, judge
from squealpipe.store.comparison.matching import align, judged_length
from squealpipe.store.comparison.statements import StatementChange, changed_statements
from squealpipe.store.identity import VOLATILE_ATTRIBUTES
from squealpipe.store.netcdf import load
from squealpipe.store.runs import (
    LEFT_OUT,
    dataset_files,
    locate,
    matches_any,
    read_manifest,
)

PHYSICAL_KEY = re.compile(r"(parameters\.|alpha\d|mode\b|scene\b|vary\.|fixed\.)")
"""Configuration keys that say what is computed; the others say how, and on which grid."""


@dataclass(frozen=True, kw_only=True)
class DatasetDifference:
    """Comparison of one dataset; ``reason`` says why where it could not be compared."""

    name: str
    verdict: Agreement
    variables: list[VariableDifference] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    reason: str = ""

    @property
    def differences(self) -> list[VariableDifference]:
        """Variables beyond their tolerance, worst first; volatile ones are not judged."""
        judged = [entry for entry in self.variables if not entry.volatile]
        found = [entry for entry in judged if entry.verdict >= Agreement.different]
        return sorted(found, key=lambda entry: entry.severity, reverse=True)

    @property
    def severity(self) -> tuple[int, float, float]:
        """That of the worst variable."""
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
        """Plain values for JSON: no NaN, no infinity."""
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
            for pattern in read_manifest(place).get(LEFT_OUT, [])
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
            pair = (load(left[name]), load(right[name]))
        except ValueError as error:
            datasets.append(_refused(name, str(error)))
            continue
        parameters |= _changes(*map(configuration, pair))
        environment |= _changes(*map(_environment, pair))
        datasets.append(compare_datasets(name, *pair))
        if pair[0].attrs["schema"] == pair[1].attrs["schema"] == CLAIMS.name:
            statements = changed_statements(*pair)
    physical_first = sorted(
        parameters, key=lambda key: (not PHYSICAL_KEY.match(key), key)
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
    kinds = (a.attrs["schema"], b.attrs["schema"])
    if kinds[0] != kinds[1]:
        return _refused(name, f"the schemas are {kinds[0]!r} and {kinds[1]!r}")
    schema = schema_of(a)
    variables = []
    for dim, how in schema.lists.items():
        first, second = (judged_length(each, dim, how) for each in (a, b))
        if first != second:
            variables.append(
                _differs(f"number of {dim}", f"{first} entries against {second}")
            )
    try:
        a, b, notes = align(a, b, schema)
    except ValueError as error:
        return _refused(name, str(error))
    for variable in map(str, [*schema.coordinates, *schema.variables]):
        entry, sides = (
            schema.lookup(variable),
            [variable in each.variables for each in (a, b)],
        )
        if entry is not None and all(sides):
            variables.append(judge(variable, a, b, entry))
        elif any(sides):
            variables.append(
                _differs(variable, f"only in the {'first' if sides[0] else 'second'}")
            )
    judged = [entry.verdict for entry in variables if not entry.volatile]
    verdict = max(judged, default=Agreement.equal)
    return DatasetDifference(
        name=name, verdict=verdict, variables=variables, notes=notes
    )


def _differs(name: str, reason: str) -> VariableDifference:
    return VariableDifference(name=name, verdict=Agreement.different, reason=reason)


def _refused(name: str, reason: str) -> DatasetDifference:
    return DatasetDifference(name=name, verdict=Agreement.not_comparable, reason=reason)


def configuration(dataset: xr.Dataset) -> dict[str, Any]:
    """Dotted key → value of what made a dataset: of the study's slice, else of the call."""
    stated = dataset.attrs
    if "config" in stated:
        return flat(json.loads(stated["config"]))
    return flat({"parameters": json.loads(stated.get("parameters", "{}"))})


def _environment(dataset: xr.Dataset) -> dict[str, Any]:
    """Commit, platform and the versions of the libraries one by one."""
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
    """A value as JSON takes it."""
    if isinstance(value, Agreement):
        return value.name
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
