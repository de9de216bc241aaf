"""Copies of the project and of a finished tiny study, for all tests of a file."""

import subprocess

import pytest


@pytest.fixture(scope="module")
def one_checkout(new_checkout, tmp_path_factory):
    """One for all tests of a file: the first Snakemake in a new one makes its byte code."""
    return new_checkout(tmp_path_factory.mktemp("one") / "squealpipe")


@pytest.fixture(scope="module")
def study_copy(tiny_study, tmp_path_factory):
    """A finished tiny study whose files may be edited; dates are kept."""
    copy = tmp_path_factory.mktemp("edited") / "squealpipe"
    subprocess.run(["cp", "-a", tiny_study.checkout, copy], check=True)
    return copy


@pytest.fixture
def finished(study_copy, monkeypatch):
    """The same, explained by its own workflow and package."""
    monkeypatch.setenv("PYTHONPATH", str(study_copy))
    home = "squealpipe.study.explain"
    monkeypatch.setattr(f"{home}.WORKFLOW", study_copy / "workflow")
    monkeypatch.setattr(f"{home}.PACKAGE", study_copy / "squealpipe")
    return study_copy


def pytest_itemcollected(item):
    """All tests of this folder start Snakemake: they belong to the release tier."""
    item.add_marker(pytest.mark.release)
