"""Variables of a mesh in the datasets of a structure: pictures need nothing else."""

from squealpipe.schema import Variable, count, or_nan

mesh_entries = {
    "node_position": Variable(
        "position of the node", "m", ("node", "axis"), optional=True
    ),
    "facet_node": count(
        "index of the node, from 0, at each corner of a facet; -1: it has fewer corners",
        "facet",
        "corner",
        optional=True,
    ),
    "moving_node": count(
        "index of the node, from 0, of the degree of freedom; -1: none",
        "degree_of_freedom",
        optional=True,
    ),
    "moving_direction": count(
        "direction of the degree of freedom: 1 to 3 along x, y, z, 4 to 6 about them",
        "degree_of_freedom",
        optional=True,
    ),
    "contact_position": or_nan(
        "mean position of the nodes of the contact, NaN: at no node",
        "m",
        ("contact", "axis"),
        optional=True,
    ),
    "contact_gap": or_nan(
        "gap between the faces at the contact, negative where they overlap; NaN: of no mesh",
        "m",
        ("contact",),
        optional=True,
    ),
}
"""Data variables."""
mesh_coordinates = {
    "node": count("number of the node in its program", "node", optional=True),
    "axis": Variable("axis of the position", dims=("axis",), dtype="U", optional=True),
}
"""Coordinates."""
