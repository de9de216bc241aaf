"""Products of matrices with vectors, sixteen columns at a time, their sums in a fixed order."""

from typing import Any

from squealpipe.systems.compiled import inline, part
from squealpipe.systems.taylor.simd import ROW, fma, load, splat, store


@part
def write_columns(matrix: Any, by: Any, total: Any) -> None:
    """Write Σ_j matrix[j] by[j], sixteen columns at a time in registers, in a fixed order.

    Args:
        matrix: (rows, padded columns), aligned as in :mod:`.plan`.
        total: (padded columns), aligned.
    """
    to = total.ctypes.data
    for place in range(0, 8 * matrix.shape[1], ROW):
        store(to + place, _sum_of_rows(matrix, by, place))


@part
def add_columns(matrix: Any, by: Any, total: Any) -> None:
    """Add the same."""
    to = total.ctypes.data
    for place in range(0, 8 * matrix.shape[1], ROW):
        store(to + place, load(to + place) + _sum_of_rows(matrix, by, place))


@inline
def _sum_of_rows(matrix: Any, by: Any, place: int) -> Any:
    """Return Σ_j matrix[j] by[j] of some columns, by the offset of their first in bytes."""
    count, width = matrix.shape
    row, stride = matrix.ctypes.data + place, 8 * width
    # two sums, so that one addition need not wait for the other
    even, odd = splat(0.0), splat(0.0)
    for j in range(0, count - 1, 2):
        even = fma(load(row), splat(by[j]), even)
        odd = fma(load(row + stride), splat(by[j + 1]), odd)
        row += 2 * stride
    if count % 2:
        even = fma(load(row), splat(by[count - 1]), even)
    return even + odd


@part
def add_listed(matrix: Any, places: Any, count: int, by: Any, total: Any) -> None:
    """Add Σ_a matrix[places[a]] by[places[a]], likewise."""
    at, to, stride = matrix.ctypes.data, total.ctypes.data, 8 * matrix.shape[1]
    for place in range(0, stride, ROW):
        even, odd = load(to + place), splat(0.0)
        for a in range(0, count - 1, 2):
            i, j = places[a], places[a + 1]
            even = fma(load(at + i * stride + place), splat(by[i]), even)
            odd = fma(load(at + j * stride + place), splat(by[j]), odd)
        if count % 2:
            i = places[count - 1]
            even = fma(load(at + i * stride + place), splat(by[i]), even)
        store(to + place, even + odd)


@inline
def copy_numbers(numbers: Any, to: Any) -> None:
    """Write numbers into an array; places that are sums would be looked at for a sign each."""
    for i in range(to.size):
        to[i] = numbers[i]


@part
def add_row(row: Any, factor: float, total: Any) -> None:
    """Add a row times a factor."""
    for j in range(row.size):
        total[j] += row[j] * factor


@part
def add_sizes(matrix: Any, by: Any, total: Any) -> None:
    """Add Σ_j |matrix[j]| by[j], four rows at a time."""
    n, c = matrix.shape
    j = 0
    while j + 4 <= n:
        a, b, d, e = matrix[j], matrix[j + 1], matrix[j + 2], matrix[j + 3]
        x, y, z, w = by[j], by[j + 1], by[j + 2], by[j + 3]
        for i in range(c):
            total[i] += (abs(a[i]) * x + abs(b[i]) * y) + (
                abs(d[i]) * z + abs(e[i]) * w
            )
        j += 4
    while j < n:
        a, x = matrix[j], by[j]
        for i in range(c):
            total[i] += abs(a[i]) * x
        j += 1


@part
def dot(a: Any, b: Any) -> Any:
    """Return a scalar product over the length of the first, its four sums in a fixed order."""
    n = a.size
    s0, s1, s2, s3 = 0.0, 0.0, 0.0, 0.0
    j = 0
    while j + 4 <= n:
        s0 += a[j] * b[j]
        s1 += a[j + 1] * b[j + 1]
        s2 += a[j + 2] * b[j + 2]
        s3 += a[j + 3] * b[j + 3]
        j += 4
    while j < n:
        s0 += a[j] * b[j]
        j += 1
    return (s0 + s1) + (s2 + s3)


@part
def add_product(matrix: Any, full: int, by: Any, total: Any) -> None:
    """Add a product with a matrix, which is transposed, or with a diagonal."""
    if full:
        add_columns(matrix, by, total)
    else:
        diagonal = matrix[0]
        for i in range(by.size):
            total[i] += diagonal[i] * by[i]
