"""Modes of structures beyond a thousand degrees of freedom, against SciPy's own eigensolver."""

import re
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import eigs, splu

from squealpipe import Contact, Structure, load
from squealpipe.structures import modes, pencil
from squealpipe.structures.complex_modes import cost_beforehand
from squealpipe.structures.schema.structures import Onset
from squealpipe.structures.sliding import steady_sliding
from squealpipe.structures.squeal.plant import in_modes
from squealpipe.systems import one_thread as one_thread_module
from tests.oracles.elastic_block import elastic_block

ROOT = Path(__file__).resolve().parents[2]


def by_scipy(structure, closed, mu, number):
    """Eigenvalues of the lowest modes by SuperLU and ARPACK alone, without damping."""
    stiffness = sp.csc_array(structure.stiffness)
    for contact, shut in zip(structure.contacts, closed, strict=True):
        if shut:
            ((n, a),), ((t, b),) = contact.normal.items(), contact.tangential.items()
            rows, columns = [n, t], [n, n]
            values = contact.stiffness * np.array([a * a, mu * b * a])
            stiffness += sp.csc_array((values, (rows, columns)), stiffness.shape)
    squares = eigs(
        stiffness, number, sp.csc_array(structure.mass), 1e6, return_eigenvectors=False
    )
    roots = 1j * np.sqrt(squares.astype(complex))
    roots = np.where(roots.imag < 0, -roots, roots)
    return roots[np.lexsort((roots.real, roots.imag.round(3)))]


def eigenvalues(modes):
    values = modes.growth_rate.values + 2j * np.pi * modes.frequency.values
    return values[np.lexsort((values.real, values.imag.round(3)))]


def test_modes_of_a_block_with_many_contacts_are_those_of_scipy():
    block = elastic_block((12, 5, 4), contacts=20, mu=0.9)
    assert block.size > 1000
    started = time.process_time()
    modes = block.complex_modes(n_modes=12, critical=False)
    # it took minutes: modes were followed along friction, each step with new factors
    assert time.process_time() - started < 6.0
    assert (modes.onset == Onset.not_sought).all()
    assert np.isnan(modes.critical_mu).all()
    closed = modes.normal_force.values > 0
    theirs = by_scipy(block, closed, 0.9, 14)[:12]
    ours = eigenvalues(modes)
    assert ours == pytest.approx(theirs, rel=1e-8, abs=1e-4)
    assert modes.unstable.any()


@pytest.mark.release
@pytest.mark.parametrize("penalty", [1e20, 1e36])
def test_penalties_on_a_large_structure_are_the_rows_left_out(penalty):
    block = elastic_block((12, 5, 4), contacts=8, mu=0.6)
    touched = {k for each in block.contacts for k in (*each.normal, *each.tangential)}
    fixed = np.setdiff1d(np.arange(0, block.size, 40), sorted(touched))
    kept = np.setdiff1d(np.arange(block.size), fixed)
    diagonal = np.zeros(block.size)
    diagonal[fixed] = penalty
    held = block.with_(stiffness=block.stiffness + sp.diags_array(diagonal))
    place = {int(old): new for new, old in enumerate(kept)}
    contacts = [
        Contact(
            each.name,
            {place[k]: v for k, v in each.normal.items()},
            {place[k]: v for k, v in each.tangential.items()},
            each.stiffness,
            each.preload,
        )
        for each in block.contacts
    ]
    mass, stiffness = (
        matrix[kept][:, kept] for matrix in (block.mass, block.stiffness)
    )
    cut = Structure(mass, stiffness, contacts=contacts, mu=0.6)
    with_penalty, without = (
        each.complex_modes(n_modes=8, critical=False) for each in (held, cut)
    )
    assert with_penalty.frequency.values == pytest.approx(
        without.frequency.values, 1e-9
    )
    assert with_penalty.growth_rate.values == pytest.approx(
        without.growth_rate.values, rel=1e-6, abs=1e-4
    )
    assert with_penalty.attrs["fixed_degrees_of_freedom"] == len(fixed)


def test_steady_sliding_by_one_factorization_is_that_of_a_new_one_for_each_state():
    block = elastic_block((12, 5, 4), contacts=20)
    pull = 400.0 * block.normals[:, 3]  # one contact is pulled off
    block = block.with_(load=block.load + pull)
    for mu in (0.0, 0.3, 0.7):
        state = steady_sliding(block, mu, -2.0)
        acting = (block.normals - mu * block.tangentials) * state.closed
        springs = sp.csr_array(block.normals * block.stiffnesses)
        matrix = block.stiffness + sp.csr_array(acting) @ springs.T
        force = block.load + acting @ block.preloads
        expected = splu(sp.csc_array(matrix)).solve(force)
        assert state.displacement == pytest.approx(expected, rel=1e-9, abs=1e-16)
        assert not state.closed.all()


def test_the_cost_of_a_large_structure_is_told_beforehand():
    size = 100_000
    stiffness = sp.csr_array((size, size))
    told = cost_beforehand(SimpleNamespace(size=size, damping=stiffness), 1, 40)
    assert re.fullmatch(
        r"100,000 degrees of freedom: about \d+ min and [\d.]+ GB .*", told
    )
    assert cost_beforehand(SimpleNamespace(size=5000, damping=stiffness), 1, 40) is None


@pytest.mark.release
def test_modes_at_several_frictions_keep_their_numbers_without_those_between():
    block = elastic_block((12, 5, 4), contacts=8)
    frictions = [0.30, 0.31]
    modes = block.complex_modes(mu=frictions, n_modes=6, critical=False)
    assert modes.frequency.values[0] == pytest.approx(modes.frequency.values[1], 1e-2)


@pytest.mark.parametrize(
    "task",
    [
        lambda block: block.complex_modes(n_modes=4, critical=False),
        lambda block: block.reduce(frequency_max=5e3),
        lambda block: in_modes(block, None, 5e3),
    ],
    ids=["complex_modes", "reduce", "in_modes"],
)
def test_modes_of_a_large_structure_are_computed_by_one_thread(task, monkeypatch):
    """On two busy cores 15 modes of 1,188 degrees of freedom took 22 s of CPU instead of 0.9."""

    class Begun(Exception):  # noqa: N818 (no error)
        pass

    def begin(*_, **__):
        raise Begun(bool(one_thread_module._inside))

    monkeypatch.setattr(pencil, "splu", begin)
    monkeypatch.setattr(modes, "eigsh", begin)
    with pytest.raises(Begun) as caught:
        task(elastic_block((12, 5, 4), contacts=4, modal_damping=0.01))
    assert caught.value.args == (True,)


@pytest.mark.parametrize("value", [0, "no", None])
def test_what_is_no_switch_is_refused(value):
    contact = Contact("p", {1: 1.0}, {0: 1.0}, 1e5, 100.0)
    small = Structure(np.eye(2), np.diag([1e5, 2e5]), contacts=[contact])
    with pytest.raises(ValueError, match="critical"):
        small.complex_modes(critical=value)


@pytest.mark.release
@pytest.mark.parametrize(
    ("shape", "size", "contacts", "n_modes"),
    [
        ((33, 13, 3), 5_712, 49, 20),
        pytest.param((70, 17, 4), 19_170, 126, 40, marks=pytest.mark.long),
    ],
)
def test_thousands_of_degrees_of_freedom_take_few_factorizations_and_little_memory(
    shape, size, contacts, n_modes, tmp_path
):
    """In a process of its own: memory that other tests have taken would count.

    Seconds depend on what else a machine does: factorizations of complex pencils are counted, of
    which there must not be one for each contact or mode.
    """
    code = f"""
import re
from pathlib import Path
from squealpipe import save
from squealpipe.structures import pencil
from tests.oracles.elastic_block import elastic_block
factorize, factorized = pencil.splu, []
pencil.splu = lambda *given, **how: factorized.append(1) or factorize(*given, **how)
block = elastic_block({shape}, contacts={contacts}, mu=0.5)
modes = block.complex_modes(n_modes={n_modes}, critical=False)
assert 0 < len(factorized) <= 8, len(factorized)
peak = re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())
assert int(peak[1]) < 3e5 + 62 * {size}, peak[0]  # kB
save(modes, {str(tmp_path / "modes.nc")!r})
"""
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT)
    block = elastic_block(shape, contacts=contacts, mu=0.5)
    assert block.size == size
    modes = load(tmp_path / "modes.nc")
    closed = modes.normal_force.values > 0
    theirs = by_scipy(block, closed, 0.5, n_modes + 4)[:n_modes]
    assert eigenvalues(modes) == pytest.approx(theirs, rel=1e-8, abs=1e-4)
