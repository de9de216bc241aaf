"""Contacts of two faces by other means than the package: closed forms and minimization.

Areas by corner formulas of flat facets, nearest points by a bounded minimizer in each facet,
normals by sums over facets written out, matrices by scikit-fem.
"""

import numpy as np
import scipy.linalg as la
from scipy.optimize import minimize

CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])


def brake(nr=2, nth=8, nz=1, pad_r=(0, 2), pad_th=(0, 3), pnz=1, cone=0.0, shift=0.0):
    """A disc, z < 0, and a pad on it: nodes {number: position}, hexahedra, faces; m.

    Faces are lists of node numbers, outwards.
    """
    radii = np.linspace(0.06, 0.12, nr + 1)
    angles = np.arange(nth) * 2 * np.pi / nth
    nodes = {}

    def grid(first, i, j, k, turn, heights):
        numbers = {}
        for where in ((a, b, c) for c in k for b in j for a in i):
            number = first + len(numbers) + 1
            numbers[where] = number
            r, angle = radii[where[0]], angles[where[1]] + turn
            z = heights[where[2]] + cone * (r - radii[0])
            nodes[number] = np.array([r * np.cos(angle), r * np.sin(angle), z])
        return numbers

    disc = grid(
        0, range(nr + 1), range(nth), range(nz + 1), 0.0, np.linspace(-0.01, 0, nz + 1)
    )
    pad = grid(
        5000,
        range(pad_r[0], pad_r[1] + 1),
        range(*pad_th),
        range(pnz + 1),
        shift,
        np.linspace(0, 0.015, pnz + 1),
    )

    def hexahedra(numbers, i, j, k):
        return {
            (a, b, c): [
                numbers[a + da, (b + db) % nth, c + dc]
                for dc in (0, 1)
                for da, db in ((0, 0), (1, 0), (1, 1), (0, 1))
            ]
            for c in k
            for b in j
            for a in i
        }

    of_disc = hexahedra(disc, range(nr), range(nth), range(nz))
    of_pad = hexahedra(pad, range(*pad_r), range(pad_th[0], pad_th[1] - 1), range(pnz))
    faces = {
        "DISC": [row[4:] for place, row in of_disc.items() if place[2] == nz - 1],
        "PAD": [row[3::-1] for place, row in of_pad.items() if place[2] == 0],
    }
    return nodes, [*of_disc.values(), *of_pad.values()], faces


def deck(nodes, hexahedra, faces):
    """The same as a deck of CalculiX, with shuffled capitals, and surfaces by faces."""
    lines = ["*HEADING", "a brake, ** of the tests", "*Node, nset=all"]
    lines += [f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in _plain(nodes)]
    lines.append("*ELEMENT, Type=c3d8r, ELSET=BODY")
    lines += [f"{e}, " + ", ".join(map(str, row)) for e, row in enumerate(hexahedra, 1)]
    sides = (
        [0, 1, 2, 3],
        [4, 5, 6, 7],
        [0, 1, 5, 4],
        [1, 2, 6, 5],
        [2, 3, 7, 6],
        [3, 0, 4, 7],
    )
    for name, facets in faces.items():
        lines.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
        for facet in facets:
            for e, row in enumerate(hexahedra, 1):
                if set(facet) <= set(row):
                    side = next(
                        s
                        for s, places in enumerate(sides, 1)
                        if {row[p] for p in places} == set(facet)
                    )
                    lines.append(f"{e}, S{side}")
    return "\n".join(lines) + "\n"


def _plain(nodes):
    return [(n, tuple(map(float, position))) for n, position in nodes.items()]


def solid_matrices(nodes, hexahedra, young=1e11, density=7000.0, poisson=0.3):
    """Mass and stiffness of all bodies on weak springs; row 3 i + d of the i-th node."""
    from skfem import Basis, BilinearForm, ElementHex1, ElementVector, MeshHex
    from skfem.helpers import ddot, dot, eye, sym_grad, trace

    order = {n: i for i, n in enumerate(nodes)}
    # skfem counts the corners of its cube otherwise
    swap = [0, 1, 3, 4, 2, 5, 7, 6]
    rows = np.array([[order[row[p]] for p in swap] for row in hexahedra])
    mesh = MeshHex(np.array(list(nodes.values())).T, rows.T)
    basis = Basis(mesh, ElementVector(ElementHex1()), intorder=3)
    first = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
    shear = young / (2 * (1 + poisson))

    @BilinearForm
    def elasticity(u, v, _):
        stress = 2 * shear * sym_grad(u) + first * eye(trace(sym_grad(u)), 3)
        return ddot(stress, sym_grad(v))

    @BilinearForm
    def inertia(u, v, _):
        return density * dot(u, v)

    place = basis.nodal_dofs.T.ravel()
    mass, stiffness = (
        form.assemble(basis).toarray()[np.ix_(place, place)]
        for form in (inertia, elasticity)
    )
    return mass, stiffness + 1e6 * np.eye(len(mass))


def vector_area(corners):
    """∫ n dA of a facet of three or four corners, written out."""
    if len(corners) == 3:
        return 0.5 * np.cross(corners[1] - corners[0], corners[2] - corners[0])
    return 0.5 * np.cross(corners[2] - corners[0], corners[3] - corners[1])


def corner_shares(corners):
    """∫ N dA of a flat facet: a third each, or by the linear Jacobian of a quadrilateral."""
    if len(corners) == 3:
        return np.full(3, np.linalg.norm(vector_area(corners)) / 3)
    unit = vector_area(corners) / np.linalg.norm(vector_area(corners))
    a, b, c = (
        signs @ corners / 4
        for signs in ([-1, 1, 1, -1], [-1, -1, 1, 1], [1, -1, 1, -1])
    )
    # x = … + a ξ + b η + c ξη: J = n · ((a + c η) × (b + c ξ)), linear in ξ and η
    constant = unit @ np.cross(a, b)
    by_xi, by_eta = unit @ np.cross(a, c), unit @ np.cross(c, b)
    return constant + (CORNERS[:, 0] * by_xi + CORNERS[:, 1] * by_eta) / 3


def shape(corners, place):
    if len(corners) == 3:
        return np.array([1 - place[0] - place[1], *place])
    return np.prod(1 + CORNERS * place, axis=1) / 4


def nearest(point, facets, nodes):
    """Nearest point in all facets: distance, nodes, weights, facet."""
    best = None
    for facet in facets:
        corners = np.array([nodes[n] for n in facet])
        scale = np.linalg.norm(corners[0] - corners[1])

        def square(place, corners=corners, scale=scale):
            gap = (shape(corners, place) @ corners - point) / scale
            return gap @ gap

        if len(facet) == 3:
            kwargs = {
                "bounds": [(0, 1)] * 2,
                "method": "SLSQP",
                "constraints": {"type": "ineq", "fun": lambda p: 1 - p.sum()},
            }
            start = [0.3, 0.3]
        else:
            kwargs, start = {"bounds": [(-1, 1)] * 2, "method": "L-BFGS-B"}, [0.0, 0.0]
        found = minimize(square, start, tol=1e-18, **kwargs)
        distance = np.sqrt(found.fun) * scale
        if best is None or distance < best[0] - 1e-9 * scale:
            best = distance, facet, shape(corners, found.x), corners
    return best


def contacts(nodes, own, other, row_of, motion, per_area, pressure):
    """Normal and tangential directions, stiffnesses, preloads and speeds of all contacts.

    Args:
        own, other: facets of both faces, lists of node numbers, outwards.
        row_of: (node, direction from 1) → row.
        motion: velocity of `other` at a point and unit speed.
    """
    area = {}
    for facet in own:
        for n, share in zip(
            facet, corner_shares(np.array([nodes[n] for n in facet])), strict=True
        ):
            area[n] = area.get(n, 0.0) + share
    result = []
    for n in sorted(area):
        point = nodes[n]
        match = [
            m
            for facet in other
            for m in facet
            if np.allclose(nodes[m], point, atol=1e-9)
        ]
        if match:
            weights = {match[0]: 1.0}
            around = [facet for facet in other if match[0] in facet]
            normal = sum(
                vector_area(np.array([nodes[m] for m in facet])) for facet in around
            )
            place = nodes[match[0]]
        else:
            _, facet, values, corners = nearest(point, other, nodes)
            weights = dict(zip(facet, values, strict=True))
            normal, place = vector_area(corners), values @ corners
        normal = normal / np.linalg.norm(normal)
        velocity = motion(place)
        along = velocity - (velocity @ normal) * normal
        along = along / np.linalg.norm(along)
        columns = []
        for vector in (normal, along):
            column = np.zeros(len(row_of))
            for d in range(3):
                column[row_of[n, d + 1]] += vector[d]
                for m, weight in weights.items():
                    column[row_of[m, d + 1]] -= weight * vector[d]
            columns.append(column)
        result.append(
            (*columns, per_area * area[n], pressure * area[n], np.linalg.norm(velocity))
        )
    normals, tangentials, *numbers = zip(*result, strict=True)
    return np.array(normals).T, np.array(tangentials).T, *map(np.array, numbers)


def modes(mass, stiffness, normals, tangentials, springs, preloads, mu):
    """Eigenvalues about steady sliding and its normal forces, dense, all contacts closed."""
    acting = normals + mu * tangentials
    closed = stiffness + (acting * springs) @ normals.T
    force = (acting - normals) @ preloads
    forces = preloads - springs * (normals.T @ la.solve(closed, force))
    squares = la.eigvals(la.solve(mass, closed))
    return np.sqrt(-squares.astype(complex)), forces
