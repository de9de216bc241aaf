"""Arrays of a table as compiled code sees them, and as Python made them."""

import numba
import numpy as np
import pytest

from squealpipe import Contact, Parameters, Structure, simulate
from squealpipe.systems import integrate
from squealpipe.systems.linear import plan
from squealpipe.systems.taylor import layout
from squealpipe.systems.taylor.lanes import Workspace
from squealpipe.systems.taylor.memory import table_viewer


def declared(array, table):
    """Shape of an array by the sizes of a table."""

    def size(term):
        return int(term) if term.isdigit() else int(table[term][0])

    return tuple(sum(map(size, str(each).split("+"))) for each in array[1:])


def test_compiled_code_sees_the_arrays_of_a_table():
    arrays = {"cube": ("f8", "n", "n+2", 4), "whole": ("i8", "n+m+1"), "bare": ()}
    record = np.dtype([(name, "i8") for name in (*arrays, "n", "m")])
    at = table_viewer("table of this test", record, arrays)

    @numba.njit
    def read(address):
        t = at(address)
        t.whole[t.m] = t.bare
        return t.cube[1, 3, 2], t.cube.shape, t.whole.shape, t.cube[0, 1:, 3].sum()

    cube = np.arange(40.0).reshape(2, 5, 4)[:, :4].copy()
    whole = np.zeros(6, np.int64)
    memory = {"cube": cube, "whole": whole, "bare": np.zeros(1)}
    table = Workspace(record, memory, {"n": 2, "m": 3})
    value, *shapes, total = read(table.pointer.value)
    assert shapes == [cube.shape, whole.shape]
    assert value == cube[1, 3, 2]
    assert total == cube[0, 1:, 3].sum()
    assert whole.tolist() == [0, 0, 0, memory["bare"].ctypes.data, 0, 0]


@pytest.mark.parametrize("of_structures", [False, True])
def test_arrays_have_the_shapes_that_compiled_code_takes_them_to_have(
    of_structures, monkeypatch
):
    made = []

    def kept(record, *arguments):
        made.append((record, Workspace(record, *arguments)))
        return made[-1][1]

    module, record, arrays = integrate.lanes, layout.LOOP_TABLE, layout.LOOP_ARRAYS
    if of_structures:
        module, record, arrays = plan, plan.PLAN_TABLE, plan.ARRAYS
    monkeypatch.setattr(module, "Workspace", kept)
    if of_structures:
        names = "xyz"
        contacts = [
            Contact(name, {i: 1.0}, {i + 1: 1.0}, 2.0, preload=1.0)
            for i, name in enumerate(names)
        ]
        structure = Structure(
            np.eye(4), np.eye(4), contacts=contacts, mu=0.3, mu_static=0.5,
            friction_law="exponential", friction_speed=0.4,
        )  # fmt: skip
        system = structure.system()
        system.simulate(1.0, start=dict.fromkeys(system.states, 0.1))
    else:
        simulate(Parameters(), alpha1=2.6, alpha2=2.6, t_end=10.0)
    tables = [table for kind, table in made if kind == record]
    assert tables
    for table in tables:
        for name, array in arrays.items():
            shape = declared(array, table.table)
            if array and 0 not in shape:
                # one row is read as a vector
                assert (
                    table.arrays[name].squeeze().shape
                    == np.empty(shape).squeeze().shape
                )
                assert table.arrays[name].dtype == array[0]
