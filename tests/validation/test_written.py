"""What is written of integrators apart is what they answer."""

import json
from importlib import import_module

import pytest

from tests.oracles.written import answers, plain

WRITTEN = [(name, question) for name, known in answers().items() for question in known]


def leaves(value, path=()):
    """Place → number or text of a nested value."""
    if not isinstance(value, list | dict):
        return {path: value}
    items = value.items() if isinstance(value, dict) else enumerate(value)
    parts = [{path: len(value)}, *(leaves(item, (*path, key)) for key, item in items)]
    return {place: leaf for part in parts for place, leaf in part.items()}


@pytest.mark.release
@pytest.mark.parametrize(("name", "question"), WRITTEN)
def test_an_integrator_apart_answers_what_is_written(name, question):
    module, function = name.split(":")
    ask = getattr(import_module(module), function).__wrapped__
    found = leaves(plain(ask(*json.loads(question))))
    expected = leaves(answers()[name][question])
    assert found == {
        place: pytest.approx(leaf, rel=1e-8, abs=1e-8)
        if isinstance(leaf, float)
        else leaf
        for place, leaf in expected.items()
    }
